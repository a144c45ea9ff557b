"""Commands that a robot takes without a sign: sounds, lamps, power switches and the like."""

from collections.abc import Sequence
from typing import Final

from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command
from pioneer3.arcos.reports import Report
from pioneer3.sim.firmware.accessories.base import Inputs

TAKEN: Final = frozenset(
    {
        commands.Aux1Baud.ID,
        commands.Aux2Baud.ID,
        commands.CalComp.ID,
        commands.JoyDrive.ID,
        commands.MovingBlink.ID,
        commands.Power12V.ID,
        commands.Power5V.ID,
        commands.PowerAudio.ID,
        commands.PowerAuxPc.ID,
        commands.PowerLrf.ID,
        commands.PowerLrf2.ID,
        commands.PowerPc.ID,
        commands.PowerPtz.ID,
        commands.PowerTouchscreen.ID,
        commands.PtuPos.ID,
        commands.RequestPlaylist.ID,
        commands.Say.ID,
        commands.Sound.ID,
        commands.SoundTog.ID,
    }
)


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
