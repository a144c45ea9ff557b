"""The mirror of an LMS-2xx: turns with pulses 1 degree apart, and scans put together from them."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, radians
from statistics import fmean

from pioneer3.lasers.device import MirrorTurn, Sweep
from pioneer3.lasers.lms2xx.measuring import MIRROR_TURN, PULSE_STEP_CDEG, Variant


@dataclass(frozen=True, slots=True)
class TurnReadings:
    """Ranges [m] and intensities, as in a `Sweep`, of one turn or of a whole scan."""

    ranges: list[float]
    intensities: list[float]


def _turn(variant: Variant, number: int) -> MirrorTurn:
    """Return a turn of a scan; each is a step further left (lms2xx.md 1.9)."""
    return MirrorTurn(
        first=variant.first + number * variant.step,
        step=radians(PULSE_STEP_CDEG / 100),
        count=variant.field_deg + (number == 0),
        beam_time=MIRROR_TURN * PULSE_STEP_CDEG / 36000,
        period=MIRROR_TURN,
    )


class Mirror:
    """The turns of a variant, again and again; `number` is the next one's in its scan, from 0."""

    def __init__(self, variant: Variant) -> None:
        self.restart(variant)

    def restart(self, variant: Variant) -> None:
        """Begin with the first turn of a scan of `variant`."""
        self.variant = variant
        self.number = 0
        self._turns = [_turn(variant, number) for number in range(variant.turns)]
        self._taken: list[Sweep] = []

    @property
    def turn(self) -> MirrorTurn:
        """The next turn."""
        return self._turns[self.number]

    def add(self, sweep: Sweep) -> TurnReadings | None:
        """Take the readings of the next turn; return those of the scan if it is the last one."""
        self._taken.append(sweep)
        self.number = (self.number + 1) % self.variant.turns
        if self.number:
            return None
        scan = TurnReadings([0.0] * self.variant.count, [0.0] * self.variant.count)
        for number, taken in enumerate(self._taken):
            scan.ranges[number :: self.variant.turns] = taken.ranges
            scan.intensities[number :: self.variant.turns] = taken.intensities
        self._taken = []
        return scan


def mean_of(scans: Sequence[TurnReadings]) -> TurnReadings:
    """Return the mean of scans; a reading that has no range in some is the mean of the others."""
    ranges = []
    for column in zip(*[scan.ranges for scan in scans], strict=True):
        seen = [metres for metres in column if metres < inf]
        ranges.append(fmean(seen) if seen else inf)
    lights = zip(*[scan.intensities for scan in scans], strict=True)
    return TurnReadings(ranges, [fmean(column) for column in lights])
