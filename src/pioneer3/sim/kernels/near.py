"""What is near: lists of walls kept per cell, and pairs of robots; for the numpy kernels."""

from math import ceil, sqrt

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.kernels.numpy_truth import any_of, indices_of
from pioneer3.sim.kernels.robots import Robots
from pioneer3.sim.kernels.walls import SLACK, Grid, ranges

Float = NDArray[np.float64]
Int = NDArray[np.int64]

MOST_KEPT = 1 << 22
"""Entries of all lists together after which they are forgotten: 32 MB."""

FEW_PAIRS = 1 << 14
"""Of point and robot that are all looked at, without sorting."""

TINY = 1e-300
"""Instead of no length at all [m^2]: not to divide by zero."""


class NearWalls:
    """The walls within `reach` [m] of each cell of a grid, found when first asked for."""

    def __init__(self, grid: Grid, reach: float) -> None:
        self._grid, self._reach = grid, reach
        self._ends = np.ascontiguousarray(grid.walls.T)
        self._latest, self._answer = b"", (np.empty(0, dtype=np.int64), np.empty((4, 0)))
        columns, rows = grid.shape
        self._all = reach >= (columns + rows) * grid.cell
        # near the outermost cells nothing is, so they stand for all that is further outside
        self._border = 0 if self._all else ceil(reach / grid.cell) + 1
        self._columns, self._rows = columns + 2 * self._border, rows + 2 * self._border
        self._last = np.array([[self._columns - 1.0], [self._rows - 1.0]])
        self._forget()

    def of(self, x: Float, y: Float) -> tuple[Int, Int]:
        """Return the walls near each of the points (N,), one point after another.

        Returns:
            Index of the point and of the wall, both of shape (P,), ascending.
        """
        return self._listed(self._cells_of(np.array([x, y])))

    def around(self, points: Float) -> tuple[Int, Float]:
        """Return the walls near each of the points (2, N), one point after another.

        Returns:
            Index of the point, shape (P,), and x0, y0, x1, y1 of the wall [m], shape (4, P); not
            to be changed.
        """
        cells = self._cells_of(points)
        key = cells.tobytes()
        # few points leave their cells from one time to the next
        if key != self._latest:
            index, walls = self._listed(cells)
            self._latest, self._answer = key, (index, self._ends.take(walls, axis=1))
        return self._answer

    def _listed(self, cells: Int) -> tuple[Int, Int]:
        if self._all:
            count = len(self._grid.walls)
            return np.repeat(np.arange(len(cells)), count), np.tile(np.arange(count), len(cells))
        first = self._first.take(cells)
        if any_of(first < 0):
            self._find(np.unique(cells[first < 0]))
            if len(self._pool) > MOST_KEPT:
                self._forget()
                self._find(np.unique(cells))
            first = self._first.take(cells)
        counts = self._counts.take(cells)
        index = np.arange(len(cells)).repeat(counts)
        return index, self._pool.take(ranges(first, counts))

    def _forget(self) -> None:
        cells = 0 if self._all else self._columns * self._rows
        self._first = np.full(cells, -1, dtype=np.int64)
        self._counts = np.zeros(cells, dtype=np.int64)
        self._pool = np.empty(0, dtype=np.int64)

    def _cells_of(self, points: Float) -> Int:
        if self._all:
            return np.zeros(points.shape[1], dtype=np.int64)
        place = (points - self._grid.corner[:, None]) * (1 / self._grid.cell) + self._border
        np.minimum(np.maximum(place, 0.0, out=place), self._last, out=place)
        column, row = place.astype(np.int64)
        cells: Int = column + row * self._columns
        return cells

    def _find(self, cells: Int) -> None:
        """Append the lists of `cells`, not listed yet, to the pool."""
        cells = cells[self._first[cells] < 0]
        column, row = cells % self._columns - self._border, cells // self._columns - self._border
        whose, items = self._in_boxes(column, row)
        walls = self._grid.cell_items[items].astype(np.int64)
        middle = (np.stack([column, row]) + 0.5) * self._grid.cell + self._grid.corner[:, None]
        radius = self._reach + self._grid.cell * sqrt(0.5) + SLACK
        near = distances(middle[:, whose].T, self._grid.walls[walls]) <= radius
        whose, walls = whose[near], walls[near]
        counts = np.bincount(whose, minlength=len(cells))
        self._counts[cells] = counts
        self._first[cells] = len(self._pool) + np.cumsum(counts) - counts
        self._pool = np.concatenate([self._pool, walls])

    def _in_boxes(self, column: Int, row: Int) -> tuple[Int, Int]:
        """Return the items in the square of cells around each (C,), each wall at least once."""
        columns, rows = self._grid.shape
        wide = self._border
        west, east = np.maximum(column - wide, 0), np.minimum(column + wide, columns - 1)
        south, north = np.maximum(row - wide, 0), np.minimum(row + wide, rows - 1)
        heights = np.where(west <= east, (north - south + 1).clip(min=0), 0)
        box = np.repeat(np.arange(len(column)), heights)
        line = ranges(south, heights) * columns
        first = self._grid.cell_start[line + west[box]].astype(np.int64)
        counts = self._grid.cell_start[line + east[box] + 1] - first
        whose, items = np.repeat(box, counts), ranges(first, counts)
        c, r = self._grid.pieces[items, 4], self._grid.pieces[items, 5]
        met = (west[whose] <= c) & (c <= east[whose]) & (south[whose] <= r) & (r <= north[whose])
        return whose[~met], items[~met]


def near_robots(
    robots: Robots, x: Float, y: Float, reach: float, skip: NDArray[np.int32] | Int
) -> tuple[Int, Int]:
    """Return the robots, but not `skip` (N,), within `reach` [m] of each point (N,).

    Returns:
        Index of the point and of the robot, both of shape (P,), points ascending.
    """
    shapes = robots.shapes
    if len(shapes) == 0 or (len(shapes) == 1 and not skip.any()):
        nobody = np.empty(0, dtype=np.int64)
        return nobody, nobody
    if len(x) * len(shapes) <= FEW_PAIRS:
        dx, dy = shapes[:, 0] - x[:, None], shapes[:, 1] - y[:, None]
        dx *= dx
        dy *= dy
        dx += dy
        near = dx <= (shapes[:, 2] + (reach + SLACK)) ** 2
        near &= robots.everyone != skip[:, None]
        points, others = np.divmod(indices_of(near), len(shapes))
        return points, others
    order = np.argsort(shapes[:, 0])
    wide = reach + shapes[:, 2].max() + SLACK
    first = np.searchsorted(shapes[order, 0], x - wide)
    counts = np.searchsorted(shapes[order, 0], x + wide) - first
    points, others = np.repeat(np.arange(len(x)), counts), order[ranges(first, counts)]
    near = abs(shapes[others, 1] - y[points]) <= wide
    points, others = points[near], others[near]
    apart = np.hypot(shapes[others, 0] - x[points], shapes[others, 1] - y[points])
    near = (apart <= reach + shapes[others, 2] + SLACK) & (others != skip[points])
    return points[near], others[near]


def distances(points: Float, walls: Float) -> Float:
    """Return the distance of each point (P, 2) to the wall (P, 4) beside it [m], shape (P,)."""
    ends = walls.T
    x, y = start = ends[:2] - points.T
    ex, ey = extent = ends[2:] - ends[:2]
    squared = ex * ex + ey * ey
    share = -(x * ex + y * ey) / np.maximum(squared, TINY)  # a post is as near as its start
    start += np.minimum(np.maximum(share, 0.0, out=share), 1.0, out=share) * extent
    distances: Float = np.hypot(x, y)
    return distances
