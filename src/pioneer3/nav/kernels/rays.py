"""Rays through the cells of a map, and cells in which things were seen that are not on it."""

from math import floor, hypot, sqrt

from pioneer3.arrays import Float, Int, UInt8
from pioneer3.jit import inlined, kernel


@inlined
def mark(seen: UInt8, corner: Int, number: int, x: float, y: float, out: Int, count: int) -> int:
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
    points: Float, lines: Float, bridge: float, seen: UInt8, corner: Int, number: int, out: Int
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
    origin: Float, ends: Float, seen: UInt8, corner: Int, number: int, out: Int
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


@kernel
def thin_points(
    points: Float, place: Float, within: float, discs: Float, taken: UInt8, out: Float, count: int
) -> int:
    """Add the points around a place to `out`, one of each cell; return how many are in it then.

    Args:
        points: [m], shape (N, 2).
        place: Middle of the cells [m] and side of one [m], shape (3,).
        within: Distance from there at most [m].
        discs: x, y and radius of what points are left out of [m], shape (D, 3).
        taken: Whether a cell has a point already, shape (S, S).
        out: Shape (S * S, 2).
        count: Points that are in it.
    """
    side = len(taken)
    for i in range(len(points)):
        x, y = points[i, 0], points[i, 1]
        dx, dy = x - place[0], y - place[1]
        column, row = floor(dx / place[2] + 0.5) + side // 2, floor(dy / place[2] + 0.5) + side // 2
        inside = 0 <= column < side and 0 <= row < side
        if not inside or taken[row, column] or sqrt(dx * dx + dy * dy) > within:
            continue
        apart = True
        for j in range(len(discs)):
            dx, dy = x - discs[j, 0], y - discs[j, 1]
            apart = apart and sqrt(dx * dx + dy * dy) > discs[j, 2]
        if apart:
            taken[row, column] = 1
            out[count, 0], out[count, 1] = x, y
            count += 1
    return count


@kernel
def clear_beams(origin: Float, ends: Float, short: float, seen: Float, counts: UInt8) -> None:
    """Forget what was seen in the cells that beams pass.

    Args:
        origin: Where all beams begin [cells], shape (2,).
        ends: Where they end [cells], shape (N, 2).
        short: The last part of each, which is not looked at [cells].
        seen: Time of the last sighting in each cell, 0 for none, shape (H, W).
        counts: How often something was seen there since it was free, shape (H, W).
    """
    height, width = seen.shape
    for i in range(len(ends)):
        dx, dy = ends[i, 0] - origin[0], ends[i, 1] - origin[1]
        length = hypot(dx, dy)
        if length <= short:
            continue
        dx, dy = dx / length, dy / length
        for step in range(floor(2.0 * (length - short))):
            column, row = floor(origin[0] + dx * step / 2), floor(origin[1] + dy * step / 2)
            if 0 <= column < width and 0 <= row < height:
                seen[row, column], counts[row, column] = 0.0, 0
