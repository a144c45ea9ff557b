# ruff: noqa: PLR0917 (compiled functions take no keywords without a cost)
"""Who is where: outlines, and the table of robots by cell.

As in all kernels, a loop runs over robots `first` to `last`, so threads can share. Names: a ray
starts at (ox, oy) and runs along the unit vector (dx, dy); (ax, ay) and (bx, by) are the ends of a
segment; lattice units are cells. Arrays are those of Grid, Robots, Mounts, Fan and Drives.
"""

from math import cos, floor, inf, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.kernels.jit import inlined, kernel
from pioneer3.sim.kernels.walls import SLACK

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]
Int32 = NDArray[np.int32]

Walls = tuple[Float, Int32, Float]
"""Of a Grid: frame, cell_start, pieces."""

Others = tuple[Float, Float, Int32, Int32]
"""Of Robots: box, shapes, cell_start, cell_items."""

FAR = 1e9
"""From further away a ray does not find the grid [cells]; rounding would lose its way."""

NOWHERE = 1e8
"""Where hidden robots are placed [m]."""


@inlined
def cells(low: float, high: float, edge: float, per_metre: float) -> tuple[int, int]:
    """Return the first and last column (or row) of an interval; far away, merely outside."""
    first = floor(min(max((low - edge) * per_metre, -FAR), FAR))
    return first, floor(min(max((high - edge) * per_metre, -FAR), FAR))


@inlined
def _place(x: float, y: float, per_metre: float, mask: int) -> int:
    """Return where a point's cell is in the table."""
    column, _ = cells(x, x, 0.0, per_metre)
    row, _ = cells(y, y, 0.0, per_metre)
    return (row & mask) * (mask + 1) + (column & mask)


@kernel
def neighbours(x: float, y: float, reach: float, skip: int, others: Others, found: Int32) -> int:
    """Fill `found` with the robots, but not `skip`, within `reach`; return how many."""
    box, shapes, places, items = others
    side, per_metre, wide, count = int(box[5]), box[6], reach + box[4] + SLACK, 0
    west, east = cells(max(x - wide, box[0]), min(x + wide, box[2]), 0.0, per_metre)
    south, north = cells(max(y - wide, box[1]), min(y + wide, box[3]), 0.0, per_metre)
    if east - west >= side or north - south >= side:
        west, east, south, north = 0, side - 1, 0, side - 1
    for row in range(south, north + 1):
        for column in range(west, east + 1):
            place = (row & (side - 1)) * side + (column & (side - 1))
            for k in range(places[place], places[place + 1]):
                n = items[k]
                dx, dy, near = shapes[n, 0] - x, shapes[n, 1] - y, reach + shapes[n, 2] + SLACK
                found[count] = n
                count += n != skip and dx * dx + dy * dy <= near * near
    return count


@kernel
def outline(n: int, state: Float, shapes: Float) -> None:
    """Compute the middle, the radius and the corners of one robot."""
    x, y, c, s = state[0, n], state[1, n], cos(state[2, n]), sin(state[2, n])
    front, rear, half, cut = state[3, n], state[4, n], state[5, n], state[6, n]
    if state[7, n] != 0.0:
        x = y = NOWHERE
    middle, corners = (front - rear) / 2, (shapes.shape[1] - 3) // 2
    shapes[n, 0], shapes[n, 1] = x + c * middle, y + s * middle
    length = (front + rear) / 2
    shapes[n, 2] = sqrt(length * length + half * half)
    for k in range(corners):
        quarter = k * 4 // corners
        ahead = front if quarter % 3 == 0 else -rear
        left = half if quarter < 2 else -half
        if corners == 8:  # a cut corner is two: counter-clockwise first one then the other
            if (k + quarter) % 2 == 0:
                left -= cut if left > 0 else -cut
            else:
                ahead -= cut if ahead > 0 else -cut
        shapes[n, 3 + 2 * k] = x + c * ahead - s * left
        shapes[n, 4 + 2 * k] = y + s * ahead + c * left


@kernel
def place(state: Float, others: Others) -> None:
    """Compute outlines, and sort the robots into the table by counting."""
    box, shapes, places, items = others
    mask, per_metre = int(box[5]) - 1, box[6]
    box[0], box[1], box[2], box[3] = inf, inf, -inf, -inf
    places[:] = 0
    for n in range(len(shapes)):
        outline(n, state, shapes)
        mx, my = shapes[n, 0], shapes[n, 1]
        box[0], box[1] = min(box[0], mx), min(box[1], my)
        box[2], box[3] = max(box[2], mx), max(box[3], my)
        places[_place(mx, my, per_metre, mask)] += 1
    total = 0
    for k in range(len(places)):
        total += places[k]
        places[k] = total
    for n in range(len(shapes) - 1, -1, -1):
        k = _place(shapes[n, 0], shapes[n, 1], per_metre, mask)
        places[k] -= 1
        items[places[k]] = n
