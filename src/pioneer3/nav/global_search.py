"""Where on a map a robot may be, from a few scans alone."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, pi, radians

import numpy as np

from pioneer3.arrays import Bool, Float, Int32, UInt8
from pioneer3.jit import fast
from pioneer3.nav.hypotheses import ComparedScan, Hypotheses
from pioneer3.nav.kernels import CACHE
from pioneer3.nav.kernels.fields import best_places
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
BLOCK = 8
"""Rows and columns of places that are passed over at once."""
BLOCKS = 250
"""Blocks after which the best places are picked anew: what comes to less than these is passed over.
"""


@dataclass(frozen=True, slots=True, eq=False)
class CandidatePoses:
    """The places of a map where a robot may be, in cells that begin at `x` and `y` [m].

    Attributes:
        fields: Scores of the ends of beams, and the highest ones near, as kernels take them; they
            begin a block before the places.
        free: Which places these are, whole blocks, shape (H, W).
        blocks: First row and column of the blocks that have any, in no order, shape (N, 2).
    """

    x: float
    y: float
    fields: UInt8
    free: Bool
    blocks: Int32

    @classmethod
    def of(cls, field: DistanceField, room: float) -> "CandidatePoses":
        """Return the places that are farther than `room` [m] from the walls of a fine field."""
        raster = field.raster
        step = round(SEARCH_CELL / raster.cell)
        middles = field.distances[step // 2 :: step, step // 2 :: step]
        height, width = (-(-size // BLOCK) * BLOCK for size in middles.shape)
        fields = np.zeros((4, BLOCK + height, BLOCK + width), dtype=np.uint8)
        free = np.zeros((height, width), dtype=np.bool_)
        for row, some in enumerate(middles):
            away = field.reach + some
            scores = 255 * np.exp(-0.5 * (away / SEARCH_SIGMA) ** 2)
            fields[0, BLOCK + row, BLOCK : BLOCK + len(some)] = np.rint(scores)
            free[row, : len(some)] = away >= min(room, field.reach)
        for low, high, step in zip(fields[:-1], fields[1:], (1, 2, 4), strict=True):
            high[:] = low
            np.maximum(high[:-step], low[step:], out=high[:-step])
            np.maximum(high[:, :-step], high[:, step:], out=high[:, :-step])
        some_free = free.reshape(height // BLOCK, BLOCK, -1, BLOCK).any(axis=(1, 3))
        blocks = np.random.default_rng(0).permutation(np.argwhere(some_free) * BLOCK)
        return cls(raster.x, raster.y, fields, free, blocks.astype(np.int32))


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
        if not len(points) or not len(self.places.blocks):
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
        places, search = self.places, fast(best_places, CACHE)
        best, least = np.empty((0, 4), dtype=np.int32), 0
        out = np.empty((8 * SEARCH_HEADINGS * BLOCKS, 4), dtype=np.int32)
        for first in range(0, len(places.blocks), BLOCKS):
            some = places.blocks[first : first + BLOCKS]
            count = search(places.fields, places.free, some, offsets + BLOCK, least, out)
            best = np.concatenate([best, out[:count]])
            if len(best) > CLOSER_LOOKS:
                best = best[np.argpartition(best[:, 3], -CLOSER_LOOKS)[-CLOSER_LOOKS:]]
                least = int(best[:, 3].min())
        middles = (best[:, 1::-1] + 0.5) * SEARCH_CELL + (places.x, places.y)
        return np.column_stack([middles, headings[best[:, 2]]])
