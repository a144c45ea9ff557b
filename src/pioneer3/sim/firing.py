"""The order in which transducers fire: each array of eight has its own, all at the same beat."""

ARRAY = 8
"""Transducers of an array."""

Firing = tuple[tuple[int, ...], ...]
"""Of each array the transducers that fire, in turn, over and over; `()` of one that is off."""


def in_order(count: int) -> Firing:
    """Return the firing of so many transducers as robots are delivered: by their numbers."""
    arrays = range(0, count, ARRAY)
    return tuple(tuple(range(first, min(first + ARRAY, count))) for first in arrays)


def fired(firing: Firing, first: int, last: int) -> dict[int, int]:
    """Return who fires at the beats `first` to `last`, without `last`, and who did before each."""
    pairs = {}
    for order in firing:
        for beat in range(max(first, last - len(order)), last):
            pairs[order[beat % len(order)]] = order[(beat - 1) % len(order)]
    return pairs
