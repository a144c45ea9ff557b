"""The laser that simulators answer with in the robot's own stream (arcos.md 2.3, 5.13).

Real ARIA programs set it up with commands 36, 37, 38, 35 (start, end, step, on). On a robot these
numbers belong to the gripper, the gyro and the analog port. They mean the laser while it is off,
and when they come in this order; GRIPPERPACREQUEST 0, 1, 2 out of order is always the gripper's.
"""

from math import radians

import numpy as np

from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command, Request, SimLaserMode
from pioneer3.arcos.reports import LaserReading, Report, SimLaser, SimLaserExtended
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.sim.body import Body
from pioneer3.sim.world import World
from pioneer3.units import MM, degrees

READINGS_PER_PACKET = 32
MOST_READINGS = 4000
OLD_SETUP = (36, 37, 38, 35)


class Scanner:
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

    def obey(self, command: Command) -> bool:
        """Take a command that is meant for the laser; return whether it was."""
        if command.ID in OLD_SETUP or (
            isinstance(command, commands.Unknown) and command.number in OLD_SETUP
        ):
            return self._obey_old(command)
        match command:
            case commands.SimLrfEnable(mode):
                self._mode = mode
            case commands.SimLrfSetFovStart(angle):
                self._start = angle
            case commands.SimLrfSetFovEnd(angle):
                self._end = angle
            case commands.SimLrfSetRes(step):
                self._step = step or self._step
            case _:
                return False
        return True

    def reports(self) -> list[Report]:
        """Return the packets of one sweep, none while the laser is off."""
        if self._mode is SimLaserMode.OFF:
            return []
        start, end = sorted((self._start, self._end))
        count = min(MOST_READINGS, round((end - start) / self._step) + 1)
        metres = self._world.laser(self._body, self._mount, start, self._step, count)
        ranges_mm: list[int] = np.rint(metres / MM).astype(int).tolist()
        return [
            self._packet(count, first, tuple(ranges_mm[first : first + READINGS_PER_PACKET]))
            for first in range(0, count, READINGS_PER_PACKET)
        ]

    def _packet(self, total: int, first: int, part: tuple[int, ...]) -> Report:
        if self._mode is SimLaserMode.EXTENDED:
            readings = tuple(LaserReading(range_mm) for range_mm in part)
            return SimLaserExtended(total=total, first=first, readings=readings, laser=0, flags=0)
        pose = self._body.robot_in_odom
        return SimLaser(
            x_mm=_s16(pose.x / MM),
            y_mm=_s16(pose.y / MM),
            heading_deg=round(degrees(pose.theta)),
            total=total,
            first=first,
            ranges_mm=part,
        )

    def _obey_old(self, command: Command) -> bool:
        payload = commands.to_payload(command)
        number = payload[0]
        in_order = number == OLD_SETUP[self._in_order]
        gripper = number == 37 and command in {commands.GripperPacRequest(how) for how in Request}
        if not in_order and (gripper or self._mode is not SimLaserMode.OFF) and number != 35:
            return False
        self._in_order = (self._in_order + 1) % len(OLD_SETUP) if in_order else int(number == 36)
        match commands.from_payload(payload, simulator=True):
            case commands.OldLaser(mode):
                self._mode = mode
            case commands.OldLaserStart(angle):
                self._start = angle
            case commands.OldLaserEnd(angle):
                self._end = angle
            case commands.OldLaserStep(step):
                self._step = step or self._step
        return True


def _s16(value: float) -> int:
    return (round(value) + 0x8000) % 0x10000 - 0x8000
