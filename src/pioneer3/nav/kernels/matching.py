"""Points of a scan against the points of others."""

from math import cos, floor, sin, sqrt

import numpy as np

from pioneer3.arrays import Float, Int, UInt8
from pioneer3.jit import inlined, kernel


@kernel
def sort_into(cells: Int, starts: Int, order: Int) -> None:
    """Fill `order` (N,) with the numbers of points by cell, and `starts` (C + 1,) with the firsts.

    The points of cell `c`, which `cells` (N,) has for each, are `order[starts[c]:starts[c + 1]]`;
    `starts` has zeros before.
    """
    for i in range(len(cells)):
        starts[cells[i] + 1] += 1
    for c in range(1, len(starts)):
        starts[c] += starts[c - 1]
    for i in range(len(cells) - 1, -1, -1):
        order[starts[cells[i] + 1] - 1] = i
        starts[cells[i] + 1] -= 1
    # each start has moved to that of the cell before
    for c in range(len(starts) - 1):
        starts[c] = starts[c + 1]
    starts[len(starts) - 1] = len(cells)


@inlined
def nearest(
    starts: Int,
    targets: Float,
    grid: Float,
    shape: Int,
    x: float,
    y: float,
    nx: float,
    ny: float,
    reach: float,
) -> int:
    """Return the number of the target nearest to a point within `reach` [m], -1 without one.

    Both sides of a thin wall are near each other: the normals must not differ by more than 60
    degrees. That of the point is (0, 0) where it is not known. Targets have x, y and normal, sorted
    by cell as :func:`sort_into` does, shape (N, 4); `grid` has left and lower edge and side of a
    cell [m], `shape` rows and columns.
    """
    cell, found, best = grid[2], -1, reach * reach
    least = 0.5 if nx != 0.0 or ny != 0.0 else -1.0
    u, v = (x - grid[0]) / cell, (y - grid[1]) / cell
    column, row, ring = floor(u), floor(v), 0
    # to the nearest edge of the cell
    inner = min(u - column, column + 1 - u, v - row, row + 1 - v) * cell
    while True:
        for r in range(max(0, row - ring), min(shape[0], row + ring + 1)):
            edge = abs(r - row) == ring
            c = column - ring
            while c <= column + ring:
                if 0 <= c < shape[1]:
                    at = r * shape[1] + c
                    for k in range(starts[at], starts[at + 1]):
                        dx, dy = targets[k, 0] - x, targets[k, 1] - y
                        off = dx * dx + dy * dy
                        if off < best and targets[k, 2] * nx + targets[k, 3] * ny >= least:
                            best = off
                            found = k
                c += 1 if edge or ring == 0 else 2 * ring
        beyond = inner + ring * cell
        if not beyond * beyond < best:  # and so where the place is not a number
            return found
        ring += 1


@inlined
def solve3(a: Float, b: Float, out: Float) -> bool:
    """Fill `out` with the solution of a symmetric system of three by Cholesky's method."""
    l00 = a[0, 0]
    if not l00 > 0.0:
        return False
    l00 = sqrt(l00)
    l10, l20 = a[1, 0] / l00, a[2, 0] / l00
    l11 = a[1, 1] - l10 * l10
    if not l11 > 0.0:
        return False
    l11 = sqrt(l11)
    l21 = (a[2, 1] - l20 * l10) / l11
    l22 = a[2, 2] - l20 * l20 - l21 * l21
    if not l22 > 0.0:
        return False
    l22 = sqrt(l22)
    y0 = b[0] / l00
    y1 = (b[1] - l10 * y0) / l11
    y2 = (b[2] - l20 * y0 - l21 * y1) / l22
    out[2] = y2 / l22
    out[1] = (y1 - l21 * out[2]) / l11
    out[0] = (y0 - l10 * out[1] - l20 * out[2]) / l00
    return True


