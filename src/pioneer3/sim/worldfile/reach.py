"""Where can a robot get to? A grid flood over the free floor."""

from collections.abc import Sequence
from math import ceil, floor, sqrt

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.maps.line_map import Bounds
from pioneer3.sim.maps.raster import samples
from pioneer3.sim.population.footprint import which_inside

Float = NDArray[np.float64]

CELL = 0.1
"""Side of a cell [m]; larger in huge maps."""
MOST_CELLS = 400_000
MARGIN = 1.0
"""Of free floor around the map [m]: what has no outer walls may be driven around."""


class Floor:
    """The cells of a map that a disc can stand on.

    Args:
        walls: Segments [m], shape (W, 4).
        bounds: Of all places to ask for [m].
        radius: Of the disc [m]. It counts as half a cell less, so that no gap is missed by
            rounding, but never so little that it slips through walls.
        solids: Convex polygons that are no floor: the sides of each [m], shape (S, 4).
    """

    def __init__(
        self, walls: Float, bounds: Bounds, radius: float, solids: Sequence[Float] = ()
    ) -> None:
        self._low = np.array([bounds.x_min - MARGIN, bounds.y_min - MARGIN])
        extent = np.array([bounds.x_max + MARGIN, bounds.y_max + MARGIN]) - self._low
        self.cell = max(CELL, sqrt(float(extent.prod()) / MOST_CELLS), float(extent.max()) / 1e5)
        self._shape = (ceil(extent[1] / self.cell) + 1, ceil(extent[0] / self.cell) + 1)
        self._free = self._clear(walls, max(radius - self.cell / 2, 0.8 * self.cell))
        for solid in solids:
            self._block(solid)

    def reached_from(self, starts: list[tuple[float, float]]) -> NDArray[np.bool_]:
        """Return the cells that can be reached from any of `starts` [m], shape (H, W)."""
        width = self._shape[1]
        free = bytearray(np.pad(self._free, ((1, 1), (0, 1))).astype(np.uint8).tobytes())
        # one blocked column at the right and a blocked row above and below: no cell wraps around
        stride = width + 1
        todo = [(row + 1) * stride + column for row, column in map(self.cell_of, starts)]
        seen = np.zeros(len(free), dtype=np.bool_)
        found = bytearray(len(free))
        while todo:
            at = todo.pop()
            if free[at]:
                free[at] = 0
                found[at] = 1
                todo += (at - 1, at + 1, at - stride, at + stride)
        seen[:] = np.frombuffer(found, dtype=np.uint8)
        return seen.reshape(-1, stride)[1:-1, :-1]

    @property
    def free(self) -> NDArray[np.bool_]:
        """The cells that the disc can stand on, reachable or not, shape (H, W)."""
        return self._free

    def centres(self, cells: NDArray[np.bool_]) -> Float:
        """Return the middles of the marked `cells` [m], shape (N, 2)."""
        rows, columns = np.nonzero(cells)
        middles: Float = (np.stack([columns, rows], axis=1) + 0.5) * self.cell + self._low
        return middles

    def is_free(self, x: float, y: float) -> bool:
        """Whether the disc can stand at (`x`, `y`) [m]."""
        return bool(self._free[self.cell_of((x, y))])

    def are_free(self, points: Float) -> NDArray[np.bool_]:
        """Return whether the disc can stand at each of `points` [m], shape (N, 2)."""
        columns, rows = np.floor((points - self._low) / self.cell).astype(np.int64).T
        height, width = self._shape
        free: NDArray[np.bool_] = self._free[rows.clip(0, height - 1), columns.clip(0, width - 1)]
        return free

    def cell_of(self, point: tuple[float, float]) -> tuple[int, int]:
        """Return row and column of a point [m], of the nearest cell for those outside."""
        column = floor((point[0] - self._low[0]) / self.cell)
        row = floor((point[1] - self._low[1]) / self.cell)
        return min(max(row, 0), self._shape[0] - 1), min(max(column, 0), self._shape[1] - 1)

    def _block(self, solid: Float) -> None:
        x, y = solid[:, ::2], solid[:, 1::2]
        low = self.cell_of((float(x.min()), float(y.min())))
        high = self.cell_of((float(x.max()), float(y.max())))
        there = np.zeros_like(self._free)
        there[low[0] : high[0] + 1, low[1] : high[1] + 1] = True
        middles = self.centres(there)
        self._free[there] &= ~which_inside(solid, middles[:, 0], middles[:, 1])

    def _clear(self, walls: Float, radius: float) -> NDArray[np.bool_]:
        """Return the cells whose middle is further than `radius` [m] from all walls."""
        marked = np.zeros(self._shape, dtype=np.bool_)
        columns, rows = (
            np.floor((samples(walls, self.cell / 2) - self._low) / self.cell).astype(np.int64).T
        )
        inside = (columns >= 0) & (columns < self._shape[1]) & (rows >= 0) & (rows < self._shape[0])
        marked[rows[inside], columns[inside]] = True
        reach = floor(radius / self.cell)
        padded = np.pad(marked, reach)
        blocked = marked.copy()
        height, width = self._shape
        for dy in range(-reach, reach + 1):
            for dx in range(-reach, reach + 1):
                if (dx * dx + dy * dy) * self.cell**2 <= radius**2:
                    y, x = reach + dy, reach + dx
                    blocked |= padded[y : y + height, x : x + width]
        return ~blocked
