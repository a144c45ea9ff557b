"""Which walls are near? A uniform grid over the map, so that only those are looked at."""

from collections import OrderedDict
from collections.abc import Iterator
from math import ceil, floor

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.raycast import PAIRS, directions, meetings

Float = NDArray[np.float64]
Int = NDArray[np.int64]

CACHED = 32
"""Answers of :meth:`WallGrid.near` kept; the largest is the whole map, so this bounds memory."""

MOST_CELLS = 250_000
"""Cells get larger where the walls of a huge map would cross more than this."""

FIRST_REACH = 2.0
"""How far :meth:`WallGrid.cast` looks before it drops the rays that hit something [m]."""

SLACK = 1e-6
"""Keeps rounding from losing a wall on the edge of a cell or at exactly the radius [m]."""


class WallGrid:
    """Walls sorted into square cells.

    Args:
        walls: Segments `x0, y0, x1, y1` [m], shape (W, 4), finite. Not copied; don't change them.
        cell: Side of a cell [m], far larger than a micrometre; larger where a huge map needs it.
    """

    def __init__(self, walls: Float, cell: float = 1.0) -> None:
        self.walls = walls
        self.cell = max(cell, float(_lengths(walls).sum()) / MOST_CELLS)
        self._cached: OrderedDict[tuple[int, int, int], Float] = OrderedDict()
        cells, owners = _rasterise(walls, self.cell)
        none = np.zeros(2, dtype=np.int64)
        self._corner = cells.min(axis=0) if len(cells) else none
        self._shape = cells.max(axis=0) - self._corner + 1 if len(cells) else none
        keys = self._keys_of(cells)
        order = np.argsort(keys, kind="stable")
        self._keys, self._owners = keys[order], owners[order]

    def near(self, x: float, y: float, radius: float) -> Float:
        """Return every wall that comes within `radius` [m] of (`x`, `y`) [m], and some more.

        The answer holds for the whole cell around the point and a radius rounded up to whole
        cells, and is kept: asking again from a slowly moving robot costs about a microsecond.

        Returns:
            Walls in map order, read-only, shape (K, 4).
        """
        key = (floor(x / self.cell), floor(y / self.cell), ceil(radius / self.cell))
        walls = self._cached.get(key)
        if walls is None:
            walls = self._cached[key] = self._gather(*key)
            walls.setflags(write=False)
            if len(self._cached) > CACHED:
                self._cached.popitem(last=False)
        else:
            self._cached.move_to_end(key)
        return walls

    def cast(self, origins: Float, angles: Float, limit: float) -> Float:
        """Return the ranges [m], shape (B,), to the walls of the whole map.

        Same contract as :func:`pioneer3.sim.raycast.cast`, but a ray only looks at the walls in
        the cells it passes, and no further than its hit. The faster way in maps of thousands of
        walls and over long ranges; with few walls near, `cast` with :meth:`near` is faster.
        """
        ranges = np.full(len(angles), float(limit))
        headings = directions(angles)
        start, end = self._interval(origins)
        end, reach = min(end, limit), FIRST_REACH
        rays = np.arange(len(angles))
        while len(rays) and start < end:
            stop = min(start + reach, end)
            for ray, met in self._along(origins[rays], headings[rays], start, stop):
                np.minimum.at(ranges, rays[ray], met)
            # beyond `stop` a nearer wall may stand in a cell not looked at yet
            rays = rays[ranges[rays] > stop]
            start, reach = stop, 2 * reach
        return ranges

    def _along(
        self, origins: Float, headings: Float, start: float, stop: float
    ) -> Iterator[tuple[Int, Float]]:
        """Yield meetings of rays with the walls in the cells from `start` to `stop` [m]."""
        span = np.concatenate([start * headings, stop * headings], axis=1)
        cells, rays = _rasterise(np.tile(origins, 2) + span, self.cell)
        inside = ((cells >= self._corner) & (cells < self._corner + self._shape)).all(axis=1)
        keys, rays = self._keys_of(cells[inside]), rays[inside]
        first = np.searchsorted(self._keys, keys, side="left")
        counts = np.searchsorted(self._keys, keys, side="right") - first
        blocks = np.flatnonzero(np.diff(np.cumsum(counts) // PAIRS)) + 1
        for block in np.split(np.arange(len(keys)), blocks):
            ray = np.repeat(rays[block], counts[block])
            walls = self.walls[self._owners[_ranges(first[block], counts[block])]]
            index, met = meetings(origins[ray], headings[ray], walls)
            yield ray[index], met

    def _interval(self, origins: Float) -> tuple[float, float]:
        """Return the least and greatest distance [m] from any of `origins` to any wall's cell."""
        if not len(origins) or not len(self._keys):
            return 0.0, 0.0
        low, high = self._corner * self.cell, (self._corner + self._shape) * self.cell
        outside = np.maximum(np.maximum(low - origins, origins - high), 0.0)
        furthest = np.maximum(abs(origins - low), abs(origins - high))
        return float(np.hypot(*outside.T).min()), float(np.hypot(*furthest.T).max())

    def _gather(self, column: int, row: int, radius_cells: int) -> Float:
        """Return the walls within so many cells of any point of a cell, shape (K, 4)."""
        centre = np.array([column, row])
        low = np.maximum(centre - radius_cells, self._corner)
        high = np.minimum(centre + radius_cells, self._corner + self._shape - 1)
        if (low > high).any():
            return np.empty((0, 4))
        rows = np.arange(low[1], high[1] + 1)
        lefts, rights = (np.stack([np.full_like(rows, c), rows], 1) for c in (low[0], high[0]))
        first = np.searchsorted(self._keys, self._keys_of(lefts), side="left")
        last = np.searchsorted(self._keys, self._keys_of(rights), side="right")
        walls = self.walls[np.unique(self._owners[_ranges(first, last - first)])]
        # half a diagonal: from anywhere in the cell to its centre
        within = (radius_cells + 0.5**0.5) * self.cell + SLACK
        near: Float = walls[distances((centre + 0.5) * self.cell, walls) <= within]
        return near

    def _keys_of(self, cells: Int) -> Int:
        """Number the cells (N, 2) of the map's box row by row, shape (N,)."""
        keys: Int = (cells - self._corner) @ np.array([1, self._shape[0]])
        return keys


def distances(point: Float, walls: Float) -> Float:
    """Return the distance [m] of `point` (2,) to each of `walls` (W, 4), shape (W,)."""
    start, extent = walls[:, :2] - point, walls[:, 2:] - walls[:, :2]
    squared = (extent**2).sum(axis=1)
    share = -(start * extent).sum(axis=1) / np.where(squared > 0, squared, 1.0)
    nearest = start + np.clip(share, 0.0, 1.0)[:, None] * extent
    return _lengths(np.pad(nearest, ((0, 0), (2, 0))))


def _lengths(walls: Float) -> Float:
    """Return the length [m] of each of `walls` (W, 4), shape (W,)."""
    return np.hypot(walls[:, 2] - walls[:, 0], walls[:, 3] - walls[:, 1])


def _ranges(first: Int, counts: Int) -> Int:
    """Return `first[i], first[i] + 1...`, `counts[i]` of them, one `i` after another."""
    before = np.cumsum(counts) - counts
    return np.repeat(first - before, counts) + np.arange(counts.sum())


def _rasterise(walls: Float, cell: float) -> tuple[Int, Int]:
    """Return the cells (N, 2), column and row, that walls come close to, and whose they are (N,).

    Each wall is cut into pieces clearly shorter than a cell. Such a piece, with some slack around
    it, lies in no more than the two columns and two rows of its box.
    """
    counts = np.ceil(1.1 * _lengths(walls) / cell).astype(np.int64).clip(min=1)
    owners = np.repeat(np.arange(len(walls)), counts)
    number = _ranges(np.zeros_like(counts), counts)
    share = np.stack([number, number + 1]) / counts[owners]
    starts, extents = walls[owners, :2], walls[owners, 2:] - walls[owners, :2]
    ends = starts + share[:, :, None] * extents
    low = np.floor((ends.min(axis=0) - SLACK) / cell).astype(np.int64)
    high = np.floor((ends.max(axis=0) + SLACK) / cell).astype(np.int64)
    corners = [np.stack([a[:, 0], b[:, 1], owners]) for a in (low, high) for b in (low, high)]
    found = np.concatenate(corners, axis=1)
    found = found[:, np.lexsort(found)]
    new = np.ones(found.shape[1], dtype=np.bool_)
    new[1:] = (found[:, 1:] != found[:, :-1]).any(axis=0)
    return found[:2, new].T, found[2, new]
