"""Digital and analog inputs and outputs of the controller (protocol.md 5.3, facts.md 8.10)."""

from dataclasses import dataclass
from typing import Final

from pioneer3.arcos import commands, reports
from pioneer3.arcos.commands import RequestMode
from pioneer3.arcos.reports import Report
from pioneer3.errors import CommandError
from pioneer3.robot.devices.presence import Presence
from pioneer3.robot.devices.sensor import Sensor, SensorKind
from pioneer3.robot.report_requests import ReportRequest
from pioneer3.robot.supervisor import Supervisor, is_simulator

ANALOG_BITS = 0xFFF
"""Bits of an analog reading (protocol.md 5.3)."""
ANALOG_STEP = 0.0048828
"""Unit of an analog reading [V] (protocol.md 5.3)."""
OUTPUTS = range(8)
OLD_LASER = range(3)
"""Analog ports that simulators take for the old laser's switch (protocol.md 3.3)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LinesReading:
    """All lines at one instant; `analog` is in [V], by port.

    Attributes:
        digital_in: Whether each line is high, shape (8 n,); line 8 is the first of byte 1.
    """

    stamp: float
    digital_in: tuple[bool, ...]
    digital_out: tuple[bool, ...]
    analog: tuple[float, ...]


def read_io(io: reports.Io, stamp: float) -> LinesReading:
    """Return the reading in an IO packet."""
    return LinesReading(
        stamp=stamp,
        digital_in=_bits(io.digital_in),
        digital_out=_bits(io.digital_out),
        analog=tuple((raw & ANALOG_BITS) * ANALOG_STEP for raw in io.analog_raw),
    )


LINES: Final = SensorKind(
    name="lines",
    title="the I/O lines",
    request=ReportRequest(
        begin=(commands.IoRequest(RequestMode.STREAM),),
        end=(commands.IoRequest(RequestMode.STOP),),
        answers=(reports.Io,),
    ),
    reports=(reports.Io,),
)


class Lines(Sensor[LinesReading]):
    """Reads all lines and sets the digital outputs."""

    def __init__(self, supervisor: Supervisor) -> None:
        super().__init__(supervisor, LINES, _read)

    @property
    def presence(self) -> Presence:
        """Every controller has lines; the first IO packet shows that it sends their states."""
        if self.latest is not None:
            return Presence(True, "The controller sends IO packets.")
        return Presence(None, "Every controller has lines; it has sent no IO packet yet.")

    def set_output(self, line: int, *, high: bool) -> None:
        """Set one digital output, 0 to 7, and no other; CommandError without it, or a robot."""
        if line not in OUTPUTS:
            raise CommandError(f"digital output {line}: there are 0 to {OUTPUTS[-1]}")
        self.set_outputs(1 << line, high << line)

    def set_outputs(self, mask: int, values: int) -> None:
        """Set the digital outputs that `mask` selects to the bits of `values`.

        Raises:
            CommandError: not 0 to 255, or no robot is connected.
        """
        self._supervisor.send(commands.DigOut(mask=mask, values=values))

    def select_analog(self, port: int) -> None:
        """Choose the analog port that snapshots show; it stays until another one is chosen.

        Raises:
            CommandError: no robot is connected, or a simulator would take it for its laser.
        """
        if port in OLD_LASER and is_simulator(self._supervisor.info):
            raise CommandError(
                f"analog port {port}: for simulators this command is the old laser's switch;"
                " read all ports from the IO packets"
            )
        self._supervisor.send(commands.AdSel(port))


def _read(report: Report, stamp: float) -> LinesReading | None:
    return read_io(report, stamp) if isinstance(report, reports.Io) else None


def _bits(data: tuple[int, ...]) -> tuple[bool, ...]:
    return tuple(bool(byte >> bit & 1) for byte in data for bit in range(8))
