"""Sonars that fire one after the other, as those of real robots do (docs/explanation/realism.md).

All robots fire at the same beat. A step brings so many beats as it takes; what fires in it measures
from where the robot stands at its end. The others keep what they measured last.
"""

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from pioneer3.sim.body import Body
from pioneer3.sim.firing import fired
from pioneer3.sim.realism import SonarErrors
from pioneer3.sim.sensors import SONAR_MIN, SONAR_RANGE
from pioneer3.sim.sonar.base import Cast
from pioneer3.sim.sonar.mounts import mounts_of
from pioneer3.sim.sonar.volleys import Volley, Volleys

Float = NDArray[np.float64]
Int = NDArray[np.int64]
Int32 = NDArray[np.int32]

ALMOST = 1e-9
"""Of a beat: two steps of 20 ms make one of 40 ms, whatever rounding does."""
NEVER = -(1 << 40)
"""Before all beats."""


class InTurn:
    """Same contract as `Sonars`.

    A robot that is new, or was put elsewhere, has listened all around already: nobody shall be
    told of walls that stand somewhere else.

    Args:
        errors: How long a beat takes, and what is heard in place of exact ranges.
        cast: Measures.
        rng: Where chances come from.
    """

    def __init__(self, errors: SonarErrors, cast: Cast, rng: Generator) -> None:
        self._errors, self._cast, self._rng = errors, cast, rng
        self._beat, self._part = 0, 0.0
        self._ranges = np.empty((0, 0))
        self._taken = np.empty(0, dtype=np.int64)
        self._poses = np.empty((3, 0))
        self._elsewhere, self._seeks = np.empty(0, dtype=np.bool_), False
        self._volleys: Volleys | None = None

    def arrange(self, robots: Sequence[Body], before: Sequence[int]) -> None:
        was, count = np.array(before, dtype=np.int64), len(robots)
        kept = np.flatnonzero(was >= 0)
        self._poses[:, self._elsewhere] = np.nan  # still to be looked at
        ranges, taken, poses = self._ranges, self._taken, self._poses
        most = max((len(body.model.sonars) for body in robots), default=0)
        both = min(most, ranges.shape[1])
        self._ranges = np.full((count, most), SONAR_RANGE)
        self._ranges[kept, :both] = ranges[was[kept], :both]
        self._taken = np.full(count, NEVER)
        self._taken[kept] = taken[was[kept]]
        self._poses = np.full((3, count), np.nan)
        self._poses[:, kept] = poses[:, was[kept]]
        self._robots, self._elsewhere = robots, np.zeros(count, dtype=np.bool_)
        self._seeks, self._volleys = False, None

    def fires(self, body: Body) -> None:
        self._taken[body.number] = self._beat
        self._volleys = None

    def changed(self) -> None:
        self._poses[:] = np.nan

    def placed(self, poses: Float) -> None:
        self._elsewhere |= (self._poses != poses).any(axis=0)
        self._seeks = bool(self._elsewhere.any())
        self._poses[:] = poses

    def passed(self, dt: float, poses: Float) -> None:
        self._poses[:] = poses
        if self._seeks:
            self._look_around()
        due = self._part + dt / self._errors.cycle
        beats = int(due + ALMOST)
        self._part = due - beats
        if beats:
            first, self._beat = self._beat, self._beat + beats
            self._fire(self._grouped().of(first, self._beat))

    def expect(self, bodies: Iterable[Body]) -> None:
        pass

    def of(self, body: Body) -> Float:
        if self._seeks:
            self._look_around()
        return self._ranges[body.number, : len(body.model.sonars)].copy()

    def all(self) -> Float:
        if self._seeks:
            self._look_around()
        return self._ranges.copy()

    def fresh(self, body: Body) -> tuple[Int, Float]:
        ranges = self.of(body)
        since = int(self._taken[body.number])
        self._taken[body.number] = self._beat
        numbers = np.array(sorted(fired(body.firing, since, self._beat)), dtype=np.int64)
        return numbers, ranges[numbers]

    def _grouped(self) -> Volleys:
        if self._volleys is None:
            self._volleys = Volleys(*mounts_of(self._robots, self._errors))
        return self._volleys

    def _fire(self, volley: Volley) -> None:
        """Let all of a volley measure from where they are."""
        exact, errors, rng = self._cast(volley.mounts, None), self._errors, self._rng
        for part in volley.parts:
            heard, fire = self._ranges[part.robots], part.fire
            ranges = exact[part.robots, : len(fire)]
            heard[:, fire] = np.maximum(errors.blurred(ranges, SONAR_RANGE, rng), SONAR_MIN)
            errors.mistake(heard, SONAR_RANGE, rng, fire=fire, before=part.before)
            self._ranges[part.robots] = heard

    def _look_around(self) -> None:
        """Let those measure with all they have that are new or were put elsewhere."""
        who, mounts = np.flatnonzero(self._elsewhere).astype(np.int32), self._grouped().mounts
        exact = self._cast(mounts, who)
        heard = np.maximum(self._errors.spoil(exact, SONAR_RANGE, self._rng), SONAR_MIN)
        heard[mounts.absent[who]] = SONAR_RANGE
        self._ranges[who], self._taken[who] = heard, NEVER
        self._elsewhere[:], self._seeks = False, False
