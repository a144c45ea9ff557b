"""The sonars of all robots of a world: when transducers fire, and the ranges that they measure.

Real transducers fire one after the other (docs/explanation/realism.md): all robots have the same
time slots. A step has as many slots as fit in it, and a transducer that fires in one of them
measures from the robot's pose at the end of the step. The others keep their latest range. Without
realism all transducers measure whenever they are asked.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import chain
from math import lcm

import numpy as np
from numpy.random import Generator

from pioneer3.arrays import Float, Int, Int32
from pioneer3.sim.body import Body
from pioneer3.sim.kernels import Mounts, sonar_mounts
from pioneer3.sim.realism import SonarErrors
from pioneer3.sim.sensors import SONAR_MIN, SONAR_RANGE, Firing, fired

ALMOST = 1e-9
"""Tolerance of a slot [s]: two steps of 20 ms make one of 40 ms, whatever rounding does."""
NEVER = -(1 << 40)
"""Before all slots."""
MOST_KEPT = 64
"""Firing groups that are kept: default orders in steps of 20 ms to 0.1 s need at most 16."""


Cast = Callable[[Mounts, Int32 | None], Float]
"""Returns exact ranges of transducers of some robots or all now [m], (F, mounts.most)."""


class SimultaneousSonars:
    """All transducers measure whenever they are asked; all ranges are in metres.

    Each robot has a random generator in `own`, so that asking one changes no other; `rng` serves if
    all are asked.
    """

    def __init__(
        self, errors: SonarErrors, cast: Cast, own: Mapping[Body, Generator], rng: Generator
    ) -> None:
        self._errors, self._cast, self._own, self._rng = errors, cast, own, rng
        self._spoils = errors.spoils
        self._exact: dict[int, Float] = {}
        self._expected: list[int] = []

    def set_robots(self, robots: Sequence[Body], before: Sequence[int]) -> None:
        """Replace the robots; `before` has the number that each had until now, -1 for a new one."""
        self._mounts, _ = mounts_of(robots, self._errors)
        absent = self._mounts.absent
        self._absent = absent if absent.any() else None
        self._expected = []
        self._exact.clear()

    def change_firing(self, body: Body) -> None:
        """Apply a changed `body.firing`."""

    def invalidate(self) -> None:
        """Discard all measurements: the map has changed."""
        self._exact.clear()

    def move(self, poses: Float) -> None:
        """Apply poses (3, N) set from outside: a robot or an obstacle was moved by hand."""
        self._exact.clear()

    def advance(self, dt: float, poses: Float) -> None:
        """Let `dt` [s] pass, in which robots have driven to `poses` (3, N)."""
        self._expected = []
        self._exact.clear()

    def expect(self, bodies: Iterable[Body]) -> None:
        """Announce the robots that :meth:`ranges` will be called for until the next step."""
        self._expected = [body.number for body in bodies]

    def ranges(self, body: Body) -> Float:
        """Return the latest ranges of one robot, shape (M,)."""
        if body.number not in self._exact:
            together = self._expected if body.number in self._expected else [body.number]
            ranges = self._cast(self._mounts, np.array(together, dtype=np.int32))
            self._exact.update(zip(together, ranges, strict=True))
        return self._heard(self._exact[body.number][: len(body.model.sonars)], self._own[body])

    def all_ranges(self) -> Float:
        """Return the latest ranges of all robots, shape (N, largest M)."""
        heard = self._heard(self._cast(self._mounts, None), self._rng)
        if self._absent is not None:
            heard[self._absent] = SONAR_RANGE
        return heard

    def new_ranges(self, body: Body) -> tuple[Int, Float]:
        """Return the transducers that fired since the last call, and their ranges, both (F,)."""
        numbers = _numbers(body.firing)
        return numbers, self.ranges(body)[numbers]

    def _heard(self, ranges: Float, rng: Generator) -> Float:
        """Return measured ranges for exact ones (..., M)."""
        if self._spoils:
            ranges = self._errors.spoil(ranges, SONAR_RANGE, rng)
        return np.maximum(ranges, SONAR_MIN)


@dataclass(frozen=True, slots=True)
class TypeFiring:
    """The part of a firing group that robots of one type have: all of them, or their numbers.

    `fire` are their transducers that fire, `before` those of the same array that fired before each,
    shape (F,).
    """

    robots: slice | Int
    fire: Int
    before: Int


@dataclass(frozen=True, slots=True)
class FiringGroup:
    """All transducers that fire within a step, with a part for each robot type that has any."""

    mounts: Mounts
    parts: tuple[TypeFiring, ...]


class FiringSchedule:
    """Computes firing groups, and keeps them, as they repeat.

    `firings` has one for each type of robots in `mounts`.
    """

    def __init__(self, mounts: Mounts, firings: Sequence[Firing]) -> None:
        self.mounts, self._firings = mounts, firings
        lengths = [len(order) for firing in firings for order in firing if order]
        self._period, self._longest = lcm(*lengths), max(lengths, default=0)
        self._kept: dict[tuple[int, int], FiringGroup] = {}

    def group(self, first: int, last: int) -> FiringGroup:
        """Return the transducers that fire in slots `first` to `last`, without `last`."""
        first = max(first, last - self._longest)
        key = first % self._period, last - first
        if key not in self._kept:
            if len(self._kept) == MOST_KEPT:
                self._kept.clear()
            self._kept[key] = self._compute([fired(each, first, last) for each in self._firings])
        return self._kept[key]

    def _compute(self, types: Sequence[dict[int, int]]) -> FiringGroup:
        parts = []
        for number, pair in enumerate(types):
            if pair:
                whose = np.flatnonzero(self.mounts.kinds == number)
                robots = slice(None) if len(types) == 1 else whose
                parts.append(TypeFiring(robots, np.array([*pair]), np.array([*pair.values()])))
        return FiringGroup(self.mounts.only([[*pair] for pair in types]), tuple(parts))


class SequentialSonars:
    """Transducers fire one after the other; methods are as in :class:`SimultaneousSonars`.

    A robot that is new or was moved by hand measures with all transducers at once, so that no range
    of another place is ever reported.
    """

    def __init__(self, errors: SonarErrors, cast: Cast, rng: Generator) -> None:
        self._errors, self._cast, self._rng = errors, cast, rng
        self._slot, self._time_in_slot = 0, 0.0
        self._ranges = np.empty((0, 0))
        self._reported = np.empty(0, dtype=np.int64)
        self._poses = np.empty((3, 0))
        self._moved, self._any_moved = np.empty(0, dtype=np.bool_), False
        self._schedule: FiringSchedule | None = None

    def set_robots(self, robots: Sequence[Body], before: Sequence[int]) -> None:
        was, count = np.array(before, dtype=np.int64), len(robots)
        kept = np.flatnonzero(was >= 0)
        self._poses[:, self._moved] = np.nan  # still to be measured
        ranges, reported, poses = self._ranges, self._reported, self._poses
        most = max((len(body.model.sonars) for body in robots), default=0)
        both = min(most, ranges.shape[1])
        self._ranges = np.full((count, most), SONAR_RANGE)
        self._ranges[kept, :both] = ranges[was[kept], :both]
        self._reported = np.full(count, NEVER)
        self._reported[kept] = reported[was[kept]]
        self._poses = np.full((3, count), np.nan)
        self._poses[:, kept] = poses[:, was[kept]]
        self._robots, self._moved = robots, np.zeros(count, dtype=np.bool_)
        self._any_moved, self._schedule = False, None

    def change_firing(self, body: Body) -> None:
        self._reported[body.number] = self._slot
        self._schedule = None

    def invalidate(self) -> None:
        self._poses[:] = np.nan

    def move(self, poses: Float) -> None:
        self._moved |= (self._poses != poses).any(axis=0)
        self._any_moved = bool(self._moved.any())
        self._poses[:] = poses

    def advance(self, dt: float, poses: Float) -> None:
        self._poses[:] = poses
        if self._any_moved:
            self._measure_all()
        due = self._time_in_slot + dt / self._errors.cycle
        slots = int(due + ALMOST)
        self._time_in_slot = due - slots
        if slots:
            first, self._slot = self._slot, self._slot + slots
            self._fire(self._current_schedule().group(first, self._slot))

    def expect(self, bodies: Iterable[Body]) -> None:
        pass

    def ranges(self, body: Body) -> Float:
        if self._any_moved:
            self._measure_all()
        return self._ranges[body.number, : len(body.model.sonars)].copy()

    def all_ranges(self) -> Float:
        if self._any_moved:
            self._measure_all()
        return self._ranges.copy()

    def new_ranges(self, body: Body) -> tuple[Int, Float]:
        ranges = self.ranges(body)
        since = int(self._reported[body.number])
        self._reported[body.number] = self._slot
        numbers = np.array(sorted(fired(body.firing, since, self._slot)), dtype=np.int64)
        return numbers, ranges[numbers]

    def _current_schedule(self) -> FiringSchedule:
        if self._schedule is None:
            self._schedule = FiringSchedule(*mounts_of(self._robots, self._errors))
        return self._schedule

    def _fire(self, group: FiringGroup) -> None:
        """Let all of a group measure from the present poses."""
        exact, errors, rng = self._cast(group.mounts, None), self._errors, self._rng
        for part in group.parts:
            heard, fire = self._ranges[part.robots], part.fire
            ranges = exact[part.robots, : len(fire)]
            heard[:, fire] = np.maximum(errors.blurred(ranges, SONAR_RANGE, rng), SONAR_MIN)
            errors.mistake(heard, SONAR_RANGE, rng, fire=fire, before=part.before)
            self._ranges[part.robots] = heard

    def _measure_all(self) -> None:
        """Measure with all transducers of the robots that are new or were moved by hand."""
        moved = np.flatnonzero(self._moved).astype(np.int32)
        mounts = self._current_schedule().mounts
        exact = self._cast(mounts, moved)
        heard = np.maximum(self._errors.spoil(exact, SONAR_RANGE, self._rng), SONAR_MIN)
        heard[mounts.absent[moved]] = SONAR_RANGE
        self._ranges[moved], self._reported[moved] = heard, NEVER
        self._moved[:], self._any_moved = False, False


Sonars = SimultaneousSonars | SequentialSonars
"""The transducers of all robots of a world."""


def mounts_of(robots: Sequence[Body], errors: SonarErrors) -> tuple[Mounts, list[Firing]]:
    """Return all transducers, and the firing of each robot type.

    Robots are of one type if they have the same transducers and the same firing.
    """
    pairs = [(body.model.sonars, body.firing) for body in robots]
    types = {pair: number for number, pair in enumerate(dict.fromkeys(pairs))}
    tables = [np.array([(m.x, m.y, m.theta) for m in sonars]) for sonars, _ in types]
    mounts = sonar_mounts(
        [table.reshape(-1, 3) for table in tables],
        [types[pair] for pair in pairs],
        rays=errors.rays,
        width=errors.width,
    )
    return mounts, [firing for _, firing in types]


@lru_cache(maxsize=64)
def _numbers(firing: Firing) -> Int:
    """Return the numbers of the transducers that fire, ascending; a read-only array."""
    return np.array(sorted({*chain(*firing)}), dtype=np.int64)
