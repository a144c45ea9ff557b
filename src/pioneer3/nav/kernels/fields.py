"""Distances to walls, in a raster of cells, and between them."""

from math import floor, sqrt

import numpy as np
from numpy.typing import NDArray

from pioneer3.jit import inlined, kernel

Float = NDArray[np.float64]
Float32 = NDArray[np.float32]


@inlined
def distance_to(wall: Float, x: float, y: float) -> float:
    """Return the distance of a point from a segment `wall` (4,) [m]."""
    dx, dy = wall[2] - wall[0], wall[3] - wall[1]
    squared = dx * dx + dy * dy
    share = 0.0
    if squared > 0.0:
        share = min(1.0, max(0.0, ((x - wall[0]) * dx + (y - wall[1]) * dy) / squared))
    off_x, off_y = x - wall[0] - share * dx, y - wall[1] - share * dy
    return sqrt(off_x * off_x + off_y * off_y)


@kernel
def nearest_wall(walls: Float, x0: float, y0: float, cell: float, out: Float32) -> None:
    """Lower each of `out` (H, W) to the distance of its cell's middle from the nearest wall [m].

    Args:
        walls: Segments [m], shape (N, 4).
        x0: Left edge of the raster [m].
        y0: Lower edge [m].
        cell: Side of a cell [m].
        out: Bounds: only lower distances are written.
    """
    height, width = out.shape
    reach = float(out.max())
    for i in range(len(walls)):
        ax, ay, bx, by = walls[i, 0], walls[i, 1], walls[i, 2], walls[i, 3]
        left = max(0, floor((min(ax, bx) - reach - x0) / cell))
        right = min(width - 1, floor((max(ax, bx) + reach - x0) / cell))
        low = max(0, floor((min(ay, by) - reach - y0) / cell))
        high = min(height - 1, floor((max(ay, by) + reach - y0) / cell))
        for row in range(low, high + 1):
            y = y0 + (row + 0.5) * cell
            for column in range(left, right + 1):
                x = x0 + (column + 0.5) * cell
                distance = distance_to(walls[i], x, y)
                out[row, column] = min(out[row, column], distance)


@inlined
def interpolate(field: Float32, x: float, y: float, outside: float) -> float:
    """Return the value at a point between four middles of cells.

    Args:
        field: Shape (H, W).
        x: In cells from the left edge.
        y: In cells from the lower edge.
        outside: The value where there are no four cells around the point.
    """
    height, width = field.shape
    u, v = x - 0.5, y - 0.5
    column, row = floor(u), floor(v)
    if not (0 <= column < width - 1 and 0 <= row < height - 1):
        return outside
    u, v = u - column, v - row
    low = field[row, column] * (1.0 - u) + field[row, column + 1] * u
    high = field[row + 1, column] * (1.0 - u) + field[row + 1, column + 1] * u
    return float(low * (1.0 - v) + high * v)


@kernel
def interpolate_all(field: Float32, points: Float, outside: float, out: Float) -> None:
    """Fill `out` (N,) with the values at `points` (N, 2), in cells from the lower left corner."""
    for i in range(len(points)):
        out[i] = interpolate(field, points[i, 0], points[i, 1], outside)
