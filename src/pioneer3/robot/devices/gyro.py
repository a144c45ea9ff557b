"""The gyro with which the host corrects the heading (protocol.md 5.4)."""

from dataclasses import dataclass
from typing import Final

from pioneer3.arcos import commands, reports
from pioneer3.arcos.commands import GyroMode
from pioneer3.arcos.reports import Report
from pioneer3.geometry import Twist2, wrap
from pioneer3.models.model import GYRO_SCALER
from pioneer3.robot.devices.presence import Presence
from pioneer3.robot.devices.sensor import Sensor, SensorKind, Shown
from pioneer3.robot.report_requests import ReportRequest
from pioneer3.robot.supervisor import Supervisor
from pioneer3.units import DEGREE, MM

SAMPLE = 0.025
"""Interval of samples [s]."""
STANDING = Twist2(1 * MM, 1 * DEGREE)
NEARLY_STANDING = Twist2(2 * MM, 2 * DEGREE)
NOISE = 2
"""Rates this close to zero count as zero while the robot nearly stands [raw]."""
SPREAD = 0.005
"""Share of the running mean: a rate farther off is no standstill."""
LEAST_TIME, LEAST_SAMPLES = 1.0, 25
DEGREES_PER_STEP = 5 / 1023 * 300 / 2.5
"""The converter's volts, and the sensor's degrees per second and volt."""


@dataclass(frozen=True, slots=True, kw_only=True)
class GyroReading:
    """The gyro at one instant.

    Attributes:
        heading: Turned since the first standstill, counter-clockwise [rad], in (-pi, pi].
        rate: Turn rate in the last sample [rad/s].
        temperature_raw: In the last sample, uncalibrated.
    """

    stamp: float
    heading: float
    rate: float
    temperature_raw: int


class GyroHeading:
    """Integrates rates; learns the zero while the robot stands. Pure; as ARIA's `ArAnalogGyro`."""

    def __init__(self, scaler: float = GYRO_SCALER) -> None:
        self.heading = self.rate = 0.0
        self._scale = -DEGREES_PER_STEP * scaler * DEGREE
        self._zero: float | None = None
        self._sum, self._count, self._since = 0.0, 0, 0.0

    def update(self, rate_raw: int, moving: Twist2, stamp: float) -> bool:
        """Take one sample, received at `stamp` [s]; return whether the zero is known."""
        self._learn(rate_raw, moving, stamp)
        if self._zero is None:
            return False
        off = rate_raw - self._zero
        quiet = _within(moving, NEARLY_STANDING) and abs(off) < NOISE
        self.rate = 0.0 if quiet else off * self._scale
        self.heading = wrap(self.heading + self.rate * SAMPLE)
        return True

    def _learn(self, rate_raw: int, moving: Twist2, stamp: float) -> None:
        mean = self._sum / self._count if self._count else rate_raw
        if not _within(moving, STANDING) or abs(rate_raw - mean) > SPREAD * mean:
            self._count = 0
            return
        if not self._count:
            self._sum, self._since = 0.0, stamp
        self._sum += rate_raw
        self._count += 1
        if stamp - self._since > LEAST_TIME and self._count > LEAST_SAMPLES:
            self._zero, self._count = self._sum / self._count, 0


GYRO: Final = SensorKind(
    name="gyro",
    title="the gyro",
    request=ReportRequest(
        begin=(commands.Gyro(GyroMode.ON),),
        end=(commands.Gyro(GyroMode.OFF),),
        answers=(reports.GyroRates,),
    ),
    reports=(reports.GyroRates,),
    shown=(
        Shown("heading", "heading", "°", 1 / DEGREE, 1),
        Shown("rate", "rate", "°/s", 1 / DEGREE, 1),
    ),
)


class Gyro(Sensor[GyroReading]):
    """Streams the heading of a gyro of type 1; types from 2 on correct the robot's own heading."""

    def __init__(self, supervisor: Supervisor) -> None:
        super().__init__(supervisor, GYRO, self._read_rates)
        model = supervisor.info.model if supervisor.info else None
        self._heading = GyroHeading(model.gyro_scaler if model else GYRO_SCALER)

    @property
    def presence(self) -> Presence:
        """Whether one sends samples: CONFIG's GyroType (protocol.md 5.1, field 42)."""
        config = self._supervisor.info.config if self._supervisor.info else None
        kind = config.gyro_type if config else None
        if self.latest is not None or kind == 1:
            return Presence(True, "The robot has a gyro that sends its samples (GyroType 1).")
        if kind is None:
            return Presence(None, "Nobody knows of a gyro: the robot's CONFIG does not tell.")
        if kind == 0:
            return Presence(False, "The robot has no gyro: its CONFIG says GyroType 0.")
        return Presence(
            False,
            f"The robot corrects its heading with its gyro itself (GyroType {kind}):"
            " there are no samples.",
        )

    def set_mode(self, mode: GyroMode) -> None:
        """Send GYRO `mode`: off, on, or heading of the gyro only; CommandError without a robot."""
        self._supervisor.send(commands.Gyro(mode))

    def _read_rates(self, report: Report, stamp: float) -> GyroReading | None:
        snapshot = self._supervisor.snapshot
        if not isinstance(report, reports.GyroRates) or snapshot is None or not report.samples:
            return None
        known = [
            self._heading.update(sample.rate_raw, snapshot.odometry.twist, stamp)
            for sample in report.samples
        ]
        if not known[-1]:
            return None
        return GyroReading(
            stamp=stamp,
            heading=self._heading.heading,
            rate=self._heading.rate,
            temperature_raw=report.samples[-1].temperature_raw,
        )


def _within(moving: Twist2, bound: Twist2) -> bool:
    return abs(moving.v) < bound.v and abs(moving.w) < bound.w
