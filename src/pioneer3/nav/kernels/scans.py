"""How well scans fit the walls of a map, and the poses at which they fit best."""

from math import atan2, cos, floor, pi, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from pioneer3.jit import inlined, kernel

Float = NDArray[np.float64]
Float32 = NDArray[np.float32]
Int32 = NDArray[np.int32]

BACK = 5
"""Cells before the end of a beam where the face that it met is sought."""


@inlined
def value_at(field: Float32, x: float, y: float, outside: float) -> float:
    """Return the value of the cell around a point, in cells from the lower left corner."""
    row, column = floor(y), floor(x)
    if 0 <= row < field.shape[0] and 0 <= column < field.shape[1]:
        return float(field[row, column])
    return outside


@kernel
def number_walls(
    walls: Float, x0: float, y0: float, cell: float, distances: Float32, out: Int32
) -> None:
    """Fill `out` (H, W) with the number of the wall nearest to each cell's middle.

    Cells farther from all walls than the reach of `distances` keep their number.

    Args:
        walls: Segments [m], shape (N, 4).
        x0: Left edge of the raster [m].
        y0: Lower edge [m].
        cell: Side of a cell [m].
        distances: From the middles of cells to the nearest wall [m], shape (H, W).
        out: Numbers of walls.
    """
    height, width = out.shape
    reach = float(distances.max())
    for i in range(len(walls)):
        ax, ay, bx, by = walls[i, 0], walls[i, 1], walls[i, 2], walls[i, 3]
        left = max(0, floor((min(ax, bx) - reach - x0) / cell))
        right = min(width - 1, floor((max(ax, bx) + reach - x0) / cell))
        low = max(0, floor((min(ay, by) - reach - y0) / cell))
        high = min(height - 1, floor((max(ay, by) + reach - y0) / cell))
        dx, dy = bx - ax, by - ay
        squared = dx * dx + dy * dy
        for row in range(low, high + 1):
            y = y0 + (row + 0.5) * cell
            for column in range(left, right + 1):
                nearest = float(distances[row, column])
                if nearest >= reach:
                    continue
                x = x0 + (column + 0.5) * cell
                share = 0.0
                if squared > 0.0:
                    share = ((x - ax) * dx + (y - ay) * dy) / squared
                    share = min(1.0, max(0.0, share))
                off_x, off_y = x - ax - share * dx, y - ay - share * dy
                if sqrt(off_x * off_x + off_y * off_y) <= nearest + 1e-6:
                    out[row, column] = i


@kernel
def weigh_poses(
    distances: Float32,
    frame: tuple[float, float, float],
    points: Float,
    poses: Float,
    sigma: float,
    most: float,
    out: Float,
) -> None:
    """Fill `out` (P,) with the sum over the points of half the square of distance over sigma.

    Args:
        distances: To the nearest wall [m], shape (H, W).
        frame: Left and lower edge of the raster, and the side of a cell [m].
        points: In the robot's frame [m], shape (N, 2).
        poses: Of the robot on the map [m, rad], shape (P, 3).
        sigma: Standard deviation of a point [m].
        most: Distances above this count as this [m].
        out: For the sums.
    """
    x0, y0, cell = frame
    factor = 0.5 / (sigma * sigma)
    for p in range(len(poses)):
        c, s = cos(poses[p, 2]) / cell, sin(poses[p, 2]) / cell
        x, y = (poses[p, 0] - x0) / cell, (poses[p, 1] - y0) / cell
        total = 0.0
        for i in range(len(points)):
            u, v = points[i, 0], points[i, 1]
            off = min(most, value_at(distances, x + c * u - s * v, y + s * u + c * v, most))
            total += off * off
        out[p] = factor * total


@inlined
def solve3(a: Float, b: Float, out: Float) -> None:
    """Fill `out` (3,) with the solution of `a` (3, 3), symmetric and positive definite, and `b`."""
    d0 = a[0, 0]
    l10, l20 = a[1, 0] / d0, a[2, 0] / d0
    d1 = a[1, 1] - l10 * l10 * d0
    l21 = (a[2, 1] - l20 * l10 * d0) / d1
    d2 = a[2, 2] - l20 * l20 * d0 - l21 * l21 * d1
    y0 = b[0]
    y1 = b[1] - l10 * y0
    y2 = b[2] - l20 * y0 - l21 * y1
    out[2] = y2 / d2
    out[1] = y1 / d1 - l21 * out[2]
    out[0] = y0 / d0 - l10 * out[1] - l20 * out[2]