@kernel
def align(
    starts: Int,
    targets: Float,
    grid: Float,
    shape: Int,
    points: Float,
    pose: Float,
    expected: Float,
    prior: Float,
    widths: Float,
    reach: float,
    sigma: float,
    information: Float,
) -> float:
    """Move `pose` to where points lie on the lines through their nearest targets.

    Gauss-Newton's method with Tukey's weights, which get narrower.

    Args:
        starts: As for :func:`nearest`, and the next three.
        targets: x, y and normal.
        grid: Of the cells.
        shape: Of the grid.
        points: Of the scan and its normals, in the robot's frame, shape (M, 4).
        pose: Of the robot [m, m, rad], shape (3,); the guess before, the result after.
        expected: The pose by odometry.
        prior: Information of that.
        widths: Of the weights [m], one after the other.
        reach: The nearest target is looked for as far as this [m], and as the width.
        sigma: Standard deviation of a point from its line [m].
        information: Is filled with that of the result, without the prior, shape (3, 3).

    Returns:
        The share of points nearer to a target's line than the last width.
    """
    gradient, step, system = np.zeros(3), np.zeros(3), np.zeros((3, 3))
    inliers, rounds = 0, 0
    for level in range(len(widths)):
        width = widths[level]
        radius = max(width, reach)
        last = level == len(widths) - 1
        for _ in range(20 if last else 6):
            rounds += 1
            information[:] = 0.0
            gradient[:] = 0.0
            inliers = 0
            c, s = cos(pose[2]), sin(pose[2])
            for i in range(len(points)):
                px = c * points[i, 0] - s * points[i, 1]
                py = s * points[i, 0] + c * points[i, 1]
                x, y = px + pose[0], py + pose[1]
                nx = c * points[i, 2] - s * points[i, 3]
                ny = s * points[i, 2] + c * points[i, 3]
                k = nearest(starts, targets, grid, shape, x, y, nx, ny, radius)
                if k < 0:
                    continue
                nx, ny = targets[k, 2], targets[k, 3]
                off = (x - targets[k, 0]) * nx + (y - targets[k, 1]) * ny
                if abs(off) >= width:
                    continue
                inliers += 1
                weight = 1.0 - (off / width) * (off / width)
                weight *= weight / (sigma * sigma)
                lever = px * ny - py * nx
                information[0, 0] += weight * nx * nx
                information[1, 0] += weight * nx * ny
                information[1, 1] += weight * ny * ny
                information[2, 0] += weight * nx * lever
                information[2, 1] += weight * ny * lever
                information[2, 2] += weight * lever * lever
                gradient[0] -= weight * off * nx
                gradient[1] -= weight * off * ny
                gradient[2] -= weight * off * lever
            information[0, 1] = information[1, 0]
            information[0, 2] = information[2, 0]
            information[1, 2] = information[2, 1]
            for a in range(3):
                for b in range(3):
                    system[a, b] = information[a, b] + prior[a, b]
                    gradient[a] += prior[a, b] * (expected[b] - pose[b])
            if not solve3(system, gradient, step):
                break
            for a in range(3):
                pose[a] += step[a]
            if abs(step[0]) + abs(step[1]) + 5.0 * abs(step[2]) < (1e-4 if last else 1e-3):
                break
    return float(inliers / max(1, len(points)))


@kernel
def smear(points: Float, grid: Float, profile: UInt8, out: UInt8) -> None:
    """Raise lower cells of `out` (H, W) around points (N, 2) [m] to a `profile` of odd size.

    The `grid` has left and lower edge, and side of a cell [m].
    """
    height, width = out.shape
    half = len(profile) // 2
    for i in range(len(points)):
        column = floor((points[i, 0] - grid[0]) / grid[2]) - half
        row = floor((points[i, 1] - grid[1]) / grid[2]) - half
        if column < 0 or row < 0 or column + 2 * half >= width or row + 2 * half >= height:
            continue
        for r in range(len(profile)):
            for c in range(len(profile)):
                out[row + r, column + c] = max(out[row + r, column + c], profile[r, c])


@inlined
def penalty(rows: float, columns: float, off: float, limits: Float) -> float:
    """Return how much less a shift [cells] and a turn [rad] are worth than none."""
    u, v, w = rows / limits[0], columns / limits[0], off / limits[1]
    return float(limits[2] * (u * u + v * v + w * w))


