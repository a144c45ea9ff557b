"""A robot to test with: world and firmware at the far end of a cable in memory."""

import asyncio
import os
import resource
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from math import hypot
from types import TracebackType
from typing import Self

import numpy as np

from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command
from pioneer3.arcos.packet import PacketReader, encode
from pioneer3.errors import LinkError, MotionError, PortNotFoundError
from pioneer3.geometry import ORIGIN, Pose2, wrap
from pioneer3.links import Link
from pioneer3.links.memory import Fault, MemoryLink, clean, null_modem
from pioneer3.maps import LineMap
from pioneer3.models import load_model
from pioneer3.runtime.robot import Robot
from pioneer3.sim.body import Body
from pioneer3.sim.dynamics import dynamics_of
from pioneer3.sim.equipment import Equipment
from pioneer3.sim.firmware import Firmware
from pioneer3.sim.kernels import CACHE, Kernels
from pioneer3.sim.motion import WheelDrive
from pioneer3.sim.realism import Realism
from pioneer3.sim.world import World
from pioneer3.sim.worldfile.spec import Physics

DISTINCT = (
    *("amigo-sh", "p2pb", "p3at", "p3at-sh", "p3dx", "p3dx-sh"),
    *("peoplebot-sh", "pionat", "powerbot", "seekur"),
)
"""Models that stand for all: of each body, of old and new units, with few and many sonars."""

PHYSICS = "PYTEST_PHYSICS"
"""Set in the environment by pytest's option `--physics`: commands simulate with MuJoCo, too."""
TICK = 0.02
SYNCS = (0, 1, 2)
STAYED = 2e-3
"""What has moved by less stands where it was [m, rad]."""
SLOW = 0.02
"""What is slower stands, as people see it [m/s, rad/s]."""
OUTLINE = 0.07
"""A robot's body ends at most so far within the outline that ARIA gives it [m]."""


def bound(planar: float, physical: float) -> float:
    """Return the bound of a figure: that of the plane, or with `--physics` that of mass."""
    return physical if PHYSICS in os.environ else planar


def frame(command: Command) -> bytes:
    """Return `command` as it is on the wire."""
    return encode(commands.to_payload(command))


def decoded(data: bytes) -> list[Command]:
    """Return every command in `data`; the SYNCs of a handshake read as PULSE, OPEN, CLOSE."""
    return [commands.from_payload(payload) for payload in PacketReader().feed(data)]


def wall_at(x: float) -> LineMap:
    """Return a map with one wall across the x axis."""
    return LineMap(name="wall", walls=np.array([[x, -5.0, x, 5.0]]))


def moves(drive: WheelDrive) -> bool:
    """Return whether any wheel of a simulated robot turns, or is about to."""
    axes = (drive.linear, drive.angular)
    wanted = drive.powered and any(axis.target for axis in axes)
    return wanted or any(axis.velocity or axis.remaining is not None for axis in axes)


def is_at(pose: Pose2, place: Pose2) -> bool:
    """Return whether a robot at `pose` is where it should be."""
    away = hypot(pose.x - place.x, pose.y - place.y)
    return away < STAYED and abs(wrap(pose.theta - place.theta)) < STAYED


@dataclass
class Wire:
    """What arrived at the robot over one connection: when [s], what."""

    chunks: list[tuple[float, bytes]] = field(default_factory=list)

    @property
    def data(self) -> bytes:
        """All of it."""
        return b"".join(data for _, data in self.chunks)

    @property
    def commands(self) -> list[Command]:
        """The commands in it, once the SYNCs are through."""
        return decoded(self.data)


