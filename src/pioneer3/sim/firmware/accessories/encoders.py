"""Encoders: counts of what the wheels rolled (arcos.md 5.2)."""

from collections.abc import Sequence

from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command
from pioneer3.arcos.reports import Encoders as EncoderReport
from pioneer3.arcos.reports import Report
from pioneer3.sim.firmware.accessories.base import Asked, Carrier, Inputs

TICKS_PER_METRE = {"skid": 138_000, "differential": 128_000}
"""Of a P3-AT and a P3-DX, as usually quoted of their manuals, unverified (arcos.md 5.1)."""


class Encoders:
    """Two counters of 32 bits that run from power-on; SETO does not reset them."""

    def __init__(self, body: Carrier) -> None:
        self._body = body
        self._ticks = TICKS_PER_METRE[body.model.drive]
        self._asked = Asked()

    def obey(self, command: Command, now: float) -> bool:
        """Take requests for reports."""
        match command:
            case commands.RequestEncoders(how):
                self._asked.ask(how)
                return True
        return False

    def reports(self, now: float, *, cycle: bool) -> Sequence[Report]:
        """Return the counts when they are due."""
        if not self._asked.due(cycle=cycle):
            return ()
        left, right = (_s32(way * self._ticks) for way in self._body.wheel_travel)
        return (EncoderReport(left_counts=left, right_counts=right),)

    def inputs(self, sip: Inputs, now: float) -> Inputs:
        """Nothing of this is in the standard report."""
        return sip

    def hang_up(self) -> None:
        """Send no more reports; the counters run on."""
        self._asked = Asked()


def _s32(count: float) -> int:
    """Return what a signed counter of 32 bits shows."""
    return (round(count) + (1 << 31)) % (1 << 32) - (1 << 31)
