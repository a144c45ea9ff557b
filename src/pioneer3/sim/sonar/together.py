"""Sonars that all measure whenever they are asked: what an ideal robot has."""

from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from itertools import chain

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from pioneer3.sim.body import Body
from pioneer3.sim.firing import Firing
from pioneer3.sim.realism import SonarErrors
from pioneer3.sim.sensors import SONAR_MIN, SONAR_RANGE
from pioneer3.sim.sonar.base import Cast
from pioneer3.sim.sonar.mounts import mounts_of

Float = NDArray[np.float64]
Int = NDArray[np.int64]


class Together:
    """Same contract as `Sonars`.

    Args:
        errors: What is heard in place of exact ranges.
        cast: Measures.
        own: Where each robot's chances come from, so that asking one changes no other.
        rng: Where those come from when all are asked.
    """

    def __init__(
        self, errors: SonarErrors, cast: Cast, own: Mapping[Body, Generator], rng: Generator
    ) -> None:
        self._errors, self._cast, self._own, self._rng = errors, cast, own, rng
        self._spoils = errors.spoils
        self._exact: dict[int, Float] = {}
        self._expected: list[int] = []

    def arrange(self, robots: Sequence[Body], before: Sequence[int]) -> None:
        self._mounts, _ = mounts_of(robots, self._errors)
        absent = self._mounts.absent
        self._absent = absent if absent.any() else None
        self._expected = []
        self._exact.clear()

    def fires(self, body: Body) -> None:
        pass

    def changed(self) -> None:
        self._exact.clear()

    def placed(self, poses: Float) -> None:
        self._exact.clear()

    def passed(self, dt: float, poses: Float) -> None:
        self._expected = []
        self._exact.clear()

    def expect(self, bodies: Iterable[Body]) -> None:
        self._expected = [body.number for body in bodies]

    def of(self, body: Body) -> Float:
        if body.number not in self._exact:
            together = self._expected if body.number in self._expected else [body.number]
            ranges = self._cast(self._mounts, np.array(together, dtype=np.int32))
            self._exact.update(zip(together, ranges, strict=True))
        return self._heard(self._exact[body.number][: len(body.model.sonars)], self._own[body])

    def all(self) -> Float:
        heard = self._heard(self._cast(self._mounts, None), self._rng)
        if self._absent is not None:
            heard[self._absent] = SONAR_RANGE
        return heard

    def fresh(self, body: Body) -> tuple[Int, Float]:
        numbers = _numbers(body.firing)
        return numbers, self.of(body)[numbers]

    def _heard(self, ranges: Float, rng: Generator) -> Float:
        """Return what is heard in place of exact `ranges` (..., M)."""
        if self._spoils:
            ranges = self._errors.spoil(ranges, SONAR_RANGE, rng)
        return np.maximum(ranges, SONAR_MIN)


@lru_cache(maxsize=64)
def _numbers(firing: Firing) -> Int:
    """Return the transducers that fire, ascending; not to be changed."""
    return np.array(sorted({*chain(*firing)}), dtype=np.int64)
