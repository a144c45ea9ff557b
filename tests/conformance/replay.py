"""Captured sessions of real ARIA programs, played to our simulated robot.

A capture holds both sides of a session between an ARIA program and the old emulator (AMRISim;
facts in facts.md 9). :func:`played` gives the program's bytes to our firmware, in virtual time, at
the same place of the same map. What either robot answered is a :class:`Session`.

The old emulator's own time advances by one cycle per standard report (9.2), whatever the machine
does. Where the recording machine was busy, it fell behind the wall clock; so what is compared is
where the robots were at which moment of *its* time, which :func:`cycles_of` tells.

`python -m tests.conformance.replay` prints how far the two robots differ.
"""

import sys
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pioneer3.arcos import commands, reports
from pioneer3.arcos.commands import Command
from pioneer3.arcos.packet import PacketReader
from pioneer3.arcos.reports import Report, SimLaserExtended, Sip
from pioneer3.geometry import Pose2, wrap
from pioneer3.links.tap import FROM_HOST, FROM_ROBOT, Chunk, read_recording
from pioneer3.maps import LineMap
from pioneer3.models import load_model
from pioneer3.robot.assemble import POSITION_MODULUS
from pioneer3.robot.assemble import Counter as WrappingCounter
from pioneer3.sim.body import Body
from pioneer3.sim.firmware import Firmware
from pioneer3.sim.kernels import Kernels
from pioneer3.sim.world import World
from pioneer3.sim.worldfile import load_map

Float = NDArray[np.float64]
Clock = Callable[[float], float]

SHARED = Path(__file__).parents[2].parent / "shared"
CAPTURES = sorted((SHARED / "captures").glob("aria291-*.txt"))
MAP = SHARED / "maps" / "AMROffice.map"
"""Where the captures were made: no other map fits their sonar readings and laser sweeps."""
START = Pose2(-2.822, -2.937, wrap(-91.9))
"""The map has no RobotHome, so the emulator began at its Dock, -2822 -2937 -91.9, whose degrees it
took for radians: in the end it looks to 134.5 degrees."""
MODEL = load_model("p3at")
"""What the emulator called its robot."""
DISTANCE_UNIT, SPEED_UNIT, HEADING_UNIT = 0.465e-3, 1e-3, 2 * np.pi / 4096
"""As ARIA reads a p3at's counts (6.2) [m, m/s, rad]."""
WHEEL_BASE = 2e-3 / 0.0034
"""Likewise: 2 / DiffConvFactor [m]."""
CYCLE = 0.1
TICK = 0.02


@dataclass(frozen=True, slots=True, eq=False)
class Track:
    """Where a robot's standard reports say it was: arrays of one length.

    Attributes:
        time: [s].
        x: Since the first report [m].
        y: [m].
        theta: Heading since then, not wrapped [rad].
        speed: [m/s].
        turn_rate: [rad/s].
        way: Distance travelled [m].
        rotation: Angle turned through, either way [rad].
    """

    time: Float
    x: Float
    y: Float
    theta: Float
    speed: Float
    turn_rate: Float
    way: Float
    rotation: Float

    def at(self, time: Float) -> "Track":
        """Return the track at other times, in a straight line from report to report."""
        columns = (self.x, self.y, self.theta, self.speed, self.turn_rate, self.way, self.rotation)
        return Track(time, *(np.interp(time, self.time, column) for column in columns))


@dataclass(frozen=True, slots=True)
class Session:
    """What a robot answered: each packet, and when it came [s]."""

    answers: tuple[tuple[float, Report], ...]

    @property
    def kinds(self) -> Counter[type[Report]]:
        """How many packets of each type."""
        return Counter(type(report) for _, report in self.answers)

    @property
    def sips(self) -> list[tuple[float, Sip]]:
        """The standard reports."""
        return [(time, report) for time, report in self.answers if isinstance(report, Sip)]

    @property
    def cycles(self) -> list[list[Report]]:
        """For each standard report what came after it, before the next one."""
        cycles: list[list[Report]] = []
        for _, report in self.answers:
            if isinstance(report, Sip):
                cycles.append([])
            elif cycles:
                cycles[-1].append(report)
        return cycles

    @property
    def sweeps(self) -> list[list[SimLaserExtended]]:
        """The laser's packets of each cycle that has any."""
        found = ([r for r in c if isinstance(r, SimLaserExtended)] for c in self.cycles)
        return [sweep for sweep in found if sweep]

    @property
    def track(self) -> Track:
        """What the standard reports say of the motion."""
        x, y = WrappingCounter(POSITION_MODULUS), WrappingCounter(POSITION_MODULUS)
        rows = [
            (
                time,
                x.update(sip.x_raw) * DISTANCE_UNIT,
                y.update(sip.y_raw) * DISTANCE_UNIT,
                sip.heading_raw * HEADING_UNIT,
                (sip.left_speed_raw + sip.right_speed_raw) / 2 * SPEED_UNIT,
                (sip.right_speed_raw - sip.left_speed_raw) * SPEED_UNIT / WHEEL_BASE,
            )
            for time, sip in self.sips
        ]
        time, x_m, y_m, theta, speed, turn_rate = np.array(rows).T
        theta = np.unwrap(theta)
        way = _running_sum(np.hypot(np.diff(x_m), np.diff(y_m)))
        rotation = _running_sum(np.abs(np.diff(theta)))
        return Track(time, x_m, y_m, theta, speed, turn_rate, way, rotation)


