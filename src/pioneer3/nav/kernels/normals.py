"""Directions of walls at the points of a scan."""

from math import sqrt

from pioneer3.arrays import Bool, Float
from pioneer3.jit import inlined, kernel


@kernel
def thinned(points: Float, apart: float, out: Bool) -> None:
    """Mark the points (N, 2) that lie at least `apart` [m] from the one marked before."""
    last = 0
    for i in range(len(points)):
        dx, dy = points[i, 0] - points[last, 0], points[i, 1] - points[last, 1]
        if i == 0 or dx * dx + dy * dy >= apart * apart:
            out[i] = True
            last = i


@inlined
def edge_of(points: Float, i: int, step: int, least: int, reach: float, gap: float) -> int:
    """Return the last neighbour of `i` in one direction that lies on the same thing, if any does.

    It goes on for `least` points, and on as far as `reach` [m] from `i`, until two neighbours are
    farther apart than `gap` [m].
    """
    end = i
    while True:
        after = end + step
        if not 0 <= after < len(points):
            return end
        dx, dy = points[after, 0] - points[end, 0], points[after, 1] - points[end, 1]
        if dx * dx + dy * dy > gap * gap:
            return end
        dx, dy = points[after, 0] - points[i, 0], points[after, 1] - points[i, 1]
        if abs(after - i) > least and dx * dx + dy * dy > reach * reach:
            return end
        end = after


@inlined
def fit_line(points: Float, first: int, last: int) -> tuple[float, float, float, float]:
    """Return the line through points: normal, distance from the origin, and the points' RMS [m]."""
    count = last - first + 1
    mx, my = 0.0, 0.0
    for k in range(first, last + 1):
        mx += points[k, 0]
        my += points[k, 1]
    mx, my = mx / count, my / count
    xx, xy, yy = 0.0, 0.0, 0.0
    for k in range(first, last + 1):
        dx, dy = points[k, 0] - mx, points[k, 1] - my
        xx += dx * dx
        xy += dx * dy
        yy += dy * dy
    # the eigenvector of the smaller eigenvalue
    half, root = (xx - yy) / 2, 0.0
    root = sqrt(half * half + xy * xy)
    low = max(0.0, (xx + yy) / 2 - root)
    if half > 0:
        nx, ny = -xy, half + root
    else:
        nx, ny = root - half, -xy
    size = sqrt(nx * nx + ny * ny)
    if size < 1e-12:
        return 0.0, 0.0, 0.0, 1.0
    nx, ny = nx / size, ny / size
    return nx, ny, nx * mx + ny * my, sqrt(low / count)


@kernel
def normals_of(
    points: Float, origin: Float, least: int, reach: float, rough: float, out: Float
) -> None:
    """Fill `out` (N, 3) with the lines at the points of a scan; zeros where there is none.

    A line is fitted over a point's neighbours on both sides or, where that is not straight, on one.

    Args:
        points: [m], in the order of their directions, shape (N, 2).
        origin: Place of the laser [m].
        least: Neighbours on each side, at least, and all nearer than `reach`.
        reach: [m].
        rough: The points of a wall lie as near to a line as this [m, RMS].
        out: Unit normals, which point to the laser, and how far the points lie off the line to
            that side [m].
    """
    for i in range(len(points)):
        x, y = origin[0] - points[i, 0], origin[1] - points[i, 1]
        away = sqrt(x * x + y * y)
        gap = 0.1 + 0.1 * away
        before = edge_of(points, i, -1, least, reach, gap)
        after = edge_of(points, i, 1, least, reach, gap)
        nx, ny, line, best = 0.0, 0.0, 0.0, rough
        for window in range(3):
            first, last = before, after
            if window == 1:
                last = i
            elif window == 2:
                first = i
            if last - first < 2 + (window > 0):
                continue
            fx, fy, along, rms = fit_line(points, first, last)
            if rms < best:
                nx, ny, line, best = fx, fy, along, rms
                if window == 0:
                    break
        side = 1.0 if nx * x + ny * y >= 0 else -1.0
        out[i, 0], out[i, 1] = side * nx, side * ny
        out[i, 2] = side * (nx * points[i, 0] + ny * points[i, 1] - line)
