"""Walls sorted once into the cells of a uniform grid, as arrays that a kernel can walk."""

from dataclasses import dataclass
from math import sqrt

import numpy as np

from pioneer3.arrays import Bool, Float, Int, Int32

LARGEST_CELL = 1.0
"""Largest side of a cell [m]."""
SMALLEST_CELL = 0.25
"""Smallest side of a cell [m], where walls are short, as in scanned maps."""

WALLS_PER_CELL = 4
"""A cell is as wide as so many walls are long, within these bounds."""

MOST_CELLS = 1 << 20
"""Cells get larger where a huge map would need more."""

SLACK = 1e-6
"""A wall this close to a cell counts as in it, so rounding loses none [m]."""

OFFSET = 0.3713
"""Edges of cells lie this share of a cell beside the map's, off the round numbers walls are at."""

TOGETHER = 1 << 9
"""Points worked on at a time: their arrays then fit a processor's cache."""

TINY = 1e-300
"""In place of zero [m^2], which nothing is divided by."""

NONE = -(1 << 30)
"""Column and row of a wall's predecessor where there is none."""


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True, kw_only=True)
class Grid:
    """Static walls and where they are. Made by :func:`build_grid`; don't change the arrays.

    Attributes:
        walls: Segments `x0, y0, x1, y1` [m], shape (W, 4).
        frame: Left edge, bottom edge, side of a cell [m], cells per metre, columns, rows,
            shape (6,).
        cell_start: Where the items of each cell start, row by row, shape (columns * rows + 1,).
        cell_items: Index of the wall of each item, shape (I,), ascending in each cell.
        pieces: Of each item the wall's ends, then column and row of the cell that the wall passes
            just before this one, so that a search of a box of cells can take each wall once,
            shape (I, 6).
    """

    walls: Float
    frame: Float
    cell_start: Int32
    cell_items: Int32
    pieces: Float

    @property
    def cell(self) -> float:
        """Side of a cell [m]."""
        return float(self.frame[2])

    @property
    def shape(self) -> tuple[int, int]:
        """Columns and rows."""
        return int(self.frame[4]), int(self.frame[5])

    @property
    def arrays(self) -> tuple[Float, Int32, Float]:
        """Arguments of kernels: frame, cell_start, pieces."""
        return self.frame, self.cell_start, self.pieces

    @property
    def corner(self) -> Float:
        """Left and bottom edge [m], shape (2,)."""
        return self.frame[:2]

    def clearance(self, points: Float, reach: float) -> Float:
        """Return the distance from each point (N, 2) to the nearest wall [m], at most `reach`."""
        found = np.full(len(points), reach)
        for first in range(0, len(points), TOGETHER):
            point, wall = self.near(points[first : first + TOGETHER], reach)
            apart = _distances(points[first + point], self.walls[wall])
            np.minimum.at(found, first + point, apart)
        return found

    def near(self, points: Float, reach: float) -> tuple[Int, Int]:
        """Return the walls within `reach` [m] of each point (N, 2), and some that are further off.

        They are indices of point and wall, (P,) each, points ascending; a pair may come twice.
        """
        last, places = np.array(self.shape) - 1, (points - self.corner) / self.cell
        reach /= self.cell
        west, south = np.floor(places - reach).clip(0, last + 1).astype(np.int64).T
        east, north = np.floor(places + reach).clip(-1, last).astype(np.int64).T
        heights = np.where(west <= east, (north - south + 1).clip(min=0), 0)
        box = np.repeat(np.arange(len(points)), heights)
        rows = ranges(south, heights) * self.shape[0]
        first = self.cell_start[rows + west[box]].astype(np.int64)
        counts = self.cell_start[rows + east[box] + 1] - first
        return np.repeat(box, counts), self.cell_items[ranges(first, counts)].astype(np.int64)


def build_grid(walls: Float, cell: float | None = None) -> Grid:
    """Sort `walls` (W, 4) [m], finite, into cells with sides of `cell` [m] or, if need be, more.

    Without `cell` the sides suit the length of the walls.
    """
    walls = np.ascontiguousarray(walls, dtype=np.float64).reshape(-1, 4)
    length = float(_lengths(walls).sum())
    if cell is None:
        mean = length / max(len(walls), 1)
        cell = min(max(WALLS_PER_CELL * mean, SMALLEST_CELL), LARGEST_CELL)
    points = walls.reshape(-1, 2)
    low = points.min(axis=0, initial=np.inf) if len(walls) else np.zeros(2)
    high = points.max(axis=0, initial=-np.inf) if len(walls) else np.zeros(2)
    cell = _large_enough(cell, high - low, length)
    corner = low - OFFSET * cell
    columns, rows = (np.floor((high - corner) / cell + OFFSET).astype(np.int64) + 1).tolist()
    cells, owners = rasterise(walls - np.tile(corner, 2), cell)
    before = _predecessors(walls, cells, owners)
    keys = cells @ np.array([1, columns])
    order = np.argsort(keys, kind="stable")
    counts = np.bincount(keys, minlength=columns * rows)
    return Grid(
        walls=walls,
        frame=np.array([*corner, cell, 1 / cell, columns, rows]),
        cell_start=np.concatenate([[0], np.cumsum(counts)]).astype(np.int32),
        cell_items=owners[order].astype(np.int32),
        pieces=np.concatenate([walls[owners], before], axis=1)[order],
    )


