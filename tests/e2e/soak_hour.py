"""Many robots for long, in simulated time: hosts say what comes to mind, and everything is counted.

Hosts open sessions, drive, ask, fall silent, say goodbye or vanish; the same seed does the same
again. Nothing here looks at a clock.
"""

import gc
import hashlib
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from math import isfinite, pi, radians
from random import Random

from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command, RequestMode, SimLaserMode
from pioneer3.arcos.packet import PacketReader
from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap
from pioneer3.models import RobotModel, load_model
from pioneer3.sim.body import Body
from pioneer3.sim.firmware import Firmware
from pioneer3.sim.kernels import Kernels
from pioneer3.sim.world import World
from pioneer3.sim.worldfile import load_map
from tests.e2e.plain_client import SYNCS
from tests.support import OUTLINE, frame

TICK = 0.02
TICKS_PER_CYCLE = 5
MODELS = ("p3dx-sh", "p3at-sh", "amigo-sh", "p3at")
SIP_NUMBERS = (0x32, 0x33)
OPENING = b"".join(SYNCS) + frame(commands.Open()) + frame(commands.Enable(on=True))

MOTION: tuple[Callable[[Random], Command], ...] = (
    lambda r: commands.Vel(r.uniform(-0.75, 0.75)),
    lambda r: commands.RVel(radians(r.uniform(-100, 100))),
    lambda r: commands.Move(r.uniform(-1.0, 1.0)),
    lambda r: commands.Head(r.uniform(-pi, pi)),
    lambda r: commands.DHead(r.uniform(-pi, pi)),
    lambda r: commands.Vel2(r.randint(-30, 30), r.randint(-30, 30)),
    lambda r: commands.Stop(),
    lambda r: commands.Enable(on=True),
)
OTHER: tuple[Callable[[Random], Command], ...] = (
    lambda r: commands.Enable(on=False),
    lambda r: commands.EStop(),
    lambda r: commands.SetV(r.uniform(0.1, 1.0)),
    lambda r: commands.SetRV(radians(r.uniform(20, 150))),
    lambda r: commands.SetA(r.choice((-1, 1)) * r.uniform(0.1, 2.0)),
    lambda r: commands.SetRA(r.choice((-1, 1)) * radians(r.uniform(20, 300))),
    lambda r: commands.SetO(),
    lambda r: commands.Sonar(on=r.random() < 0.8),
    lambda r: commands.RequestConfig(),
    lambda r: commands.IoRequest(r.choice(list(RequestMode))),
    lambda r: commands.RequestEncoders(r.choice(list(RequestMode))),
    lambda r: commands.RequestBatteryInfo(r.choice(list(RequestMode))),
    lambda r: commands.DigOut(mask=r.randrange(256), values=r.randrange(256)),
    lambda r: commands.SimLrfEnable(r.choice([SimLaserMode.OFF, SimLaserMode.EXTENDED]), laser=0),
    lambda r: commands.named("SOUNDTOG", False),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Endured:
    """What came of it.

    Attributes:
        robots: How many.
        seconds: Simulated [s].
        time_error: Of the world's clock [s].
        sessions: Opened.
        commands: Sent.
        reports: Standard reports received.
        owed: One for each cycle of each session.
        spoilt: Bytes of robots that made no packet.
        troubles: What was wrong with which robot.
        grown_blocks: Pieces of memory, after minus before the last four fifths of the time.
        digest: Of all bytes that robots sent, and of where they were in the end.
    """

    robots: int
    seconds: float
    time_error: float
    sessions: int
    commands: int
    reports: int
    owed: int
    spoilt: int
    troubles: tuple[str, ...]
    grown_blocks: int
    digest: str


class Host:
    """A robot's host with a mind of its own, in simulated time."""

    def __init__(self, firmware: Firmware, seed: int) -> None:
        self.firmware = firmware
        self.sessions = self.commands = self.reports = self.owed = self.spoilt = 0
        self.digest = hashlib.sha256()
        self._random = Random(seed)
        self._packets = PacketReader()
        self._opened_at: int | None = None
        self._next = self._random.randrange(TICKS_PER_CYCLE)

    def act(self, tick: int) -> None:
        """Say something, or nothing."""
        if tick < self._next:
            return
        random, now = self._random, tick * TICK
        self._next = tick + random.randrange(1, 2 * TICKS_PER_CYCLE)
        if self._opened_at is None:
            self.firmware.receive(OPENING, now)
            self._opened_at = tick
            self.sessions += 1
        elif (chance := random.random()) < 0.004:
            self.leave(tick, politely=chance < 0.002)
        elif chance < 0.008:
            self._next = tick + random.randrange(200)  # the watchdog expires after 100
        else:
            choices = MOTION if chance < 0.8 else OTHER
            self.firmware.receive(frame(random.choice(choices)(random)), now)
            self.commands += 1

    def leave(self, tick: int, *, politely: bool = True) -> None:
        """End the session, if there is one."""
        if self._opened_at is None:
            return
        self.listen(tick)
        if politely:
            self.firmware.receive(frame(commands.Close()), tick * TICK)
        else:
            self.firmware.hang_up(tick * TICK)
        self.owed += -((self._opened_at - tick) // TICKS_PER_CYCLE)
        self._opened_at = None

    def listen(self, tick: int) -> None:
        """Take what the robot sends."""
        data = self.firmware.device.outgoing()
        if not data:
            return
        self.digest.update(data)
        payloads = self._packets.feed(data, tick * TICK)
        self.reports += sum(p[0] in SIP_NUMBERS for p in payloads)
        self.spoilt = self._packets.bad_checksums + self._packets.bytes_skipped


def endure(line_map: LineMap, seconds: float, *, robots: int = 20, seed: int = 0) -> Endured:
    """Let robots live in a map for `seconds` [s, simulated] as fast as they can."""
    world = World(line_map, kernels=Kernels())
    bodies = populate(world, robots, Random(seed))
    hosts = [Host(Firmware(world, body), seed=seed * 1000 + n) for n, body in enumerate(bodies)]
    ticks = round(seconds / TICK)
    troubles: list[str] = []
    blocks = 0
    for tick in range(ticks):
        for host in hosts:
            host.act(tick)
            host.firmware.tick(tick * TICK)
            host.listen(tick)
        world.step(TICK)
        if tick % 50 == 0:
            troubles += troubles_of(world)
        if tick == ticks // 5:
            blocks = _blocks()
    grown_blocks = _blocks() - blocks
    for host in hosts:
        host.leave(ticks)
    return Endured(
        robots=robots,
        seconds=seconds,
        time_error=world.time - ticks * TICK,
        sessions=sum(host.sessions for host in hosts),
        commands=sum(host.commands for host in hosts),
        reports=sum(host.reports for host in hosts),
        owed=sum(host.owed for host in hosts),
        spoilt=sum(host.spoilt for host in hosts),
        troubles=tuple(troubles + [f"{b}: in a wall" for b in stuck(world)]),
        grown_blocks=grown_blocks,
        digest=_digest(hosts),
    )


def populate(world: World, robots: int, random: Random) -> list[Body]:
    """Put robots of several types where they touch nothing."""
    bounds = world.map.bounds
    bodies = []
    for number in range(robots):
        body = Body(load_model(MODELS[number % len(MODELS)]))
        world.add(body)
        while True:
            x, y = random.uniform(bounds[0], bounds[2]), random.uniform(bounds[1], bounds[3])
            body.home = body.robot_in_world = Pose2(x, y, random.uniform(-pi, pi))
            if world.is_free(body, body.robot_in_world):
                break
        bodies.append(body)
    return bodies


def troubles_of(world: World) -> list[str]:
    """Name what is not finite, or outside the map."""
    bounds = world.map.bounds
    troubles = []
    for number, body in enumerate(world.robots):
        here, odometry = body.robot_in_world, body.robot_in_odom
        numbers = [here.x, here.y, here.theta, odometry.x, odometry.y, odometry.theta]
        numbers += [*body.speeds, body.battery.voltage]
        if not all(map(isfinite, numbers)):
            troubles.append(f"robot {number} at {world.time:.1f} s: not finite: {numbers}")
        elif not (bounds[0] < here.x < bounds[2] and bounds[1] < here.y < bounds[3]):
            troubles.append(f"robot {number} at {world.time:.1f} s: outside, at {here}")
    return troubles


def stuck(world: World) -> list[int]:
    """Return the robots that stand in something: bodies with mass end within their outlines."""
    within = OUTLINE if world.dynamics.has_slip else 0.0
    bodies = [Body(smaller(body.model, within), body.robot_in_world) for body in world.robots]
    there = World(world.map, bodies)
    return [
        number for number, body in enumerate(bodies) if not there.is_free(body, body.robot_in_world)
    ]


def smaller(model: RobotModel, by: float) -> RobotModel:
    """Return a model whose outline ends earlier by a length [m] on all sides."""
    front, rear = model.length_front - by, model.length_rear - by
    return replace(model, length_front=front, length_rear=rear, width=model.width - 2 * by)


def _blocks() -> int:
    gc.collect()
    return sys.getallocatedblocks()


def _digest(hosts: list[Host]) -> str:
    digest = hashlib.sha256()
    for host in hosts:
        digest.update(host.digest.digest())
        digest.update(repr(host.firmware.body.robot_in_world).encode())
    return digest.hexdigest()


def the_map() -> LineMap:
    """Return where robots endure: the shipped office."""
    return load_map("office")
