"""Digital and analog inputs and outputs of the controller (arcos.md 3.2, 4.2, 5.3)."""

from collections.abc import Callable, Sequence
from math import isfinite

from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command
from pioneer3.arcos.reports import Io, Report
from pioneer3.errors import ConfigError
from pioneer3.sim.firmware.accessories.base import Asked, Inputs

BYTES_IN = 4
"""What a P3 has (arcos.md 5.3)."""
LINES = 8 * BYTES_IN
PORTS = 8
FULL_SCALE = 5.0
"""[V]."""
STEPS = 1023
"""Of the converter behind IO reports: 4.8828 mV each (arcos.md 5.3)."""
SIP_STEPS = 255
ALL_HIGH = (1 << LINES) - 1


def nothing_low() -> int:
    """Return the lines that sensors hold low where there are none."""
    return 0


class DigitalIo:
    """32 inputs and 8 outputs, all high at first, and 8 analog ports of 0 to 5 V.

    Attributes:
        outputs: Bits, 1 is high.
        ports_on: Outputs of the controller that SETPBIOPORT switched on; 11 is laser power.
        selected: The analog port that the standard report shows.
    """

    def __init__(self, held_low: Callable[[], int] = nothing_low) -> None:
        """`held_low` returns the input lines that sensors pull down now, as bits."""
        self.outputs = 0xFF
        self.ports_on: set[int] = set()
        self.selected = 0
        self._inputs = ALL_HIGH
        self._volts = [0.0] * PORTS
        self._held_low = held_low
        self._asked = Asked()

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
                self._asked.ask(how)
            case _:
                return False
        return True

    def reports(self, now: float, *, cycle: bool) -> Sequence[Report]:
        """Return the IO report when it is due."""
        if not self._asked.due(cycle=cycle):
            return ()
        return (
            Io(
                digital_in=tuple(self._levels().to_bytes(BYTES_IN, "little")),
                digital_out=(self.outputs,),
                analog_raw=tuple(round(volts / FULL_SCALE * STEPS) for volts in self._volts),
            ),
        )

    def inputs(self, sip: Inputs, now: float) -> Inputs:
        """Show the first byte of inputs, the outputs and the selected analog port."""
        # in every report of every robot: by hand, as replace() takes three times as long
        return Inputs(
            analog_port=self.selected,
            gripper_state=sip.gripper_state,
            analog=round(self._volts[self.selected] / FULL_SCALE * SIP_STEPS),
            digital_in=self._levels() & 0xFF,
            digital_out=self.outputs,
            compass_raw=sip.compass_raw,
            flags=sip.flags,
        )

    def hang_up(self) -> None:
        """Send no more reports; the outputs stay as they are."""
        self._asked = Asked()

    def _levels(self) -> int:
        return self._inputs & ~self._held_low() & ALL_HIGH
