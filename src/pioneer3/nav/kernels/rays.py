"""Rays through the cells of a map."""

from math import floor, sqrt

import numpy as np
from numpy.typing import NDArray

from pioneer3.jit import inlined, kernel

Float = NDArray[np.float64]
Int = NDArray[np.int64]
Counts = NDArray[np.int32]


@inlined
def mark(seen: Counts, corner: Int, number: int, x: float, y: float, out: Int, count: int) -> int:
    """Note the cell of a point, in cells, unless it was noted in this scan; return their number."""
    height, width = seen.shape
    row, column = floor(y) - corner[0], floor(x) - corner[1]
    if not (0 <= column < width and 0 <= row < height) or seen[row, column] == number:
        return count
    seen[row, column] = number
    out[count] = row * width + column
    return count + 1


@kernel
def hit_cells(
    points: Float, lines: Float, bridge: float, seen: Counts, corner: Int, number: int, out: Int
) -> int:
    """Fill `out` with the cells in which a scan ended, each once; return how many.

    Between neighbouring points of one line, the cells between them are hit, too.

    Args:
        points: Of the scan [cells], shape (N, 2).
        lines: Normals at the points, zeros where there is none, shape (N, 3).
        bridge: Neighbours farther apart than this [cells] are of two things.
        seen: A number for each cell, shape (H, W).
        corner: Row and column of the first of these.
        number: Is written into the cells found; larger than any before.
        out: Shape (K,), long enough.
    """
    count = 0
    for i in range(len(points)):
        x, y = points[i, 0], points[i, 1]
        count = mark(seen, corner, number, x, y, out, count)
        if i + 1 == len(points):
            continue
        if lines[i, 0] * lines[i + 1, 0] + lines[i, 1] * lines[i + 1, 1] < 0.9:
            continue
        dx, dy = points[i + 1, 0] - x, points[i + 1, 1] - y
        apart = sqrt(dx * dx + dy * dy)
        aside = abs(dx * lines[i, 0] + dy * lines[i, 1])
        if apart > bridge or aside > 0.5:
            continue
        steps = floor(2 * apart)
        for k in range(1, steps + 1):
            share = k / (steps + 1)
            count = mark(seen, corner, number, x + share * dx, y + share * dy, out, count)
    return count


@kernel
def passed_cells(
    origin: Float, ends: Float, seen: Counts, corner: Int, number: int, out: Int
) -> int:
    """Fill `out` with the cells that rays pass, without those seen already; return how many.

    Args:
        origin: Of the rays [cells], shape (2,).
        ends: Of each [cells], shape (N, 2).
        seen: A number for each cell, shape (H, W); cells that have `number` are left out.
        corner: Row and column of the first of these.
        number: Is written into the cells found.
        out: Shape (H * W,).
    """
    count = 0
    for i in range(len(ends)):
        x, y = origin[0], origin[1]
        dx, dy = ends[i, 0] - x, ends[i, 1] - y
        column, row = floor(x), floor(y)
        steps = abs(floor(ends[i, 0]) - column) + abs(floor(ends[i, 1]) - row)
        step_x, step_y = 1 if dx > 0 else -1, 1 if dy > 0 else -1
        # shares of the ray from one edge of cells to the next, and at the first one
        per_x = 1.0 / abs(dx) if dx != 0 else 1e18
        per_y = 1.0 / abs(dy) if dy != 0 else 1e18
        next_x = per_x * (column + 1 - x if dx > 0 else x - column)
        next_y = per_y * (row + 1 - y if dy > 0 else y - row)
        for _ in range(steps + 1):
            count = mark(seen, corner, number, column + 0.5, row + 0.5, out, count)
            if next_x < next_y:
                next_x += per_x
                column += step_x
            else:
                next_y += per_y
                row += step_y
    return count