def _running_sum(parts: Float) -> Float:
    return np.concatenate([[0.0], np.cumsum(parts)])


def capture(name: str) -> Path:
    """Return the capture of an ARIA program."""
    return SHARED / "captures" / f"aria291-{name}.txt"


def went(path: Path, way: str) -> list[Chunk]:
    """Return the chunks of a capture that went one way."""
    return [chunk for chunk in read_recording(path) if chunk.way == way]


def said(path: Path, clock: Clock = float) -> list[tuple[float, Command]]:
    """Return the program's commands after the handshake, and when it sent them."""
    reader = PacketReader()
    payloads = [
        (clock(chunk.time), payload)
        for chunk in went(path, FROM_HOST)
        for payload in reader.feed(chunk.data, chunk.time)
    ]
    return [(time, commands.from_payload(payload)) for time, payload in payloads[3:]]


@cache
def captured(path: Path, clock: Clock = float) -> Session:
    """Return what the old emulator answered."""
    reader = PacketReader()
    return Session(
        tuple(
            (clock(chunk.time), reports.from_payload(payload))
            for chunk in went(path, FROM_ROBOT)
            for payload in reader.feed(chunk.data, chunk.time)
        )
    )


def cycles_of(path: Path) -> Clock:
    """Return a clock from a capture's wall time [s] to the old emulator's own.

    Until its first standard report both go together; then every report is one cycle.
    """
    wall = np.array([time for time, _ in captured(path).sips])
    own = wall[0] + CYCLE * np.arange(len(wall))

    def clock(time: float) -> float:
        if wall[0] <= time <= wall[-1]:
            return float(np.interp(time, wall, own))
        return time if time < wall[0] else float(own[-1] + time - wall[-1])

    return clock


@cache
def the_map() -> LineMap:
    """Return the map of the captures, read once."""
    return load_map(MAP)


@cache
def played(path: Path, clock: Clock = float) -> Session:
    """Return what our robot answers to a captured program.

    Args:
        path: The capture.
        clock: When our robot gets what the program sent at a time of the capture.
    """
    body = Body(MODEL, START)
    world = World(the_map(), [body], Kernels())
    firmware = Firmware(world, body, name="AMRISim")
    pending = [(clock(chunk.time), chunk.data) for chunk in went(path, FROM_HOST)][::-1]
    reader, step, end = PacketReader(), 0, pending[0][0] + CYCLE
    answers: list[tuple[float, Report]] = []
    while (now := step * TICK) < end:
        while pending and pending[-1][0] <= now:
            firmware.receive(pending.pop()[1], now)
        firmware.tick(now)
        payloads = reader.feed(firmware.device.outgoing(), now)
        answers += [(now, reports.from_payload(payload)) for payload in payloads]
        world.step(TICK)
        step += 1
    return Session(tuple(answers))


@dataclass(frozen=True, slots=True)
class Pair:
    """Both robots' sessions with one program, on the old emulator's own clock."""

    path: Path
    theirs: Session
    ours: Session

    def tracks(self, latency: float) -> tuple[Track, Track]:
        """Return their track and ours at the same times, ours `latency` [s] later than it was."""
        theirs = self.theirs.track
        return theirs, self.ours.track.at(theirs.time - latency)


@cache
def pair(path: Path) -> Pair:
    """Return a capture beside its replay."""
    clock = cycles_of(path)
    return Pair(path, captured(path, clock), played(path, clock))


def drift(theirs: Track, ours: Track) -> Float:
    """Return how far apart two robots come that only head differently [m].

    Over every piece of way they part by the chord between their headings.
    """
    chords = 2 * np.abs(np.sin((ours.theta - theirs.theta)[1:] / 2))
    return _running_sum(chords * np.diff(theirs.way))


def table(latency: float) -> str:
    """Return how far our robot and the old emulator differ, one line a capture."""
    lines = [
        f"{'capture':<22}{'packets: old emulator | ours':<58}{'way':>16}{'place':>9}{'turn':>9}"
    ]
    for path in CAPTURES:
        both = pair(path)
        theirs, ours = both.tracks(latency)
        way_m = np.abs(ours.way - theirs.way).max()
        share = way_m / theirs.way[-1] if theirs.way[-1] else 0.0
        place_m = np.hypot(ours.x - theirs.x, ours.y - theirs.y).max()
        turn_deg = np.degrees(np.abs(ours.theta - theirs.theta).max())
        counts = f"{_counts(both.theirs)} | {_counts(both.ours)}"
        lines.append(
            f"{path.stem.removeprefix('aria291-'):<22}{counts:<58}"
            f"{way_m * 1000:>6.0f} mm {share:>5.1%}{place_m * 1000:>6.0f} mm{turn_deg:>5.1f} deg"
        )
    return "\n".join(lines)


def _counts(session: Session) -> str:
    names: dict[type[Report], str] = {
        Sip: "SIP",
        SimLaserExtended: "laser",
        reports.Config: "CONFIG",
    }
    counts = [f"{session.kinds[kind]} {name}" for kind, name in names.items()]
    others = session.kinds.keys() - names.keys() - {reports.SyncEcho, reports.SyncIdentity}
    return ", ".join(counts + [f"{session.kinds[kind]} {kind.__name__}" for kind in others])


if __name__ == "__main__":
    sys.stdout.write(table(latency=CYCLE) + "\n")
