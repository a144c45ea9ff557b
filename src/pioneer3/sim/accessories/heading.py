"""Sensors of the heading: the TCM2 compass, and the gyro that hosts correct it with.

Facts: protocol.md 3.2 row 45, 4.2, 5.4 (GyroType 1), 5.7.
"""

from collections import deque
from collections.abc import Sequence
from dataclasses import replace
from math import cos, degrees, inf, pi, radians, sin

from numpy.random import Generator

from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command, GyroMode, Tcm2Mode
from pioneer3.arcos.reports import Compass as CompassReport
from pioneer3.arcos.reports import GyroRates, GyroSample, Report
from pioneer3.geometry import wrap
from pioneer3.sim.accessories.base import (
    Accessory,
    CarryingRobot,
    HostRequest,
    ReportingAccessory,
    SipFields,
)

FIELD_LEVEL = 20.0
"""Level part of the earth's field in central Europe [uT]; x forward, y right, z down."""
FIELD_DOWN = 45.0
"""Downward part of it [uT]."""
TEMPERATURE_DECICELSIUS = 220
GOOD_SCORE = 9
"""Score of both angles after a calibration; the module's scores are otherwise unverified."""
GOOD_FIELD_SCORE_HUNDREDTHS = 3000


class SimulatedCompass(ReportingAccessory):
    """Measures the heading in the world, clockwise from magnetic north, 0 to 359.9 degrees.

    North is the y axis of the world unless set otherwise: with the usual east-north axes a robot
    that looks along x reads 90 degrees, and turning left makes it less.
    """

    def __init__(
        self, body: CarryingRobot, rng: Generator, *, north: float = pi / 2, noise: float = 0.0
    ) -> None:
        """`north` is counter-clockwise from the world's x axis, `noise` a deviation [rad]."""
        super().__init__()
        self._body = body
        self._rng = rng
        self._north, self._noise = north, noise
        self._on = True
        self._calibrating = self._calibrated = False

    def obey(self, command: Command, now: float) -> bool:
        if not isinstance(command, commands.Tcm2):
            return False
        match mode := command.mode:
            case Tcm2Mode.USER_CALIBRATION | Tcm2Mode.AUTO_CALIBRATION:
                self._calibrating = True
            case Tcm2Mode.STOP_CALIBRATION:
                self._calibrated |= self._calibrating
                self._calibrating = False
            case _:
                self._on = mode is not Tcm2Mode.OFF
                self._request = HostRequest(mode is Tcm2Mode.ONCE, mode is Tcm2Mode.STREAM)
                if mode is Tcm2Mode.SOFT_RESET:
                    self._calibrating = self._calibrated = False
        return True

    def read(self, now: float) -> Report:
        """Return the heading, and the level field at it."""
        heading = self._heading()
        score = GOOD_SCORE if self._calibrated else 0
        return CompassReport(
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
        )

    def inputs(self, sip: SipFields, now: float) -> SipFields:
        """Show the heading in steps of 2 degrees, as ARIA reads it (facts.md 13, row 18)."""
        if not self._on:
            return sip
        return replace(sip, compass_raw=round(degrees(self._heading()) / 2) % 180)

    def _heading(self) -> float:
        heading = self._north - self._body.robot_in_world.theta
        if self._noise:
            heading += self._noise * float(self._rng.standard_normal())
        return heading % (2 * pi)


PERIOD = 0.025
"""Between two samples [s]."""
STILL = 512
TOP = 1023
STEP = radians(5 / 1023 * 300 / 2.5)
"""Rate of one count in ARIA, before its GyroScaler [rad/s]."""
MOST = 8
"""Samples that are kept for the next report."""
TEMPERATURE_RAW = 128
TELEPORT = 2.0
"""A rate above this times the model's top rate is not a turn: the robot was put elsewhere."""


class SimulatedGyro(Accessory):
    """Measures the true turn rate, wheel slip included, and reports samples on request.

    With `packets` off it is one whose readings the controller uses itself (GyroType 2): GYRO is
    taken, and nothing is sent.
    """

    def __init__(
        self,
        body: CarryingRobot,
        rng: Generator,
        *,
        packets: bool = True,
        bias: float = 0.0,
        noise: float = 0.0,
    ) -> None:
        """`bias` and the standard deviation `noise` are in [rad/s]."""
        self._body = body
        self._rng = rng
        self._packets = packets
        self._bias, self._noise = bias, noise
        self._step = STEP * body.model.gyro_scaler
        self._limit = TELEPORT * body.model.max_turn_rate
        self._on = False
        self._samples: deque[GyroSample] = deque(maxlen=MOST)
        self._time: float | None = None
        self._heading = 0.0
        self._turned, self._left = 0.0, PERIOD

    @property
    def due(self) -> float:
        """Time of the next sample [s]; `inf` without a request."""
        return self._time + self._left if self._on and self._time is not None else inf

    def tick(self, now: float) -> None:
        """Measure the turn since the last call; take a sample every 25 ms."""
        heading = self._body.robot_in_world.theta
        if self._time is not None and now > self._time:
            dt = now - self._time
            rate = wrap(heading - self._heading) / dt
            self._feel(rate if abs(rate) <= self._limit else 0.0, min(dt, MOST * PERIOD))
        self._time, self._heading = now, heading

    def _feel(self, rate: float, dt: float) -> None:
        while dt >= self._left - 1e-9:
            self._turned += rate * self._left
            dt -= self._left
            self._samples.append(self._sample(self._turned / PERIOD))
            self._turned, self._left = 0.0, PERIOD
        part = max(0.0, dt)
        self._turned += rate * part
        self._left -= part

    def _sample(self, rate: float) -> GyroSample:
        felt = rate + self._bias
        if self._noise:
            felt += self._noise * float(self._rng.standard_normal())
        raw = STILL - round(felt / self._step)
        return GyroSample(max(0, min(TOP, raw)), TEMPERATURE_RAW)

    def obey(self, command: Command, now: float) -> bool:
        """Switch the samples on or off; calibrations are taken and change nothing."""
        match command:
            case commands.Gyro(mode):
                self.tick(now)
                self._samples.clear()
                self._on = self._packets and mode is not GyroMode.OFF
            case commands.GyroCW() | commands.GyroCCW():
                pass
            case _:
                return False
        return True

    def reports(self, now: float, *, cycle: bool) -> Sequence[Report]:
        """Return the samples of the last cycle."""
        if not (self._on and cycle):
            return ()
        self.tick(now)
        samples = tuple(self._samples)
        self._samples.clear()
        return (GyroRates(samples),) if samples else ()

    def hang_up(self) -> None:
        self._on = False
