"""Occupancy grids and walls: outlines of occupied cells, and the cells that walls pass."""

from math import ceil, cos, sin

import numpy as np

from pioneer3.arrays import Bool, Float, Int
from pioneer3.geometry import Extent, Pose2
from pioneer3.maps.line_map import OCCUPIED, UNKNOWN, OccupancyGrid

MOST_CELLS = 1 << 25
"""Larger grids and pictures are refused before memory is taken: 5792 x 5792, 290 m at 5 cm."""
MOST_WALLS = 1_000_000
"""A picture with more edges than this is noise, not a map."""
EDGE = 1e-6
"""A point nearer to the edge of a cell than this counts as on it [cells]."""


def grid_of(points: Float, resolution: float) -> OccupancyGrid | None:
    """Return the grid whose occupied cells :func:`outline` outlines.

    Return `None` where there are no `points`, or they lie too far apart.
    """
    if not points.size:
        return None
    corner = points.min(axis=0)
    # before numbers become indices: points may lie 100 km apart
    extent = np.rint((points.max(axis=0) - corner) / resolution) + 1
    if extent.prod() > MOST_CELLS:
        return None
    columns, rows = np.rint((points - corner) / resolution).astype(np.int64).T
    states = np.full((int(extent[1]), int(extent[0])), UNKNOWN, dtype=np.uint8)
    states[rows, columns] = OCCUPIED
    x, y = (corner - resolution / 2).tolist()
    return OccupancyGrid(states=states, resolution=resolution, origin=Pose2(x, y))


def outline(points: Float, resolution: float) -> Float:
    """Return the edges between occupied and free cells, neighbours on one line joined.

    Each of `points` (N, 2) [m] occupies the cell it is the centre of, with sides of `resolution`
    [m]; order and repetition don't matter. A point off the grid (whose phase is that of the
    smallest coordinates) moves to the nearest cell, less than one cell away.

    Returns:
        Segments `x0, y0, x1, y1` [m], shape (W, 4), along the axes. Watertight: every edge of
        every occupied cell towards a free cell lies on exactly one segment.
    """
    if not points.size:
        return np.empty((0, 4))
    corner = points.min(axis=0)
    columns, rows = np.rint((points - corner) / resolution).astype(np.int64).T
    across, upright = _edge_runs(columns, rows), _edge_runs(rows, columns)
    count = len(across[0])
    walls = np.empty((count + len(upright[0]), 4))
    for column, (horizontal, vertical) in enumerate(((1, 0), (0, 1), (2, 0), (0, 2))):
        walls[:count, column], walls[count:, column] = across[horizontal], upright[vertical]
    # cell (0, 0) is centred on `corner`, so its lower left corner lies half a cell before it
    walls *= resolution
    walls += np.tile(corner - resolution / 2, 2)
    return walls


def _edge_runs(along: Int, across: Int) -> tuple[Int, Int, Int]:
    """Return grid line, first and last corner of each run of edges [cells], shape (R,) each.

    `along` and `across` are cell indices >= 0 in the direction of the edges and at right angles to
    it, shape (N,).
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


def raster_outline(occupied: Bool) -> Float:
    """Return the edges between occupied and free cells, neighbours on one line joined.

    Row 0 of `occupied` (H, W) is the lowest; all around it is free. The segments x0, y0, x1, y1
    [cells] count from the lower left corner, shape (W, 4), watertight as those of :func:`outline`.

    Raises:
        OverflowError: There are more than :data:`MOST_WALLS`.
    """
    framed = np.pad(occupied, 1)
    line, start, end = _row_runs(framed[1:, 1:-1] != framed[:-1, 1:-1])
    horizontal = np.stack([start, line, end, line], axis=1)
    line, start, end = _row_runs((framed[1:-1, 1:] != framed[1:-1, :-1]).T)
    vertical = np.stack([line, start, line, end], axis=1)
    return np.concatenate([horizontal, vertical]).astype(np.float64)


def walls_of(grid: OccupancyGrid) -> Float:
    """Return the outline of the occupied cells of a grid, as walls of its map [m], shape (W, 4)."""
    edges, origin = raster_outline(grid.states == OCCUPIED) * grid.resolution, grid.origin
    c, s = cos(origin.theta), sin(origin.theta)
    x, y = edges[:, ::2], edges[:, 1::2]
    walls = np.empty_like(edges)
    walls[:, ::2], walls[:, 1::2] = origin.x + c * x - s * y, origin.y + s * x + c * y
    return walls


def _row_runs(edges: Bool) -> tuple[Int, Int, Int]:
    """Return line, first and last corner of each run of edges along the rows, shape (R,) each."""
    changes = np.diff(np.pad(edges, ((0, 0), (1, 1))).view(np.int8), axis=1)
    if np.count_nonzero(changes) > 2 * MOST_WALLS:
        raise OverflowError(f"more than {MOST_WALLS / 1e6:.0f} million edges; not a map")
    line, start = np.nonzero(changes == 1)
    return line, start, np.nonzero(changes == -1)[1]


def touched(walls: Float, bounds: Extent, cell: float) -> Bool:
    """Return the cells that `walls` (W, 4) [m], all in `bounds`, pass; row 0 is the lowest.

    A cell that a wall cuts by less than half a cell's side may be left out; neighbours along a
    wall always touch, at a corner at least.
    """
    height, width = shape_of(bounds, cell)
    cells = np.zeros((height, width), dtype=np.bool_)
    points = samples(walls, cell / 2)
    # a point that lies on an edge, except for rounding, belongs to the cell beyond it
    places = (points - (bounds.x_min, bounds.y_min)) / cell + EDGE
    columns, rows = np.floor(places).astype(np.int64).T
    cells[rows.clip(0, height - 1), columns.clip(0, width - 1)] = True
    return cells


def shape_of(bounds: Extent, cell: float) -> tuple[int, int]:
    """Return height and width [cells] of a picture of `bounds`, at least one each."""
    # a size of whole cells, except for rounding, takes no cell more
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
