"""What is near: lists of walls kept per cell, and pairs of robots; for the numpy kernels."""

from math import ceil, sqrt

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.kernels.robots import Robots
from pioneer3.sim.kernels.walls import SLACK, Grid, ranges

Float = NDArray[np.float64]
Int = NDArray[np.int64]

MOST_KEPT = 1 << 22
"""Entries of all lists together after which they are forgotten: 32 MB."""

FEW_PAIRS = 4096
"""Of point and robot that are all looked at, without sorting."""


class NearWalls:
    """The walls within `reach` [m] of each cell of a grid, found when first asked for.

    Attributes:
        ends: Of all walls x0, y0, x1, y1 [m], shape (4, W).
    """

    def __init__(self, grid: Grid, reach: float) -> None:
        self._grid, self._reach = grid, reach
        self.ends = np.ascontiguousarray(grid.walls.T)
        columns, rows = grid.shape
        self._all = reach >= (columns + rows) * grid.cell
        # from further outside nothing is near
        self._border = 0 if self._all else ceil(reach / grid.cell) + 1
        self._columns, self._rows = columns + 2 * self._border, rows + 2 * self._border
        self._forget()

    def of(self, x: Float, y: Float) -> tuple[Int, Int]:
        """Return the walls near each of the points (N,), one point after another.

        Returns:
            Index of the point and of the wall, both of shape (P,), ascending.
        """
        if self._all:
            count = len(self._grid.walls)
            return np.repeat(np.arange(len(x)), count), np.tile(np.arange(count), len(x))
        cells = self._cells_of(x, y)
        missing = cells[self._first[cells] < 0]
        if len(missing):
            self._find(np.unique(missing))
        if len(self._pool) > MOST_KEPT:
            self._forget()
            self._find(np.unique(cells))
        counts = self._counts[cells]
        points = np.repeat(np.arange(len(x)), counts)
        return points, self._pool[ranges(self._first[cells], counts)]

    def _forget(self) -> None:
        nowhere = 0 if self._all else self._columns * self._rows
        # the last one stands for far outside: an empty list
        self._first = np.full(nowhere + 1, -1, dtype=np.int64)
        self._first[nowhere] = 0
        self._counts = np.zeros(nowhere + 1, dtype=np.int64)
        self._pool = np.empty(0, dtype=np.int64)

    def _cells_of(self, x: Float, y: Float) -> Int:
        left, bottom = self._grid.corner
        column = np.floor((x - left) / self._grid.cell) + self._border
        row = np.floor((y - bottom) / self._grid.cell) + self._border
        inside = (column >= 0) & (column < self._columns) & (row >= 0) & (row < self._rows)
        cells: Int = np.where(inside, row * self._columns + column, len(self._first) - 1)
        return cells.astype(np.int64)

    def _find(self, cells: Int) -> None:
        """Append the lists of `cells`, not listed yet, to the pool."""
        cells = cells[self._first[cells] < 0]
        column, row = cells % self._columns - self._border, cells // self._columns - self._border
        whose, items = self._in_boxes(column, row)
        walls = self._grid.cell_items[items].astype(np.int64)
        middle = (np.stack([column, row], axis=1) + 0.5) * self._grid.cell + self._grid.corner
        radius = self._reach + self._grid.cell * sqrt(0.5) + SLACK
        near = distances(middle[whose], self._grid.walls[walls]) <= radius
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
        apart = np.hypot(shapes[:, 0] - x[:, None], shapes[:, 1] - y[:, None])
        points, others = np.nonzero(apart <= reach + shapes[:, 2] + SLACK)
        seen = others != skip[points]
        return points[seen], others[seen]
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
    start, extent = walls[:, :2] - points, walls[:, 2:] - walls[:, :2]
    squared = (extent**2).sum(axis=1)
    share = -(start * extent).sum(axis=1) / np.where(squared > 0, squared, 1.0)
    nearest = start + np.clip(share, 0.0, 1.0)[:, None] * extent
    distances: Float = np.hypot(nearest[:, 0], nearest[:, 1])
    return distances