@contextmanager
def disk_of(size: int) -> Iterator[None]:
    """Let no file grow beyond `size` bytes during the block, as on a full disk."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


class SimulatedRobot:
    """World and firmware in the loop's time; :meth:`open` lays a new cable to it.

    Attributes:
        to_robot: Fault of the cable on the way to the robot; may be changed at any time.
        to_host: The same on the way back.
        plugged: Whether :meth:`open` works.
        silent: Nothing passes, either way; the cable stays whole.
        latency: How long bytes travel, each way, over cables laid from now on [s].
        stepped: Called after each step of the world.
        wires: What came over each connection, also through a fault, also while silent.
    """

    def __init__(
        self,
        line_map: LineMap | None = None,
        *,
        home: Pose2 = ORIGIN,
        model: str = "p3at-sh",
        equipment: Equipment | None = None,
        to_robot: Fault = clean,
        to_host: Fault = clean,
        speeds: Sequence[int] = (),
        url: str = "memory:host",
        seed: int = 0,
        realism: Realism | None = None,
        kernels: Kernels | None = None,
        physics: Physics | None = None,
    ) -> None:
        self.body = Body(load_model(model), home)
        self.world = World(
            line_map,
            [self.body],
            kernels or Kernels(compiled=CACHE.is_complete),
            seed=seed,
            realism=realism,
            dynamics=dynamics_of(physics) if physics else None,
        )
        self.equipment = equipment
        self.firmware = Firmware(self.world, self.body, equipment=equipment)
        self.to_robot, self.to_host = to_robot, to_host
        self.speeds, self.url = tuple(speeds), url
        self.robot_speed = self.speeds[-1] if self.speeds else None
        self.plugged, self.silent = True, False
        self.latency = 0.0
        self.wires: list[Wire] = []
        self.edit: Callable[[bytes], bytes] = lambda data: data
        self.stepped: Callable[[], None] = lambda: None
        self._link: MemoryLink | None = None
        self._tasks: list[asyncio.Task[None]] = []

    async def __aenter__(self) -> Self:
        self._clock = asyncio.get_running_loop().time
        self._tasks.append(asyncio.ensure_future(self._live()))
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        for task in self._tasks:
            task.cancel()
        for ended in await asyncio.gather(*self._tasks, return_exceptions=True):
            if isinstance(ended, Exception) and error is None:
                raise ended

    async def open(self) -> Link:
        """Lay a cable, as opening a port does."""
        if not self.plugged:
            raise PortNotFoundError("memory: no such port")
        ours, theirs = null_modem(speeds=self.speeds)
        ours.url = self.url
        ours.delay = theirs.delay = self.latency
        ours.fault, theirs.fault = self._spoil_to_robot, self._spoil_to_host
        theirs.speed = self.robot_speed
        self._link = theirs
        self.wires.append(Wire())
        self._tasks.append(asyncio.ensure_future(self._listen(theirs, self.wires[-1])))
        return ours

    async def unplug(self) -> None:
        """Pull the cable out; nobody can open it until `plugged` is set again."""
        self.plugged = False
        link, self._link = self._link, None
        if link is not None:
            await link.close()

    def power_cycle(self) -> None:
        """Switch the robot off and on: it knows nothing any more; the cable stays in."""
        self.body.session_ended()
        self.body.drive.halt()
        self.firmware = Firmware(self.world, self.body, equipment=self.equipment)

    @property
    def speed(self) -> float:
        """Speed by its wheels [m/s]."""
        return self.body.speeds[0]

    @property
    def powered(self) -> bool:
        """Whether the motors are on."""
        return self.body.drive.powered

    def _spoil_to_robot(self, data: bytes) -> Iterable[bytes]:
        return self.to_robot(data)

    def _spoil_to_host(self, data: bytes) -> Iterable[bytes]:
        return self.to_host(data)

    async def _listen(self, link: MemoryLink, wire: Wire) -> None:
        while data := await link.read():
            wire.chunks.append((self._clock(), data))
            if not self.silent and link is self._link:
                self.firmware.receive(data, self._clock())
                await self._flush()

    async def _live(self) -> None:
        while True:
            self.world.step(TICK)
            self.stepped()
            self.firmware.tick(self._clock())
            await self._flush()
            await asyncio.sleep(TICK)

    async def _flush(self) -> None:
        data = self.edit(self.firmware.device.outgoing())
        if data and self._link is not None and not self.silent:
            try:
                await self._link.write(data)
            except LinkError:
                self._link = None


class First:
    """A fault that spoils the first `times` pieces that contain `frame` and passes the rest."""

    def __init__(self, frame: bytes, becomes: Callable[[bytes], bytes], times: int = 1) -> None:
        self.frame, self.becomes, self.times = frame, becomes, times

    def __call__(self, data: bytes) -> tuple[bytes, ...]:
        if self.frame in data and self.times:
            self.times -= 1
            return (data.replace(self.frame, self.becomes(self.frame), 1),)
        return (data,)


def lost(frame: bytes) -> bytes:
    """Lose it."""
    return b""


def doubled(frame: bytes) -> bytes:
    """Say it twice."""
    return frame * 2


def corrupted(frame: bytes) -> bytes:
    """Flip a bit in its last byte."""
    return frame[:-1] + bytes([frame[-1] ^ 1])


async def until(holds: Callable[[], object], within: float = 30.0) -> float:
    """Wait until `holds` is true; return how long that took [s]."""
    clock = asyncio.get_running_loop().time
    began = clock()
    async with asyncio.timeout(within):
        while not holds():  # noqa: ASYNC110  nobody tells when
            await asyncio.sleep(0.02)
    return clock() - began


async def hold(robot: Robot, speed: float, turn_rate: float = 0.0, seconds: float = 1.0) -> int:
    """Hold a stick: ask ten times a second, whatever comes; return how often it was refused."""
    loop = asyncio.get_running_loop()
    end, refused = loop.time() + seconds, 0
    while loop.time() < end:
        try:
            robot.drive(speed, turn_rate)
        except MotionError:
            refused += 1
        await asyncio.sleep(0.1)
    return refused
