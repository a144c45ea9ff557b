"""What fires within a step, for all robots at once."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import lcm

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.firing import Firing, fired
from pioneer3.sim.kernels import Mounts

Int = NDArray[np.int64]

MOST_KEPT = 64
"""Volleys that are kept: default orders in steps of 20 ms to 0.1 s need at most 16."""


@dataclass(frozen=True, slots=True)
class Part:
    """What the robots of one type have in a volley.

    Attributes:
        robots: Which they are: all of them, or indices.
        fire: Their transducers that do, shape (F,).
        before: Those of the same arrays that fired before these, shape (F,).
    """

    robots: slice | Int
    fire: Int
    before: Int


@dataclass(frozen=True, slots=True)
class Volley:
    """All that fires within a step.

    Attributes:
        mounts: The transducers.
        parts: Robot type by robot type; types of which none fires are left out.
    """

    mounts: Mounts
    parts: tuple[Part, ...]


class Volleys:
    """Works out who fires, and keeps it, as it comes again.

    Args:
        mounts: All transducers.
        firings: Of each type of robots in `mounts`.

    Attributes:
        mounts: All transducers.
    """

    def __init__(self, mounts: Mounts, firings: Sequence[Firing]) -> None:
        self.mounts, self._firings = mounts, firings
        lengths = [len(order) for firing in firings for order in firing if order]
        self._period, self._longest = lcm(*lengths), max(lengths, default=0)
        self._kept: dict[tuple[int, int], Volley] = {}

    def of(self, first: int, last: int) -> Volley:
        """Return who fires at the beats `first` to `last`, without `last`."""
        first = max(first, last - self._longest)
        key = first % self._period, last - first
        if key not in self._kept:
            if len(self._kept) == MOST_KEPT:
                self._kept.clear()
            self._kept[key] = self._work_out([fired(each, first, last) for each in self._firings])
        return self._kept[key]

    def _work_out(self, types: Sequence[dict[int, int]]) -> Volley:
        parts = []
        for number, pair in enumerate(types):
            if pair:
                whose = np.flatnonzero(self.mounts.kinds == number)
                robots = slice(None) if len(types) == 1 else whose
                parts.append(Part(robots, np.array([*pair]), np.array([*pair.values()])))
        return Volley(self.mounts.only([[*pair] for pair in types]), tuple(parts))
