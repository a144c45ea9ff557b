"""The laser in the robot's own stream, which only simulators have (protocol.md 2.3, 5.13).

Real ARIA programs set it up with commands 36, 37, 38, 35 (start, end, step, on). On a robot these
numbers belong to the gripper, the gyro and the analog port. They mean the laser while it is off,
and when they come in this order; GRIPPERPACREQUEST 0, 1, 2 out of order is always the gripper's.

:func:`packets` defines the packets of a sweep, 0x60 and 0x61. :class:`SweepFrames` makes the same
bytes many times faster: all frames of a sweep lie in one buffer, in which only readings, pose and
checksums change.
"""

from collections.abc import Sequence
from math import degrees, radians

import numpy as np
from numpy.typing import NDArray

from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command, RequestMode, SimLaserMode
from pioneer3.arcos.packet import encode
from pioneer3.arcos.reports import LaserReading, SimLaser, SimLaserExtended, to_payload
from pioneer3.arrays import UInt16
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.sim.body import Body
from pioneer3.sim.sensors import LASER_RANGE
from pioneer3.sim.world import World
from pioneer3.units import MM

Words = UInt16

PER_PACKET = 32
"""Readings in a packet; so 181 make six, as from AMRISim."""
NOTHING_MM = 0x7FFF
"""Hosts take this and more for "nothing there"."""
POSE = 3
"""Numbers of the robot's pose in a packet 0x60: x, y [mm], heading [deg]."""


def packets(
    pose: Sequence[int], ranges_mm: Sequence[int], *, extended: bool
) -> list[SimLaser] | list[SimLaserExtended]:
    """Return the packets of one sweep, `extended` 0x61 or else 0x60.

    `pose` is the robot's x, y [mm] and heading [deg], each within 16 bits, which 0x61 has not; the
    ranges are counter-clockwise, 0 to 0xFFFF.
    """
    total = len(ranges_mm)
    parts = [(at, tuple(ranges_mm[at : at + PER_PACKET])) for at in range(0, total, PER_PACKET)]
    if extended:
        return [
            SimLaserExtended(
                total=total, first=at, readings=tuple(map(LaserReading, part)), laser=0, flags=0
            )
            for at, part in parts
        ]
    x_mm, y_mm, heading_deg = pose
    return [
        SimLaser(
            x_mm=x_mm, y_mm=y_mm, heading_deg=heading_deg, total=total, first=at, ranges_mm=part
        )
        for at, part in parts
    ]


class SweepFrames:
    """The frames of sweeps of `total` readings: call :meth:`fill` for each.

    Where readings and pose lie is taken from :func:`packets`. The checksum adds up big-endian
    words, so a byte that changes from 0 to b adds b, or 256 b in front of a word.
    """

    def __init__(self, total: int, *, extended: bool) -> None:
        blank = [encode(to_payload(p)) for p in packets((0, 0, 0), (0,) * total, extended=extended)]
        places = [_places(len(frame), extended=extended) for frame in blank]
        starts = np.cumsum([0, *(len(frame) for frame in blank)])
        self._buffer = np.frombuffer(b"".join(blank), dtype=np.uint8).copy()
        self._words = np.zeros(POSE + total, dtype="<u2")
        self._source = np.concatenate(
            [_source(number, len(at), extended=extended) for number, at in enumerate(places)]
        )
        low = np.concatenate([start + at for start, at in zip(starts, places, strict=False)])
        self._at = np.stack([low, low + 1], axis=1).ravel()
        # payloads begin at byte 3 of a frame: there, odd places in a frame are the fronts of words
        inside = np.concatenate(places)
        front = np.stack([inside, inside + 1], axis=1).ravel() % 2 == 1
        self._weights = np.where(front, 256, 1).astype(np.uint16)
        self._firsts = np.cumsum([0, *(2 * len(at) for at in places[:-1])])
        ends = starts[1:]
        self._checks = np.stack([ends - 2, ends - 1], axis=1).ravel()
        self._sums = self._buffer[self._checks].view(">u2").astype(np.uint16)

    def fill(self, pose: Sequence[int], ranges_mm: Words) -> bytes:
        """Return the frames of one sweep, as :func:`packets` has them; `pose` is without signs."""
        self._words[:POSE] = pose
        self._words[POSE:] = ranges_mm
        changed = self._words[self._source].view(np.uint8)
        self._buffer[self._at] = changed
        # no byte is XORed: the odd last one of a payload is a flag that stays 0
        added = np.add.reduceat(changed * self._weights, self._firsts, dtype=np.uint16)
        self._buffer[self._checks] = (self._sums + added).astype(">u2").view(np.uint8)
        return self._buffer.tobytes()


