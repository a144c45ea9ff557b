"""A map as one grid of occupied, free and unknown cells."""

import numpy as np

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
    rows, columns = np.indices(states.shape)
    x, y = low.x + (columns + 0.5) * resolution, low.y + (rows + 0.5) * resolution
    for grid in known:
        states[grid.states_at(x, y) == FREE] = FREE
    states[touched(line_map.walls, bounds, resolution)] = OCCUPIED
    return OccupancyGrid(states=states, resolution=resolution, origin=low)
