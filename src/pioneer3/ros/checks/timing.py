"""Checks when messages come, and their stamps. Pure."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from statistics import median
from typing import Final

from pioneer3.ros.checks.facts import CheckFault, Sample, fail, warn

ENOUGH: Final = 0.5
"""Fewer messages than this share of the expected ones are a fault."""
NEARLY: Final = 0.85
"""Fewer than this share are worth a look."""
PERIODS: Final = 3.0
"""A rate is judged after so many periods."""
PAUSE: Final = 5.0
"""A pause of more than so many periods is worth a look."""
SHORTEST_PAUSE: Final = 0.5
"""Shortest pause that is worth a look [s]."""
SILENT: Final = 1.0
"""A topic that is silent for so long [s] before the end is not published any more."""
FUTURE: Final = 0.1
"""Stamps may be this far ahead [s]: clocks of two computers differ a little."""
OLD: Final = 1.0
"""Older stamps [s] are of things past: a robot has moved on."""
LATE: Final = 0.3
"""Stamps that are commonly older [s] are refused by the usual tolerances of transforms."""
FEW: Final = 0.1
"""A smaller share of bad stamps is a hiccup of the computer."""
NANO: Final = 1e9
CLOCKS: Final = "do the clocks agree? timedatectl on both computers; chrony keeps them together"


def rate(samples: Sequence[Sample]) -> float | None:
    """Return the messages that came in a second [Hz]; `None` where fewer than two came."""
    if len(samples) < 2:
        return None
    span = samples[-1].at - samples[0].at
    return (len(samples) - 1) / span if span > 0 else None


def rate_faults(
    samples: Sequence[Sample], expected: float, listened: float, *, ended: float, optional: bool
) -> Iterator[CheckFault]:
    """Yield the faults in the rate of one message or more, where `expected` [Hz] is counted on.

    Listening took `listened` [s] and ended at `ended` [s, as the messages have it].
    """
    if listened < PERIODS / expected:
        return
    measured = rate(samples) or len(samples) / listened
    tell = warn if optional or measured > ENOUGH * expected else fail
    if measured < NEARLY * expected:
        yield tell("it comes too seldom", example=f"{measured:.1f} Hz, not {expected:g} Hz")
    pause = max((after.at - before.at for before, after in pairwise(samples)), default=0.0)
    if pause > max(PAUSE / expected, SHORTEST_PAUSE):
        yield warn("it pauses", example=f"for {pause:.1f} s")
    silent = ended - samples[-1].at
    if silent > max(PAUSE / expected, SILENT):
        yield (warn if optional else fail)(
            "it has fallen silent",
            example=f"for {silent:.1f} s at the end",
            advice="is the node still running, and its robot there?",
        )


@dataclass(frozen=True, slots=True)
class StampedMessage:
    """A stamp, and the ROS time when it came [ns]."""

    stamp: int
    now: int | None

    @property
    def age(self) -> float:
        """Time from the stamp to the arrival [s]; 0 where no time is known."""
        return 0.0 if self.now is None else (self.now - self.stamp) / NANO


def stamp_faults(
    stamped: Iterable[StampedMessage], *, future: float = FUTURE
) -> Iterator[CheckFault]:
    """Yield the faults in the stamps of one publisher, which may be `future` [s] ahead.

    They are given in the order in which they came.
    """
    everything = list(stamped)
    known = [each for each in everything if each.stamp]
    if len(known) < len(everything):
        yield fail("stamps are 0", advice="put the time of the measurement into header.stamp")
    if not known:
        return
    yield from _order(known)
    ages = [each.age for each in known]
    ahead = [age for age in ages if age < -future]
    if len(ahead) > FEW * len(ages):
        yield fail("stamps are in the future", example=f"by {-min(ahead):.2f} s", advice=CLOCKS)
    old = [age for age in ages if age > OLD]
    if len(old) > FEW * len(ages):
        yield fail(
            "stamps are old", example=f"{median(old):.1f} s", advice=f"stale data, or {CLOCKS}"
        )
    elif (usual := median(ages)) > LATE:
        yield warn("stamps are late", example=f"commonly {usual:.2f} s", advice=CLOCKS)


def _order(known: Sequence[StampedMessage]) -> Iterator[CheckFault]:
    steps = [after.stamp - before.stamp for before, after in pairwise(known)]
    back = sum(step < 0 for step in steps)
    if back:
        yield fail("stamps go back", example=f"{back} of {len(known)}")
    again = sum(step == 0 for step in steps)
    if again:
        yield fail(
            "stamps repeat",
            example=f"{again} of {len(known)}",
            advice="old data is sent again, or the stamp is not that of the measurement",
        )