@inlined
def facing_wall(
    numbers: Int32, facing: Float, x: float, y: float, dx: float, dy: float, steps: int
) -> int:
    """Return the wall nearest to a point among those that a beam may have met, -1 without any.

    A point behind the face of a thick wall is near to the wall's other face, too. The face that
    was met is before it.

    Args:
        numbers: The wall nearest to each cell, -1 where there is none, shape (H, W).
        facing: The free side of walls, (0, 0) where both are, shape (N, 2).
        x: Of the point [cells].
        y: The same.
        dx: Direction of the beam, of length 1.
        dy: The same.
        steps: Cells to go back along the beam.
    """
    height, width = numbers.shape
    for back in range(steps + 1):
        column, row = floor(x - back * dx), floor(y - back * dy)
        if 0 <= row < height and 0 <= column < width:
            wall = numbers[row, column]
            if wall < 0:
                return -1
            if facing[wall, 0] * dx + facing[wall, 1] * dy <= 0.0:
                return int(wall)
    return -1


@kernel
def refine_poses(
    walls: Float,
    facing: Float,
    numbers: Int32,
    frame: tuple[float, float, float],
    points: Float,
    origin: Float,
    poses: Float,
    information: Float,
    sigma: float,
    scales: Float,
    out: Float,
) -> None:
    """Move each of `poses` (P, 3) to where points lie on walls, starting from there.

    Gauss-Newton from points to lines, one step for each of `scales`, with Geman and McClure's
    weights. The poses at the start are held by `information`.

    Args:
        walls: Segments [m], shape (W, 4).
        facing: Their free sides, (0, 0) where both are, shape (W, 2).
        numbers: The wall nearest to each cell, -1 where there is none, shape (H, W).
        frame: Left and lower edge of the raster, and the side of a cell [m].
        points: In the robot's frame [m], shape (N, 2).
        origin: Of the beams in the same frame [m], shape (2,).
        poses: Of the robot on the map [m, rad].
        information: Of the poses at the start, shape (3, 3).
        sigma: Standard deviation of a point as it counts here [m].
        scales: Distances at which points lose three quarters of their weight [m], shape (S,).
        out: For the information of the poses at the end, shape (P, 3, 3).
    """
    x0, y0, cell = frame
    start, b, step = np.empty(3), np.empty(3), np.empty(3)
    a = np.empty((3, 3))
    for p in range(len(poses)):
        start[:] = poses[p]
        for number in range(len(scales)):
            scale = scales[number] * scales[number]
            c, s = cos(poses[p, 2]), sin(poses[p, 2])
            turned = poses[p, 2] - start[2]
            off = poses[p, 0] - start[0], poses[p, 1] - start[1], turned
            for i in range(3):
                b[i] = 0.0
                for j in range(3):
                    a[i, j] = information[i, j]
                    b[i] -= information[i, j] * off[j]
            for i in range(len(points)):
                u = c * points[i, 0] - s * points[i, 1]
                v = s * points[i, 0] + c * points[i, 1]
                x, y = poses[p, 0] + u, poses[p, 1] + v
                bx, by = u - c * origin[0] + s * origin[1], v - s * origin[0] - c * origin[1]
                length = sqrt(bx * bx + by * by)
                if length <= 0.0:
                    continue
                wall = facing_wall(
                    numbers,
                    facing,
                    (x - x0) / cell,
                    (y - y0) / cell,
                    bx / length,
                    by / length,
                    BACK,
                )
                if wall < 0:
                    continue
                ax, ay = walls[wall, 0], walls[wall, 1]
                dx, dy = walls[wall, 2] - ax, walls[wall, 3] - ay
                squared = dx * dx + dy * dy
                if squared <= 0.0:
                    continue
                share = min(1.0, max(0.0, ((x - ax) * dx + (y - ay) * dy) / squared))
                ex, ey = x - ax - share * dx, y - ay - share * dy
                distance = sqrt(ex * ex + ey * ey)
                if distance > 1e-9:
                    ex, ey = ex / distance, ey / distance
                else:
                    length = sqrt(squared)
                    ex, ey = -dy / length, dx / length
                weight = scale / (scale + distance * distance)
                weight = weight * weight / (sigma * sigma)
                et = ey * u - ex * v
                a[0, 0] += weight * ex * ex
                a[1, 0] += weight * ey * ex
                a[1, 1] += weight * ey * ey
                a[2, 0] += weight * et * ex
                a[2, 1] += weight * et * ey
                a[2, 2] += weight * et * et
                b[0] -= weight * distance * ex
                b[1] -= weight * distance * ey
                b[2] -= weight * distance * et
            a[0, 1], a[0, 2], a[1, 2] = a[1, 0], a[2, 0], a[2, 1]
            solve3(a, b, step)
            for i in range(3):
                poses[p, i] += step[i]
        turned = poses[p, 2]
        if turned > pi or turned <= -pi:
            poses[p, 2] = atan2(sin(turned), cos(turned))
        out[p] = a


