"""From scanned points to walls: the outline of the occupied grid cells."""

import numpy as np
from numpy.typing import NDArray

Float = NDArray[np.float64]
Int = NDArray[np.int64]


def outline(points: Float, resolution: float) -> Float:
    """Return the edges between occupied and free cells, neighbours on one line joined.

    Each point occupies the cell it is the centre of. A point off the grid (whose phase is that of
    the smallest coordinates) moves to the nearest cell, less than one cell away.

    Args:
        points: Occupied points [m], shape (N, 2); order and repetition don't matter.
        resolution: Side of a cell [m].

    Returns:
        Segments `x0, y0, x1, y1` [m], shape (W, 4), along the axes. Watertight: every edge of
        every occupied cell towards a free cell lies on exactly one segment.
    """
    if not points.size:
        return np.empty((0, 4))
    corner = points.min(axis=0)
    columns, rows = np.rint((points - corner) / resolution).astype(np.int64).T
    across, upright = _runs(columns, rows), _runs(rows, columns)
    count = len(across[0])
    walls = np.empty((count + len(upright[0]), 4))
    for column, (horizontal, vertical) in enumerate(((1, 0), (0, 1), (2, 0), (0, 2))):
        walls[:count, column], walls[count:, column] = across[horizontal], upright[vertical]
    # cell (0, 0) is centred on `corner`, so its lower left corner lies half a cell before it
    walls *= resolution
    walls += np.tile(corner - resolution / 2, 2)
    return walls


def _runs(along: Int, across: Int) -> tuple[Int, Int, Int]:
    """Return the edges that run in one direction, joined.

    Args:
        along: Cell indices >= 0 in the direction of the edges, shape (N,).
        across: Cell indices >= 0 at right angles to it, shape (N,).

    Returns:
        Grid line, first and last corner of each run [cells], three arrays of shape (R,).
    """
    # one spare cell at each side keeps a run from going on in the next line
    stride = int(along.max()) + 2
    cells = across * stride
    cells += along
    cells.sort()
    cells = cells[np.append(True, cells[1:] != cells[:-1])]
    # a grid line has an edge where exactly one of the two cells beside it is occupied
    edges = np.concatenate([cells, cells + stride])
    edges.sort(kind="stable")
    new = np.concatenate([[True], edges[1:] != edges[:-1], [True]])
    edges = edges[new[1:] & new[:-1]]
    breaks = np.flatnonzero(np.diff(edges) != 1) + 1
    first = edges[np.concatenate([[0], breaks])]
    last = edges[np.concatenate([breaks - 1, [-1]])]
    return first // stride, first % stride, last % stride + 1
