"""Between pictures of cells and walls."""

from math import ceil

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.maps.line_map import Bounds

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]

MOST_WALLS = 1_000_000
"""A picture with more edges than this is no map but noise."""


EDGE = 1e-6
"""Nearer to the edge of a cell [cells] is on it."""


def raster_outline(occupied: Bool) -> Float:
    """Return the edges between occupied and free cells, neighbours on one line joined.

    Args:
        occupied: Shape (H, W); row 0 is the lowest. All around it is free.

    Returns:
        Segments `x0, y0, x1, y1` [cells] from the lower left corner, shape (W, 4), watertight as
        those of :func:`pioneer3.sim.maps.outline.outline`.

    Raises:
        OverflowError: There are more than :data:`MOST_WALLS`.
    """
    framed = np.pad(occupied, 1)
    line, start, end = _runs(framed[1:, 1:-1] != framed[:-1, 1:-1])
    horizontal = np.stack([start, line, end, line], axis=1)
    line, start, end = _runs((framed[1:-1, 1:] != framed[1:-1, :-1]).T)
    vertical = np.stack([line, start, line, end], axis=1)
    return np.concatenate([horizontal, vertical]).astype(np.float64)


def _runs(edges: Bool) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Return line, first and last corner of each run of edges along the rows, shape (R,) each."""
    changes = np.diff(np.pad(edges, ((0, 0), (1, 1))).view(np.int8), axis=1)
    if np.count_nonzero(changes) > 2 * MOST_WALLS:
        raise OverflowError
    line, start = np.nonzero(changes == 1)
    return line, start, np.nonzero(changes == -1)[1]


def touched(walls: Float, bounds: Bounds, cell: float) -> Bool:
    """Return the cells that walls pass, shape (H, W); row 0 is the lowest.

    A cell that a wall cuts by less than half a cell's side may be left out; neighbours along a
    wall always touch, at a corner at least.

    Args:
        walls: Segments [m], shape (W, 4), all within `bounds`.
        bounds: Of the picture [m].
        cell: Side of a cell [m].
    """
    height, width = shape_of(bounds, cell)
    cells = np.zeros((height, width), dtype=np.bool_)
    points = samples(walls, cell / 2)
    # what lies on an edge but for rounding belongs to the cell beyond it
    places = (points - (bounds.x_min, bounds.y_min)) / cell + EDGE
    columns, rows = np.floor(places).astype(np.int64).T
    cells[rows.clip(0, height - 1), columns.clip(0, width - 1)] = True
    return cells


def shape_of(bounds: Bounds, cell: float) -> tuple[int, int]:
    """Return height and width [cells] of a picture of `bounds`, at least one each."""
    # what is a whole number of cells but for rounding takes no cell more
    width = ceil((bounds.x_max - bounds.x_min) / cell - EDGE)
    height = ceil((bounds.y_max - bounds.y_min) / cell - EDGE)
    return max(1, height), max(1, width)


def samples(walls: Float, step: float) -> Float:
    """Return points along walls (W, 4), ends among them, `step` [m] apart at most; (N, 2)."""
    lengths = np.hypot(walls[:, 2] - walls[:, 0], walls[:, 3] - walls[:, 1])
    counts = np.ceil(lengths / step).astype(np.int64) + 1
    owners = np.repeat(np.arange(len(walls)), counts)
    number = np.arange(len(owners)) - np.repeat(np.cumsum(counts) - counts, counts)
    share = (number / np.maximum(counts - 1, 1)[owners])[:, None]
    points: Float = walls[owners, :2] * (1 - share) + walls[owners, 2:] * share
    return points