@inlined
def way_to_wall(
    distances: Float32, x: float, y: float, dx: float, dy: float, most: float, reach: float
) -> float:
    """Return how far it is to a wall along a ray, at most `most`; all in cells.

    Args:
        distances: To the nearest wall, in meters, shape (H, W).
        x: Where the ray starts.
        y: The same.
        dx: Its direction, of length 1.
        dy: The same.
        most: The longest way.
        reach: Meters in a cell, inverted: cells in a meter.
    """
    gone = 0.0
    while gone < most:
        away = reach * value_at(distances, x + gone * dx, y + gone * dy, 1e3)
        if away < 0.8:
            return gone
        gone += max(0.5, away - 0.75)
    return most


@kernel
def judge_poses(
    distances: Float32,
    frame: tuple[float, float, float],
    points: Float,
    clear: Float,
    origin: Float,
    poses: Float,
    limits: tuple[float, float, float],
    out: Float,
) -> None:
    """Count the beams that agree with the map at each of `poses` (P, 3), and the others.

    Args:
        distances: To the nearest wall [m], shape (H, W).
        frame: Left and lower edge of the raster, and the side of a cell [m].
        points: Echoes in the robot's frame [m], shape (N, 2).
        clear: Ends of the part of other beams that is to be free, shape (M, 2).
        origin: Of all beams, shape (2,).
        poses: Of the robot on the map [m, rad].
        limits: A point agrees within this of a wall [m], or this share of its range; a beam is
            through a wall that is so much nearer [m].
        out: Per pose the numbers of beams that agree, that are shorter than on the map, that go
            through walls, and the mean square of the distances of those that agree, as a share of
            the limit; shape (P, 4).
    """
    x0, y0, cell = frame
    near, share, deep = limits
    for p in range(len(poses)):
        c, s = cos(poses[p, 2]), sin(poses[p, 2])
        ox = poses[p, 0] + c * origin[0] - s * origin[1]
        oy = poses[p, 1] + s * origin[0] + c * origin[1]
        agree, short, through, misfit = 0.0, 0.0, 0.0, 0.0
        for i in range(len(points) + len(clear)):
            echo = i < len(points)
            u, v = 0.0, 0.0
            if echo:
                u, v = points[i, 0], points[i, 1]
            else:
                u, v = clear[i - len(points), 0], clear[i - len(points), 1]
            dx = poses[p, 0] + c * u - s * v - ox
            dy = poses[p, 1] + s * u + c * v - oy
            length = sqrt(dx * dx + dy * dy)
            if length < cell:
                continue
            free = max(0.0, length - deep) / cell
            gone = way_to_wall(
                distances,
                (ox - x0) / cell,
                (oy - y0) / cell,
                dx / length,
                dy / length,
                free,
                1.0 / cell,
            )
            if gone < free:
                through += 1.0
            elif echo:
                x, y = (ox + dx - x0) / cell, (oy + dy - y0) / cell
                off = value_at(distances, x, y, 1e3) / max(near, share * length)
                if off <= 1.0:
                    agree += 1.0
                    misfit += off * off
                else:
                    short += 1.0
        out[p, 0], out[p, 1], out[p, 2] = agree, short, through
        out[p, 3] = misfit / max(1.0, agree)
