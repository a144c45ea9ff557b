"""The seam between a world and the sonars of its robots."""

from collections.abc import Iterable, Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.body import Body
from pioneer3.sim.kernels import Mounts

Float = NDArray[np.float64]
Int = NDArray[np.int64]
Int32 = NDArray[np.int32]


class Cast(Protocol):
    """Casts rays among walls and robots as they are now."""

    def __call__(self, mounts: Mounts, owners: Int32 | None) -> Float:
        """Return exact ranges of transducers of some robots or all [m], (F, mounts.most)."""
        ...


class Sonars(Protocol):
    """The transducers of all robots of a world. Ranges are in metres."""

    def arrange(self, robots: Sequence[Body], before: Sequence[int]) -> None:
        """Take note of the robots there are, and which each was until now; -1 for a new one."""
        ...

    def fires(self, body: Body) -> None:
        """Take note that `body.firing` has changed."""
        ...

    def changed(self) -> None:
        """Forget what was measured: all may be different."""
        ...

    def placed(self, poses: Float) -> None:
        """Take note that somebody or something was put elsewhere; robots are at `poses` (3, N)."""
        ...

    def passed(self, dt: float, poses: Float) -> None:
        """Let `dt` [s] have passed; robots have driven to `poses` (3, N)."""
        ...

    def expect(self, bodies: Iterable[Body]) -> None:
        """Be told who is asked for until the next step."""
        ...

    def of(self, body: Body) -> Float:
        """Return the readings of one robot, shape (M,)."""
        ...

    def all(self) -> Float:
        """Return the readings of all robots, shape (N, M of the one that has most)."""
        ...

    def fresh(self, body: Body) -> tuple[Int, Float]:
        """Return the transducers that have measured since the last call, and what, both (F,)."""
        ...
