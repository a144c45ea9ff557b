"""What the battery says of itself (arcos.md 5.9)."""

from collections.abc import Sequence

from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command
from pioneer3.arcos.reports import BatteryInfo, Report, SmartBattery
from pioneer3.sim.body import EMPTY, FULL
from pioneer3.sim.firmware.accessories.base import Asked, Carrier, Cells, Inputs

LOW = 11.5
"""The firmware complains from here on [V]; CONFIG tells it (arcos.md 5.1)."""


def charge_percent(cells: Cells) -> int:
    """Return what is left, 0 to 100; a voltage that a test has set decides, where there is one."""
    fixed = cells.fixed
    share = cells.charge if fixed is None else (fixed - EMPTY) / (FULL - EMPTY)
    return max(0, min(100, round(100 * share)))


class BatteryGauge:
    """One battery with a gauge; its flags are all clear."""

    def __init__(self, body: Carrier) -> None:
        self._body = body
        self._asked = Asked()

    def obey(self, command: Command, now: float) -> bool:
        """Take requests for reports."""
        match command:
            case commands.RequestBatteryInfo(how):
                self._asked.ask(how)
                return True
        return False

    def reports(self, now: float, *, cycle: bool) -> Sequence[Report]:
        """Return the charge when it is due."""
        if not self._asked.due(cycle=cycle):
            return ()
        percent = charge_percent(self._body.battery)
        battery = SmartBattery(
            flags1=0,
            flags2=0,
            flags3=0,
            relative_charge_percent=percent,
            absolute_charge_percent=percent,
        )
        return (BatteryInfo((battery,)),)

    def inputs(self, sip: Inputs, now: float) -> Inputs:
        """The voltage in the standard report is the firmware's."""
        return sip

    def hang_up(self) -> None:
        """Send no more reports."""
        self._asked = Asked()
