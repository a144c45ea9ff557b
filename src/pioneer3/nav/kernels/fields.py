"""Distances and ways over a raster of cells: from walls, to goals, between places."""

from math import floor, inf, sqrt

import numpy as np

from pioneer3.arrays import Bool, Float, Float32, Int, Int32, UInt8, UInt16
from pioneer3.jit import inlined, kernel


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

    Walls are segments [m], shape (N, 4); the raster begins at `x0`, `y0`, with cells of side `cell`
    [m]. Only lower distances are written.
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


NOT_WAITING = -2
"""Entry of `after` for a cell that does not wait; -1 ends a bucket."""


@kernel
def march(
    costs: Float32, goal: int, width: int, depth: float, first: Int32, after: Int32, out: Float32
) -> None:
    """Fill `out` with the cost of the cheapest way to the goal.

    Args:
        costs: Of crossing each cell from side to side, row after row, shape (N,); `inf` where there
            is no way, as in all cells at the edges of the raster.
        goal: Number of its cell, which is none of these edges.
        width: Of a row [cells].
        depth: Range of the costs in one bucket.
        first: A cell of each bucket, filled with -1, shape (B,); a bucket serves again B later, and
            `depth` times B - 2 is no less than the highest finite cost.
        after: The next cell in the same bucket, filled with `NOT_WAITING`, shape (N,).
        out: Shape (N,), filled with `inf`.
    """
    buckets, turn, waiting = len(first), 0, 1
    out[goal] = 0.0
    first[0], after[goal] = goal, -1
    while waiting > 0:
        open_ = turn % buckets
        while first[open_] >= 0:
            cell = first[open_]
            first[open_], after[cell] = after[cell], NOT_WAITING
            waiting -= 1
            here = out[cell]
            for side in range(4):
                near = cell + (side == 0) - (side == 1) + width * ((side == 2) - (side == 3))
                old, step = out[near], np.float64(costs[near])
                if old <= here or step == inf:
                    continue
                across = np.float64(min(out[near - 1], out[near + 1]))  # the lower one in the row
                along = np.float64(min(out[near - width], out[near + width]))
                apart = across - along
                if abs(apart) < step:
                    value = (across + along + sqrt(2.0 * step * step - apart * apart)) / 2.0
                else:
                    value = min(across, along) + step
                new = np.float32(value)  # else the same cost might seem lower for ever
                if new >= old:
                    continue
                out[near] = new
                if after[near] == NOT_WAITING:
                    # one that waits keeps its bucket: that is late for few cells, and by little
                    bucket = max(turn, int(new / depth)) % buckets
                    after[near] = first[bucket]
                    first[bucket] = near
                    waiting += 1
        turn += 1


@kernel
def ways_from(free: Bool, start: int, queue: Int, queued: Bool, out: Float) -> None:
    """Lower `out` (H * W,) to the length of the shortest way over free cells from one [cells].

    Ways go to the eight neighbours; those aslant pass no corner.

    Args:
        free: Shape (H, W); the cells at its edges are not free.
        start: Number of a cell.
        queue: Shape (H * W,).
        queued: Which cells wait in `queue`: none; shape (H * W,).
        out: Bounds: only shorter ways are written, and `start` has 0.
    """
    width, size = free.shape[1], len(queue)
    cells = free.ravel()
    out[start] = 0.0
    queue[0] = start
    queued[start] = True
    first, waiting = 0, 1
    while waiting > 0:
        at = queue[first]
        first = (first + 1) % size
        waiting -= 1
        queued[at] = False
        for row in range(-1, 2):
            for column in range(-1, 2):
                to = at + row * width + column
                if (row == 0 and column == 0) or not cells[to]:
                    continue
                way = out[at] + 1.0
                if row != 0 and column != 0:
                    if not (cells[at + column] and cells[at + row * width]):
                        continue
                    way = out[at] + 1.4142135623730951
                if way < out[to] - 1e-9:
                    out[to] = way
                    if not queued[to]:
                        queued[to] = True
                        queue[(first + waiting) % size] = to
                        waiting += 1


@kernel
def score_places(field: UInt8, cells: Int32, offsets: Int32, out: UInt16) -> None:
    """Fill `out` (C, H) with the sums of `field` at the ends of beams.

    Args:
        field: Score of an end in each cell, 255 at a wall, shape (rows, columns).
        cells: Row and column of the robot, shape (C, 2).
        offsets: Rows and columns from there to the ends of B beams at H headings, shape (H, B, 2).
        out: Of up to 257 beams.
    """
    rows, columns = field.shape
    for i in range(len(cells)):
        row, column = cells[i, 0], cells[i, 1]
        for heading in range(offsets.shape[0]):
            total = 0
            for beam in range(offsets.shape[1]):
                r, c = row + offsets[heading, beam, 0], column + offsets[heading, beam, 1]
                if 0 <= r < rows and 0 <= c < columns:
                    total += int(field[r, c])
            out[i, heading] = total
