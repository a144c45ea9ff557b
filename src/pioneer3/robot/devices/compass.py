"""The TCM2 compass (protocol.md 5.7, facts.md 8.14)."""

from dataclasses import dataclass
from typing import Final

from pioneer3.arcos import commands, reports
from pioneer3.arcos.commands import Tcm2Mode
from pioneer3.arcos.reports import Report
from pioneer3.geometry import wrap
from pioneer3.robot.devices.presence import Presence
from pioneer3.robot.devices.sensor import Sensor, SensorKind, Shown
from pioneer3.robot.report_requests import ReportRequest
from pioneer3.robot.supervisor import Supervisor
from pioneer3.units import DEGREE


@dataclass(frozen=True, slots=True, kw_only=True)
class CompassReading:
    """The compass at one instant.

    Attributes:
        heading: Clockwise from magnetic north, as on every compass [rad], in (-pi, pi].
        magnetic: Field along x, y and z, in the module's unit (usually uT).
        temperature: [degrees Celsius].
        calibration_h: Score of the horizontal calibration; `v` is the vertical one, `m` magnetic.
    """

    stamp: float
    heading: float
    pitch: float
    roll: float
    magnetic: tuple[float, float, float]
    temperature: float
    error: int
    calibration_h: int
    calibration_v: int
    calibration_m: float


def read_compass(report: reports.Compass, stamp: float) -> CompassReading:
    """Return the reading in a TCM2 packet."""
    return CompassReading(
        stamp=stamp,
        heading=wrap(report.heading_decidegrees / 10 * DEGREE),
        pitch=report.pitch_decidegrees / 10 * DEGREE,
        roll=report.roll_decidegrees / 10 * DEGREE,
        magnetic=(
            report.magnetic_x_hundredths / 100,
            report.magnetic_y_hundredths / 100,
            report.magnetic_z_hundredths / 100,
        ),
        temperature=report.temperature_decicelsius / 10,
        error=report.error & 0xFFFF,
        calibration_h=report.calibration_h,
        calibration_v=report.calibration_v,
        calibration_m=report.calibration_m_hundredths / 100,
    )


class TcmCompass(Sensor[CompassReading]):
    """Streams packets while they are wanted; then only the standard report has the heading."""

    def __init__(self, supervisor: Supervisor) -> None:
        super().__init__(supervisor, COMPASS, _read)

    @property
    def presence(self) -> Presence:
        """Whether there is one: its packets and the standard report show it, CONFIG does not."""
        snapshot = self._supervisor.snapshot
        if self.latest is not None:
            return Presence(True, "The TCM2 compass answers.")
        if snapshot is not None and snapshot.inputs.compass is not None:
            return Presence(True, "The robot has a compass: its standard report has a heading.")
        return Presence(None, "No TCM2 packet has come yet: CONFIG does not tell of a compass.")

    def set_mode(self, mode: Tcm2Mode) -> None:
        """Send TCM2 `mode`: off, in the standard report only, once, stream, calibrate, reset.

        While packets are wanted a new session begins with this mode too.

        Raises:
            CommandError: no robot is connected.
        """
        if self.is_wanted:
            self.change(_request(mode))
        else:
            self._supervisor.send(commands.Tcm2(mode))


def _request(mode: Tcm2Mode) -> ReportRequest:
    streams = mode is Tcm2Mode.STREAM
    return ReportRequest(
        begin=(commands.Tcm2(mode),),
        end=(commands.Tcm2(Tcm2Mode.SIP_ONLY),),
        answers=(reports.Compass,) if streams else (),
    )


COMPASS: Final = SensorKind(
    name="compass",
    title="the TCM2 compass",
    request=_request(Tcm2Mode.STREAM),
    reports=(reports.Compass,),
    shown=(
        Shown("heading", "heading", "°", 1 / DEGREE),
        Shown("pitch", "pitch", "°", 1 / DEGREE, 1),
        Shown("roll", "roll", "°", 1 / DEGREE, 1),
        Shown("temperature", "temperature", "°C", 1.0, 1),
    ),
)


def _read(report: Report, stamp: float) -> CompassReading | None:
    return read_compass(report, stamp) if isinstance(report, reports.Compass) else None