@inlined
def worth_of(
    raster: UInt8,
    cells: Int,
    row: int,
    column: int,
    size: int,
    off: float,
    limits: Float,
) -> float:
    """Return a bound on the worth of the shifts in a block, by a raster for blocks of its size.

    The block begins at a shift [cells] of `cells` (N, 2); a block of one cell is worth just this.
    """
    height, width = raster.shape
    total = 0
    for i in range(len(cells)):
        r, c = cells[i, 0] + row, cells[i, 1] + column
        if 0 <= r < height and 0 <= c < width:
            total += int(raster[r, c])
    near_row = max(0, row, -row - size + 1)
    near_column = max(0, column, -column - size + 1)
    return total - penalty(near_row, near_column, off, limits)


@kernel
def search(
    pyramid: UInt8,
    cells: Int,
    turns: Float,
    sectors: Int,
    keep: float,
    limits: Float,
    out: Int,
    worths: Float,
) -> None:
    """Find the turn and shift of points with the highest sum of a raster below them.

    Shifts are tried in blocks, whose sums are bounded by those of the pyramid: each block that may
    hold something better is divided into four.

    Args:
        pyramid: At level `k`, the highest of the 2^k x 2^k cells from each cell on, (L, H, W).
        cells: Row and column of the points, by turn, shape (A, N, 2).
        turns: [rad], shape (A,).
        sectors: The number of each turn's sector, shape (A,); each has a best shift of its own.
        keep: What is worth less than this share of the best one is not looked for.
        limits: Largest shift [cells], largest turn [rad], what each of them costs [sum], and what
            the best one is worth at least [sum].
        out: Is filled with the number of the turn and the shift in rows and columns, (S, 3).
        worths: Is filled with the sums, less the costs, shape (S,); low where nothing was found.
    """
    levels, half = len(pyramid), int(limits[0])
    size = 1 << (levels - 1)
    blocks = (2 * half + size) // size
    bounds = np.empty(len(turns) * blocks * blocks)
    for a in range(len(turns)):
        for br in range(blocks):
            for bc in range(blocks):
                bounds[(a * blocks + br) * blocks + bc] = worth_of(
                    pyramid[levels - 1],
                    cells[a],
                    br * size - half,
                    bc * size - half,
                    size,
                    turns[a],
                    limits,
                )
    worths[:] = -1e18
    top = limits[3]
    stack, waiting = np.empty((4 * levels, 3), dtype=np.int64), np.empty(4 * levels)
    for block in np.argsort(-bounds):
        if bounds[block] < keep * top or (len(worths) == 1 and bounds[block] <= top):
            break
        a, br, bc = block // (blocks * blocks), block // blocks % blocks, block % blocks
        sector = sectors[a]
        stack[0, 0], stack[0, 1], stack[0, 2] = levels - 1, br * size - half, bc * size - half
        waiting[0], depth = bounds[block], 1
        while depth > 0:
            depth -= 1
            level, row, column = stack[depth, 0], stack[depth, 1], stack[depth, 2]
            if waiting[depth] <= worths[sector] or waiting[depth] < keep * top:
                continue
            if waiting[depth] < limits[3]:
                continue
            if level == 0:
                worths[sector] = waiting[depth]
                top = max(top, waiting[depth])
                out[sector, 0], out[sector, 1], out[sector, 2] = a, row, column
                continue
            step, first = 1 << (level - 1), depth
            for r in (row, row + step):
                for c in (column, column + step):
                    if r > half or c > half:
                        continue
                    bound = worth_of(pyramid[level - 1], cells[a], r, c, step, turns[a], limits)
                    # the best of the four is looked into first
                    at = depth
                    while at > first and waiting[at - 1] > bound:
                        waiting[at] = waiting[at - 1]
                        stack[at] = stack[at - 1]
                        at -= 1
                    waiting[at] = bound
                    stack[at, 0], stack[at, 1], stack[at, 2] = level - 1, r, c
                    depth += 1
