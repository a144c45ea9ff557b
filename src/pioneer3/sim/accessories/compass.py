"""The TCM2 compass (protocol.md 3.2 row 45, 4.2, 5.7)."""

from collections.abc import Sequence
from dataclasses import replace
from math import cos, pi, sin

from numpy.random import Generator

from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command, Tcm2Mode
from pioneer3.arcos.reports import Compass as CompassReport
from pioneer3.arcos.reports import Report
from pioneer3.sim.accessories.base import CarryingRobot, Inputs, ReportRequest
from pioneer3.units import degrees

FIELD_LEVEL = 20.0
"""Level part of the earth's field in central Europe [uT]; x forward, y right, z down."""
FIELD_DOWN = 45.0
"""Downward part of it [uT]."""
TEMPERATURE_DECICELSIUS = 220
GOOD_SCORE = 9
"""Score of both angles after a calibration; the module's scores are otherwise unverified."""
GOOD_FIELD_SCORE_HUNDREDTHS = 3000


class Compass:
    """Measures the heading in the world, clockwise from magnetic north, 0 to 359.9 degrees.

    North is the y axis of the world unless set otherwise: with the usual east-north axes a robot
    that looks along x reads 90 degrees, and turning left makes it less.
    """

    def __init__(
        self, body: CarryingRobot, rng: Generator, *, north: float = pi / 2, noise: float = 0.0
    ) -> None:
        """`north` is counter-clockwise from the world's x axis, `noise` a deviation [rad]."""
        self._body = body
        self._rng = rng
        self._north, self._noise = north, noise
        self._request = ReportRequest()
        self._on = True
        self._calibrating = self._calibrated = False

    def obey(self, command: Command, now: float) -> bool:
        """Obey TCM2."""
        match command:
            case commands.Tcm2(mode):
                self._set(mode)
                return True
        return False

    def _set(self, mode: Tcm2Mode) -> None:
        match mode:
            case Tcm2Mode.USER_CALIBRATION | Tcm2Mode.AUTO_CALIBRATION:
                self._calibrating = True
            case Tcm2Mode.STOP_CALIBRATION:
                self._calibrated |= self._calibrating
                self._calibrating = False
            case _:
                self._on = mode is not Tcm2Mode.OFF
                self._request = ReportRequest(mode is Tcm2Mode.ONCE, mode is Tcm2Mode.STREAM)
                if mode is Tcm2Mode.SOFT_RESET:
                    self._calibrating = self._calibrated = False

    def reports(self, now: float, *, cycle: bool) -> Sequence[Report]:
        """Return the compass report when it is due."""
        if not self._request.due(cycle=cycle):
            return ()
        heading = self._heading()
        score = GOOD_SCORE if self._calibrated else 0
        return (
            CompassReport(
                heading_decidegrees=round(degrees(heading) * 10) % 3600,
                pitch_decidegrees=0,
                roll_decidegrees=0,
                magnetic_x_hundredths=round(100 * FIELD_LEVEL * cos(heading)),
                magnetic_y_hundredths=round(-100 * FIELD_LEVEL * sin(heading)),
                magnetic_z_hundredths=round(100 * FIELD_DOWN),
                temperature_decicelsius=TEMPERATURE_DECICELSIUS,
                error=0,
                calibration_h=score,
                calibration_v=score,
                calibration_m_hundredths=GOOD_FIELD_SCORE_HUNDREDTHS if self._calibrated else 0,
            ),
        )

    def inputs(self, sip: Inputs, now: float) -> Inputs:
        """Show the heading in steps of 2 degrees, as ARIA reads it (facts.md 13, row 18)."""
        if not self._on:
            return sip
        return replace(sip, compass_raw=round(degrees(self._heading()) / 2) % 180)

    def hang_up(self) -> None:
        """Send no more reports; the heading stays in the standard report."""
        self._request = ReportRequest()

    def _heading(self) -> float:
        heading = self._north - self._body.robot_in_world.theta
        if self._noise:
            heading += self._noise * float(self._rng.standard_normal())
        return heading % (2 * pi)
