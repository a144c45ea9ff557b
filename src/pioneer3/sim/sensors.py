"""Sensors of a body.

Transducers come in arrays of eight. Each array has an order of its own; all fire at the same rate.
"""

from dataclasses import dataclass

SONAR_RANGE = 5.0
"""The reading of a transducer that hears no echo, and the farthest it hears [m] (facts.md 7.2)."""
SONAR_MIN = 0.1
"""Nearer echoes come while the transducer still rings [m] (facts.md 9.6)."""
LASER_RANGE = 32.0
"""Range of a SICK LMS-200 in 10 mm mode [m]."""

ARRAY = 8
"""Transducers of an array."""

Firing = tuple[tuple[int, ...], ...]
"""For each array the transducers that fire, in turn, over and over; `()` if the array is off."""


def in_order(count: int) -> Firing:
    """Return the firing of so many transducers as robots are delivered: by their numbers."""
    arrays = range(0, count, ARRAY)
    return tuple(tuple(range(first, min(first + ARRAY, count))) for first in arrays)


def fired(firing: Firing, first: int, last: int) -> dict[int, int]:
    """Return the transducers that fire in slots `first` to `last`, without `last`.

    Each is mapped to the transducer of its array that fires one slot before it.
    """
    pairs = {}
    for order in firing:
        for slot in range(max(first, last - len(order)), last):
            pairs[order[slot % len(order)]] = order[(slot - 1) % len(order)]
    return pairs


GRAVITY = 9.81
"""[m/s2]."""


@dataclass(frozen=True, slots=True)
class ImuReading:
    """A reading of a gyro [rad/s] and an accelerometer [m/s2] at a robot's origin.

    Both are about x (ahead), y (left) and z (up); at rest on a level floor the acceleration is 9.81
    upwards.
    """

    rates: tuple[float, float, float]
    acceleration: tuple[float, float, float]