def ranges(first: Int, counts: Int) -> Int:
    """Return `first[i], first[i] + 1...`, `counts[i]` of them, one `i` after another."""
    after = counts.cumsum()
    found: Int = (first - after + counts).repeat(counts)
    found += np.arange(len(found))
    return found


def rasterise(walls: Float, cell: float) -> tuple[Int, Int]:
    """Return the cells (I, 2), column and row, that walls come close to, and whose they are (I,).

    Each wall is cut into pieces clearly shorter than a cell. Such a piece, with some slack around
    it, lies in no more than the two columns and two rows of its box; of these cells the ones that
    the wall's line misses are dropped. Sorted by wall.
    """
    counts = np.ceil(1.1 * _lengths(walls) / cell).astype(np.int64).clip(min=1)
    owners = np.repeat(np.arange(len(walls)), counts)
    number = ranges(np.zeros_like(counts), counts)
    share = np.stack([number, number + 1]) / counts[owners]
    extents = (walls[:, 2:] - walls[:, :2])[owners]
    ends = walls[owners, :2] + share[:, :, None] * extents
    low = np.floor((ends.min(axis=0) - SLACK) / cell).astype(np.int64)
    high = np.floor((ends.max(axis=0) + SLACK) / cell).astype(np.int64)
    corners = [np.stack([a[:, 0], b[:, 1], owners]) for a in (low, high) for b in (low, high)]
    found = np.concatenate(corners, axis=1)
    found = found[:, np.lexsort(found)]
    new = np.ones(found.shape[1], dtype=np.bool_)
    new[1:] = (found[:, 1:] != found[:, :-1]).any(axis=0)
    cells, owners = found[:2, new].T, found[2, new]
    near = _line_meets(walls[owners], cells, cell)
    return cells[near], owners[near]


def _line_meets(walls: Float, cells: Int, cell: float) -> Bool:
    """Return whether the line through each wall (I, 4) meets the cell (I, 2) beside it, (I,)."""
    ex, ey = (walls[:, 2:] - walls[:, :2]).T
    x, y = ((cells + 0.5) * cell - walls[:, :2]).T
    meets: Bool = abs(ex * y - ey * x) <= (cell / 2 + SLACK) * (abs(ex) + abs(ey))
    return meets


def _predecessors(walls: Float, cells: Int, owners: Int) -> Int:
    """Return the cell (I, 2) that each wall passes just before this one; NONE for its first.

    In a box of cells a wall is then found at least once by looking only where it comes in.
    """
    heading = (walls[:, 2:] - walls[:, :2])[owners]
    order = np.lexsort([(cells * heading).sum(axis=1), owners])
    before = np.full_like(cells, NONE)
    same = owners[order[1:]] == owners[order[:-1]]
    before[order[1:][same]] = cells[order[:-1][same]]
    return before


def _large_enough(cell: float, extent: Float, length: float) -> float:
    """Return `cell`, or what keeps both the cells of the map's box and its items bounded [m]."""
    width, height = float(extent[0]), float(extent[1])
    return max(
        cell,
        sqrt(width * height / MOST_CELLS) * 1.1,
        max(width, height, length) * 4 / MOST_CELLS,
    )


def _distances(points: Float, walls: Float) -> Float:
    """Return the distance of each point (P, 2) to the wall (P, 4) beside it [m], shape (P,)."""
    starts, extents = walls[:, :2] - points, walls[:, 2:] - walls[:, :2]
    squared = (extents * extents).sum(axis=1).clip(min=TINY)
    share = (-(starts * extents).sum(axis=1) / squared).clip(0.0, 1.0)
    x, y = (starts + share[:, None] * extents).T
    apart: Float = np.hypot(x, y)
    return apart


def _lengths(walls: Float) -> Float:
    """Return the length [m] of each of `walls` (W, 4), shape (W,)."""
    return np.hypot(walls[:, 2] - walls[:, 0], walls[:, 3] - walls[:, 1])
