"""Digital and analog inputs and outputs, and table sensors (protocol.md 3.2, 4.2, 4.7, 5.3)."""

from collections.abc import Callable
from enum import IntFlag
from math import isfinite

from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command
from pioneer3.arcos.reports import Io, Report
from pioneer3.errors import ConfigError
from pioneer3.sim.accessories.base import ReportingAccessory, SipFields
from pioneer3.sim.equipment import TableWiring

BYTES_IN = 4
"""Input bytes of a P3 (protocol.md 5.3)."""
LINES = 8 * BYTES_IN
PORTS = 8
FULL_SCALE = 5.0
"""[V]."""
STEPS = 1023
"""Steps of the converter behind IO reports: 4.8828 mV each (protocol.md 5.3)."""
SIP_STEPS = 255
ALL_HIGH = (1 << LINES) - 1


class DigitalIo(ReportingAccessory):
    """32 inputs and 8 outputs, all high at first, and 8 analog ports of 0 to 5 V.

    Of the bits of `outputs` 1 is high; SETPBIOPORT has switched on the controller's `ports_on`, of
    which 11 is laser power; the standard report shows the analog port `selected`.
    """

    def __init__(self, held_low: Callable[[], int] = lambda: 0) -> None:
        """`held_low` returns the input lines that sensors pull down now, as bits."""
        super().__init__()
        self.outputs = 0xFF
        self.ports_on: set[int] = set()
        self.selected = 0
        self._inputs = ALL_HIGH
        self._volts = [0.0] * PORTS
        self._held_low = held_low

    def set_input(self, line: int, *, high: bool) -> None:
        """Put a level on input `line`, 0..31; line 8 is the first of the second byte."""
        if not 0 <= line < LINES:
            raise ConfigError(f"digital input {line}: there are 0 to {LINES - 1}")
        self._inputs = self._inputs | 1 << line if high else self._inputs & ~(1 << line)

    def set_analog(self, port: int, volts: float) -> None:
        """Put `volts` on analog `port`, 0..7; the converter ends at 0 and 5 V."""
        if not 0 <= port < PORTS:
            raise ConfigError(f"analog port {port}: there are 0 to {PORTS - 1}")
        if not isfinite(volts):
            raise ConfigError(f"analog port {port}: {volts} V is not a voltage")
        self._volts[port] = max(0.0, min(FULL_SCALE, volts))

    def obey(self, command: Command, now: float) -> bool:
        """Set outputs, choose the analog port, take requests for IO reports."""
        match command:
            case commands.DigOut(mask, values):
                self.outputs = self.outputs & ~mask | values & mask
            case commands.AdSel(port):
                self.selected = port if port < PORTS else self.selected
            case commands.SetPbioPort(port, on):
                (self.ports_on.add if on else self.ports_on.discard)(port)
            case commands.IoRequest(how):
                self._request.set(how)
            case _:
                return False
        return True

    def read(self, now: float) -> Report:
        return Io(
            digital_in=tuple(self._levels().to_bytes(BYTES_IN, "little")),
            digital_out=(self.outputs,),
            analog_raw=tuple(round(volts / FULL_SCALE * STEPS) for volts in self._volts),
        )

    def inputs(self, sip: SipFields, now: float) -> SipFields:
        """Show the first byte of inputs, the outputs and the selected analog port."""
        # in every report of every robot: by hand, as replace() takes three times as long
        return SipFields(
            analog_port=self.selected,
            gripper_state=sip.gripper_state,
            analog=round(self._volts[self.selected] / FULL_SCALE * SIP_STEPS),
            digital_in=self._levels() & 0xFF,
            digital_out=self.outputs,
            compass_raw=sip.compass_raw,
            flags=sip.flags,
        )

    def _levels(self) -> int:
        return self._inputs & ~self._held_low() & ALL_HIGH


class TableSensor(IntFlag):
    """The four sensors; bit i is the model's sensor i, and the line of the new wiring.

    The sides are those of protocol.md 4.7. ARIA's `ArIRs` goes by the number alone: bit i of the
    fourth input byte is IRUnit i of the parameter file.
    """

    RIGHT = 1 << 0
    LEFT = 1 << 1
    LEFT_BEAM = 1 << 2
    RIGHT_BEAM = 1 << 3


OLD_LINES = {
    TableSensor.LEFT: 0,
    TableSensor.RIGHT: 1,
    TableSensor.RIGHT_BEAM: 2,
    TableSensor.LEFT_BEAM: 3,
}
"""Digital inputs of the old wiring."""
NEW_LINES = {sensor: 24 + bit for bit, sensor in enumerate(TableSensor)}
"""The fourth byte of the inputs."""


class TableIr:
    """Holds an input line low while its sensor is covered, which is done by hand."""

    def __init__(self, wiring: TableWiring = "new") -> None:
        self.covered = TableSensor(0)
        self._lines = OLD_LINES if wiring == "old" else NEW_LINES

    def held_low(self) -> int:
        """Return the digital inputs that the sensors hold low, as bits."""
        return sum(1 << line for sensor, line in self._lines.items() if sensor in self.covered)
