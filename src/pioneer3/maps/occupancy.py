"""A map as one grid of occupied, free and unknown cells."""

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.maps.grid import shape_of, touched
from pioneer3.maps.line_map import FREE, OCCUPIED, UNKNOWN, LineMap, OccupancyGrid
from pioneer3.maps.write import RESOLUTION, framed

MOST_CELLS = 4_000_000
"""Cells become larger until there are no more."""


def occupancy_of(
    line_map: LineMap, resolution: float = RESOLUTION, most: int = MOST_CELLS
) -> OccupancyGrid:
    """Return the grid of a map.

    A map that is one grid, of which it knows the free cells, stays as it is. Else the cells that
    walls pass are occupied. The others are free, except where the map's grids know nothing: walls
    alone don't say on which side of them anything is known. The result has at most `most` cells,
    with sides of `resolution` [m] or more.
    """
    known = [grid for grid in line_map.grids if (grid.states == FREE).any()]
    if len(known) == len(line_map.grids) == 1 and not len(line_map.lines):
        return known[0].coarser(most)
    while np.prod(shape_of(framed(line_map.bounds, resolution), resolution)) > most:
        resolution *= 2
    bounds = framed(line_map.bounds, resolution)
    states = np.full(shape_of(bounds, resolution), UNKNOWN if known else FREE, dtype=np.uint8)
    low = Pose2(bounds.x_min, bounds.y_min)
    for grid in known:
        _copy_free(grid, states, low, resolution)
    states[touched(line_map.walls, bounds, resolution)] = OCCUPIED
    return OccupancyGrid(states=states, resolution=resolution, origin=low)


def _copy_free(
    grid: OccupancyGrid, states: NDArray[np.uint8], low: Pose2, resolution: float
) -> None:
    """Mark the cells whose middles are free in `grid`; the first cell's corner is `low`."""
    rows, columns = np.indices(states.shape)
    dx = low.x + (columns + 0.5) * resolution - grid.origin.x
    dy = low.y + (rows + 0.5) * resolution - grid.origin.y
    c, s = np.cos(grid.origin.theta), np.sin(grid.origin.theta)
    column = np.floor((c * dx + s * dy) / grid.resolution).astype(np.int64)
    row = np.floor((c * dy - s * dx) / grid.resolution).astype(np.int64)
    height, width = grid.states.shape
    within = (column >= 0) & (column < width) & (row >= 0) & (row < height)
    free = np.zeros(states.shape, dtype=np.bool_)
    free[within] = grid.states[row[within], column[within]] == FREE
    states[free] = FREE
