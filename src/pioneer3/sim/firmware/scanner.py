"""The laser that simulators answer with in the robot's own stream (arcos.md 2.3, 5.13).

Real ARIA programs set it up with commands 36, 37, 38, 35 (start, end, step, on). On a robot these
numbers belong to the gripper, the gyro and the analog port. They mean the laser while it is off,
and when they come in this order; GRIPPERPACREQUEST 0, 1, 2 out of order is always the gripper's.
"""

from math import radians

import numpy as np

from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command, Request, SimLaserMode
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.sim.body import Body
from pioneer3.sim.firmware.sweep import NOTHING_MM, SweepFrames
from pioneer3.sim.sensors import LASER_RANGE
from pioneer3.sim.world import World
from pioneer3.units import MM, degrees

MOST_READINGS = 4000
OLD_SETUP = (36, 37, 38, 35)
FIRST_LASER = (None, 0)
"""How commands name the only laser that a simulated robot has."""


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
        gripper = number == 37 and command in {commands.GripperPacRequest(how) for how in Request}
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
