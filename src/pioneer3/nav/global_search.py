"""Where on a map a robot may be, from a few scans alone."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, pi, radians
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pioneer3.arrays import Float, Int32, UInt8
from pioneer3.jit import fast
from pioneer3.nav.hypotheses import ComparedScan, Hypotheses
from pioneer3.nav.kernels import CACHE
from pioneer3.nav.kernels.fields import score_places
from pioneer3.nav.particles import MotionErrors
from pioneer3.nav.raster import DistanceField

SEARCH_CELL = 0.1
"""Distance from one place to the next [m]."""
SEARCH_HEADINGS = ceil(2 * pi / radians(5))
"""Headings that are tried at each place."""
SEARCH_BEAMS = 40
"""Beams that are looked at."""
SEARCH_SIGMA = 0.15
"""Standard deviation of a point from a wall, as coarse as places and headings are [m]."""
CLOSER_LOOKS = 12_000
"""Places with headings that are looked at more closely."""
NEIGHBORS = 5
"""Neighbors of one that fits, among these, at most."""
SLICE = 20_000
"""Places that are scored at once: bounds the memory."""


@dataclass(frozen=True, slots=True, eq=False)
class CandidatePoses:
    """The places of a map where a robot may be, in cells that begin at `x` and `y` [m].

    Attributes:
        scores: Of the end of a beam, 255 at a wall, shape (H, W).
        free: Rows and columns of the places, shape (N, 2).
    """

    x: float
    y: float
    scores: UInt8
    free: Int32

    @classmethod
    def of(cls, field: DistanceField, room: float) -> "CandidatePoses":
        """Return the places that are farther than `room` [m] from the walls of a fine field."""
        raster = field.raster
        step = round(SEARCH_CELL / raster.cell)
        middles = field.distances[step // 2 :: step, step // 2 :: step]
        scores = np.rint(255 * np.exp(-0.5 * (middles / SEARCH_SIGMA) ** 2)).astype(np.uint8)
        free = np.argwhere(middles >= min(room, field.reach)).astype(np.int32)
        return cls(raster.x, raster.y, scores, free)


@dataclass(frozen=True, slots=True, eq=False)
class Candidates:
    """The looks of a search, and where the robot may be at the last one; `None`: nowhere."""

    looks: Sequence[ComparedScan]
    driven: float
    hypotheses: Hypotheses | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GlobalSearch:
    """A search for a robot's place by the last of some looks; all of them weigh what it finds.

    It changes nothing, so any thread may run it.

    Attributes:
        known: Poses that are compared with those found, shape (K, 3).
        driven: Way between the looks [m].
    """

    looks: Sequence[ComparedScan]
    places: CandidatePoses
    known: Float
    driven: float
    errors: MotionErrors

    def run(self) -> Candidates:
        """Return where the robot may be; it takes up to a few seconds."""
        points = self.looks[-1].likelihood.points
        if not len(points) or not len(self.places.free):
            return Candidates(self.looks, self.driven, None)
        chosen = points[
            np.linspace(0, len(points) - 1, min(SEARCH_BEAMS, len(points))).astype(np.intp)
        ]
        poses = np.vstack([self.known, self._best(chosen)])
        return Candidates(self.looks, self.driven, Hypotheses.found(poses, self.looks, self.errors))

    def _best(self, points: Float) -> Float:
        """Return places and headings with the highest scores [m, rad], shape (N, 3)."""
        headings = (np.arange(SEARCH_HEADINGS) + 0.5) * (2 * pi / SEARCH_HEADINGS) - pi
        c, s = np.cos(headings)[:, None], np.sin(headings)[:, None]
        x, y = points[:, 0], points[:, 1]
        offsets = np.rint(np.stack([s * x + c * y, c * x - s * y], axis=2) / SEARCH_CELL).astype(
            np.int32
        )
        places, score = self.places, fast(score_places, CACHE)
        found: list[Int32] = []
        for first in range(0, len(places.free), SLICE):
            some = places.free[first : first + SLICE]
            out = np.empty((len(some), SEARCH_HEADINGS), dtype=np.uint16)
            score(places.scores, some, offsets, out)
            best = _highest(out.ravel(), CLOSER_LOOKS * NEIGHBORS)
            row, column = some[best // SEARCH_HEADINGS].T
            rows = np.stack([row, column, best % SEARCH_HEADINGS, out.ravel()[best]], axis=1)
            found.append(_first_in_blocks(rows.astype(np.int32)))
        together = np.concatenate(found)
        row, column, heading, _ = together[_highest(together[:, 3], CLOSER_LOOKS)].T
        x, y = places.x + (column + 0.5) * SEARCH_CELL, places.y + (row + 0.5) * SEARCH_CELL
        return np.stack([x, y, headings[heading]], axis=1)


def _highest(scores: NDArray[Any], count: int) -> NDArray[np.intp]:
    """Return the indices of the `count` highest of `scores` (N,), in no order."""
    if count >= len(scores):
        return np.arange(len(scores))
    chosen: NDArray[np.intp] = np.argpartition(scores, -count)[-count:]
    return chosen


def _first_in_blocks(found: Int32) -> Int32:
    """Return the best of those in each block of two rows, two columns and two headings, (N, 4)."""
    best_first = found[np.argsort(-found[:, 3], kind="stable")]
    first = np.unique(best_first[:, :3] // 2, axis=0, return_index=True)[1]
    chosen: Int32 = best_first[first]
    return chosen