def _places(size: int, *, extended: bool) -> NDArray[np.intp]:
    """Return where in a frame of `size` bytes its changing 16-bit numbers begin."""
    if extended:
        return np.arange(9, size - 4, 5)
    return np.concatenate([np.arange(4, 10, 2), np.arange(15, size - 2, 2)])


def _source(packet: int, count: int, *, extended: bool) -> NDArray[np.intp]:
    """Return which of pose and readings the `count` changing numbers of one packet are."""
    first = POSE + packet * PER_PACKET
    if extended:
        return np.arange(first, first + count)
    return np.concatenate([np.arange(POSE), np.arange(first, first + count - POSE)])


MOST_READINGS = 4000
OLD_SETUP = (36, 37, 38, 35)
FIRST_LASER = (None, 0)
"""How commands name the only laser that a simulated robot has."""


class InBandLaser:
    """The in-band laser of one robot: its settings, and the packets of a sweep."""

    def __init__(self, world: World, body: Body) -> None:
        self._world = world
        self._body = body
        mount = body.model.laser
        self._mount = Pose2(mount.x, mount.y, mount.theta) if mount else ORIGIN
        self.off()

    def off(self) -> None:
        """Stop scanning and forget the settings."""
        self._mode = SimLaserMode.OFF
        self._start, self._end, self._step = radians(-90), radians(90), radians(1)
        self._in_order = 0
        self._sweep: SweepFrames | None = None

    def obey(self, command: Command) -> bool:
        """Take a command that is meant for a laser; return whether it was."""
        if command.ID in OLD_SETUP or (
            isinstance(command, commands.Unknown) and command.number in OLD_SETUP
        ):
            return self._obey_old(command)
        match command:
            case commands.SimLrfEnable(mode, laser):
                self._mode = mode if laser in FIRST_LASER else self._mode
            case commands.SimLrfSetFovStart(angle, laser):
                self._start = angle if laser in FIRST_LASER else self._start
            case commands.SimLrfSetFovEnd(angle, laser):
                self._end = angle if laser in FIRST_LASER else self._end
            case commands.SimLrfSetRes(step, laser):
                self._step = step or self._step if laser in FIRST_LASER else self._step
            case _:
                return False
        self._sweep = None
        return True

    def frames(self) -> bytes:
        """Return the packets of one sweep as they go on the wire, none while the laser is off.

        Nothing within :data:`LASER_RANGE` reads 0x7FFF, as hosts of the old simulator expect.
        """
        if self._mode is SimLaserMode.OFF:
            return b""
        start, end = sorted((self._start, self._end))
        count = min(MOST_READINGS, round((end - start) / self._step) + 1)
        if self._sweep is None:
            self._sweep = SweepFrames(count, extended=self._mode is SimLaserMode.EXTENDED)
        metres = self._world.laser(self._body, self._mount, start, self._step, count)
        ranges_mm = np.where(metres < LASER_RANGE, np.rint(metres / MM), NOTHING_MM)
        pose = self._body.robot_in_odom
        where = round(pose.x / MM), round(pose.y / MM), round(degrees(pose.theta))
        return self._sweep.fill([number & 0xFFFF for number in where], ranges_mm.astype(np.uint16))

    def _obey_old(self, command: Command) -> bool:
        payload = commands.to_payload(command)
        number = payload[0]
        in_order = number == OLD_SETUP[self._in_order]
        gripper = number == 37 and command in {
            commands.GripperPacRequest(how) for how in RequestMode
        }
        if not in_order and (gripper or self._mode is not SimLaserMode.OFF) and number != 35:
            return False
        meaning = commands.from_payload(payload, simulator=True)
        if isinstance(meaning, commands.Unknown):
            return False
        self._in_order = (self._in_order + 1) % len(OLD_SETUP) if in_order else int(number == 36)
        match meaning:
            case commands.OldLaser(mode):
                self._mode = mode
            case commands.OldLaserStart(angle):
                self._start = angle
            case commands.OldLaserEnd(angle):
                self._end = angle
            case commands.OldLaserStep(step):
                self._step = step or self._step
        self._sweep = None
        return True
