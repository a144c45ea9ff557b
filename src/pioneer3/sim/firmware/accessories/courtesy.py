"""Commands that a robot takes without a sign: sounds, lamps, power switches and the like."""

from collections.abc import Sequence
from typing import Final

from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command
from pioneer3.arcos.reports import Report
from pioneer3.sim.firmware.accessories.base import Inputs

TAKEN: Final = frozenset(
    commands.NUMBERS[name]
    for name in (
        "AUX1BAUD",
        "AUX2BAUD",
        "CALCOMP",
        "JOYDRIVE",
        "MOVINGBLINK",
        "PLAYLIST",
        "POWER_12V",
        "POWER_5V",
        "POWER_AUDIO",
        "POWER_AUX_PC",
        "POWER_LRF",
        "POWER_LRF2",
        "POWER_PC",
        "POWER_PTZ",
        "POWER_TOUCHSCREEN",
        "PTUPOS",
        "SOUND",
        "SOUNDTOG",
    )
) | {commands.Say.ID}


class Courtesy:
    """Takes commands that have no effect on anything that is simulated, and says nothing."""

    def obey(self, command: Command, now: float) -> bool:
        """Return whether `command` is one of them."""
        return command.ID in TAKEN

    def reports(self, now: float, *, cycle: bool) -> Sequence[Report]:
        """There are none."""
        return ()

    def inputs(self, sip: Inputs, now: float) -> Inputs:
        """Nothing of this is in the standard report."""
        return sip

    def hang_up(self) -> None:
        """There is nothing to stop."""
