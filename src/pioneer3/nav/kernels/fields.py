"""Distances and ways over a raster of cells: from walls, to goals, between places."""

from math import floor, inf, sqrt

import numpy as np

from pioneer3.arrays import Bool, Float, Float32, Int, Int32, UInt8
from pioneer3.jit import inlined, kernel

Frame = tuple[float, float, float, float]
"""Left and lower edge of a raster, the side of a cell, and the longest of its distances [m]."""


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
def nearest_wall(walls: Float, frame: Frame, shift: float, out: Float32) -> None:
    """Lower each of `out` (H, W) to the distance of its cell's middle from the nearest wall [m].

    Walls are segments [m], shape (N, 4); `frame` has the left and lower edge of the cells, the side
    of one, and the distance up to which walls are looked for [m]. Only lower distances are written,
    less `shift`.
    """
    height, width = out.shape
    x0, y0, cell, reach = frame
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
                distance = distance_to(walls[i], x, y) - shift
                if distance >= out[row, column]:  # a write takes memory, as around a wall aslant
                    continue
                out[row, column] = distance


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
        after: The next cell in the same bucket, -1 after the last, 0 for a cell that does not wait,
            as all do, shape (N,).
        out: Shape (N,), filled with `inf`.
    """
    buckets, turn, waiting = len(first), 0, 1
    out[goal] = 0.0
    first[0], after[goal] = goal, -1
    while waiting > 0:
        open_ = turn % buckets
        while first[open_] >= 0:
            cell = first[open_]
            first[open_], after[cell] = after[cell], 0
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
                if after[near] == 0:
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


@inlined
def score_of(scores: UInt8, row: int, column: int, ends: Int32, least: int) -> int:
    """Return the sum of `scores` (H, W) at the `ends` (B, 2) of beams from a cell.

    It ends with less than `least` where it cannot come to that any more.
    """
    total, (rows, columns) = 0, scores.shape
    for beam in range(len(ends)):
        if total + 255 * (len(ends) - beam) < least:
            break
        r, c = row + ends[beam, 0], column + ends[beam, 1]
        if 0 <= r < rows and 0 <= c < columns:
            total += int(scores[r, c])
    return total


@kernel
def may_come_to(scores: UInt8, row: int, column: int, ends: Int32, least: int) -> bool:
    """Return whether `scores` at the `ends` (2, B, 2) of beams come to `least` at a heading."""
    first = score_of(scores, row, column, ends[0], least)
    return first >= least or score_of(scores, row, column, ends[1], least) >= least


@kernel
def best_places(
    fields: UInt8, free: Bool, blocks: Int32, offsets: Int32, least: int, out: Int32
) -> int:
    """Fill `out` with the places and headings that come to a score; return the number of rows.

    Of two rows, two columns and two headings, the best counts. A square of places is passed over
    where the highest score near each end together come to less.

    Args:
        fields: Score of an end in each cell, 255 at a wall; the highest of it and its neighbours
            above and to the right, of 2, 4 and 8 rows and columns; shape (4, rows, columns).
        free: Where the robot may be, whole blocks, shape (rows, columns).
        blocks: First row and column of blocks of 8 by 8 of these, shape (N, 2).
        offsets: Rows and columns from a place to the cells of `fields` where B beams end, at an
            even number of headings, shape (H, B, 2).
        least: The score to come to.
        out: Row, column, heading and score, shape (8 * H * N, 4).
    """
    count = 0
    for i in range(len(blocks)):
        for turn in range(0, len(offsets), 2):
            ends = offsets[turn : turn + 2]
            if not may_come_to(fields[3], blocks[i, 0], blocks[i, 1], ends, least):
                continue
            for part in range(16):  # four quarters of a block, and four of each
                row = blocks[i, 0] + 4 * (part // 8) + 2 * (part // 2 % 2)
                column = blocks[i, 1] + 4 * (part // 4 % 2) + 2 * (part % 2)
                if part % 4 == 0:
                    near = may_come_to(fields[2], row, column, ends, least)
                if not (near and may_come_to(fields[1], row, column, ends, least)):
                    continue
                best = least - 1
                for each in range(8):
                    r, c, heading = row + each // 4, column + each // 2 % 2, each % 2
                    if free[r, c]:
                        score = score_of(fields[0], r, c, ends[heading], best + 1)
                        if score > best:
                            best = score
                            out[count, 0], out[count, 1] = r, c
                            out[count, 2], out[count, 3] = turn + heading, score
                count += best >= least
    return count
