"""How well scans fit the walls of a map, and the poses at which they fit best."""

from math import atan2, cos, floor, pi, sin, sqrt

import numpy as np

from pioneer3.arrays import Float, Float32, Int32
from pioneer3.jit import inlined, kernel
from pioneer3.nav.kernels.fields import Frame, distance_to

Point = tuple[float, float]
Surface = tuple[Float, Float32, Int32, Frame]
"""Walls, segments [m], shape (W, 4); distances to the nearest one less the longest [m], shape
(H, W); its number from 1 on, 0 where none is near, shape (H, W); the frame of these cells."""

BACK_CELLS = 5
"""Cells before the end of a beam where the face that it met is sought."""


@inlined
def distance_at(field: Float32, reach: float, x: float, y: float, outside: float) -> float:
    """Return the distance in the cell around a point, in cells from the lower left corner [m]."""
    row, column = floor(y), floor(x)
    if 0 <= row < field.shape[0] and 0 <= column < field.shape[1]:
        return reach + float(field[row, column])
    return outside


@kernel
def number_walls(walls: Float, frame: Frame, distances: Float32, out: Int32) -> None:
    """Fill `out` (H, W) with the number of the wall nearest to each cell's middle, from 1 on.

    Cells farther from all walls (N, 4) [m] than the longest of their `distances` keep their number.
    """
    x0, y0, cell, reach = frame
    height, width = out.shape
    for i in range(len(walls)):
        ax, ay, bx, by = walls[i, 0], walls[i, 1], walls[i, 2], walls[i, 3]
        left = max(0, floor((min(ax, bx) - reach - x0) / cell))
        right = min(width - 1, floor((max(ax, bx) + reach - x0) / cell))
        low = max(0, floor((min(ay, by) - reach - y0) / cell))
        high = min(height - 1, floor((max(ay, by) + reach - y0) / cell))
        for row in range(low, high + 1):
            y = y0 + (row + 0.5) * cell
            for column in range(left, right + 1):
                nearest = float(distances[row, column])
                if nearest >= 0.0:
                    continue
                x = x0 + (column + 0.5) * cell
                if distance_to(walls[i], x, y) - reach <= nearest + 1e-6:
                    out[row, column] = i + 1


@kernel
def weigh_poses(
    field: tuple[Float32, Frame], points: Float, poses: Float, limits: Point, out: Float
) -> None:
    """Fill `out` (P,) with the sum over the points of half the square of distance over sigma.

    The `field` has the distances of a :data:`Surface` and their frame; points (N, 2) are in the
    robot's frame [m], at `poses` (P, 3) on the map [m, rad]. `limits` are sigma, and the distance
    that larger ones count as [m].
    """
    distances, (x0, y0, cell, reach) = field
    sigma, most = limits
    factor = 0.5 / (sigma * sigma)
    for p in range(len(poses)):
        c, s = cos(poses[p, 2]) / cell, sin(poses[p, 2]) / cell
        x, y = (poses[p, 0] - x0) / cell, (poses[p, 1] - y0) / cell
        total = 0.0
        for i in range(len(points)):
            u, v = points[i, 0], points[i, 1]
            to_x, to_y = x + c * u - s * v, y + s * u + c * v
            off = min(most, distance_at(distances, reach, to_x, to_y, most))
            total += off * off
        out[p] = factor * total


@kernel
def step_of(sums: Float, out: Float) -> None:
    """Fill `out` (3,) with the step that normal equations ask for [m, rad].

    Of these, `sums` (9,) are the lower half of the matrix, row by row, and the right side.
    """
    d0 = sums[0]
    l10, l20 = sums[1] / d0, sums[3] / d0
    d1 = sums[2] - l10 * l10 * d0
    l21 = (sums[4] - l20 * l10 * d0) / d1
    d2 = sums[5] - l20 * l20 * d0 - l21 * l21 * d1
    y0 = sums[6]
    y1 = sums[7] - l10 * y0
    y2 = sums[8] - l20 * y0 - l21 * y1
    out[2] = y2 / d2
    out[1] = y1 / d1 - l21 * out[2]
    out[0] = y0 / d0 - l10 * out[1] - l20 * out[2]


@kernel
def facing_wall(numbers: Int32, facing: Float, at: Point, along: Point) -> int:
    """Return the wall nearest to a point among those that a beam may have met, -1 without any.

    A point behind the face of a thick wall is near to the wall's other face, too. The face that
    was met is before it, `along` the beam. `facing` has the free side of each wall, (0, 0) where
    both are, shape (N, 2); the point is in cells.
    """
    height, width = numbers.shape
    for back in range(BACK_CELLS + 1):
        column, row = floor(at[0] - back * along[0]), floor(at[1] - back * along[1])
        if 0 <= row < height and 0 <= column < width:
            wall = int(numbers[row, column]) - 1
            if wall < 0:
                return -1
            if facing[wall, 0] * along[0] + facing[wall, 1] * along[1] <= 0.0:
                return wall
    return -1


@kernel
def off_wall(walls: Float, wall: int, x: float, y: float) -> tuple[float, float, float]:
    """Return the direction (2) from the nearest point of a wall to a point, and how far it is."""
    ax, ay = walls[wall, 0], walls[wall, 1]
    dx, dy = walls[wall, 2] - ax, walls[wall, 3] - ay
    squared = max(1e-18, dx * dx + dy * dy)
    share = min(1.0, max(0.0, ((x - ax) * dx + (y - ay) * dy) / squared))
    ex, ey = x - ax - share * dx, y - ay - share * dy
    distance = sqrt(ex * ex + ey * ey)
    if distance > 1e-9:
        return ex / distance, ey / distance, distance
    length = sqrt(squared)
    return -dy / length, dx / length, 0.0


@kernel
def add_points(
    surface: tuple[Float, Float, Int32, Frame],
    beams: tuple[Float, Float],
    pose: tuple[float, float, float],
    spread: Point,
    sums: Float,
) -> None:
    """Add the points of a scan to the normal equations `sums` of :func:`step_of`.

    Surface and beams are those of :func:`refine_poses`; `spread` is the standard deviation of a
    point, and the distance where it loses its weight [m].
    """
    walls, facing, numbers, (x0, y0, cell, _) = surface
    points, origin = beams
    variance, scale = spread[0] * spread[0], spread[1] * spread[1]
    c, s = cos(pose[2]), sin(pose[2])
    ox, oy = c * origin[0] - s * origin[1], s * origin[0] + c * origin[1]
    a0, a1, a2, a3, a4, a5, b0, b1, b2 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(len(points)):
        u = c * points[i, 0] - s * points[i, 1]
        v = s * points[i, 0] + c * points[i, 1]
        length = sqrt((u - ox) * (u - ox) + (v - oy) * (v - oy))
        if length <= 0.0:
            continue
        x, y = pose[0] + u, pose[1] + v
        at, along = ((x - x0) / cell, (y - y0) / cell), ((u - ox) / length, (v - oy) / length)
        wall = facing_wall(numbers, facing, at, along)
        if wall < 0:
            continue
        ex, ey, off = off_wall(walls, wall, x, y)
        et = ey * u - ex * v
        weight = scale / (scale + off * off)
        weight = weight * weight / variance
        a0, a1, a2 = a0 + weight * ex * ex, a1 + weight * ey * ex, a2 + weight * ey * ey
        a3, a4, a5 = a3 + weight * et * ex, a4 + weight * et * ey, a5 + weight * et * et
        weight *= off
        b0, b1, b2 = b0 - weight * ex, b1 - weight * ey, b2 - weight * et
    sums[0], sums[1], sums[2] = sums[0] + a0, sums[1] + a1, sums[2] + a2
    sums[3], sums[4], sums[5] = sums[3] + a3, sums[4] + a4, sums[5] + a5
    sums[6], sums[7], sums[8] = sums[6] + b0, sums[7] + b1, sums[8] + b2


@kernel
def refine_poses(
    surface: tuple[Float, Float, Int32, Frame],
    beams: tuple[Float, Float],
    poses: Float,
    prior: tuple[Float, float, Float],
    out: Float,
) -> None:
    """Move each of `poses` (P, 3) to where points lie on walls, starting from there.

    Gauss-Newton from points to lines, with Geman and McClure's weights.

    Args:
        surface: Walls, segments [m], shape (W, 4); their free sides, (0, 0) where both are, shape
            (W, 2); the wall nearest to each cell from 1 on, 0 where there is none, shape (H, W);
            the frame of these cells.
        beams: Points in the robot's frame [m], shape (N, 2); their origin there, shape (2,).
        poses: Of the robot on the map [m, rad].
        prior: Information of the poses at the start, shape (3, 3); standard deviation of a point
            as it counts here [m]; for each step the distance at which points lose three quarters
            of their weight [m], shape (S,).
        out: For the information of the poses at the end, shape (P, 3, 3).
    """
    information, sigma, scales = prior
    step, sums = np.empty(3), np.empty(9)
    for p in range(len(poses)):
        x, y, theta = poses[p, 0], poses[p, 1], poses[p, 2]
        for number in range(len(scales)):
            dx, dy, turn = poses[p, 0] - x, poses[p, 1] - y, poses[p, 2] - theta
            at = 0
            for i in range(3):
                for j in range(i + 1):
                    sums[at] = information[i, j]
                    at += 1
                sums[6 + i] = -(
                    information[i, 0] * dx + information[i, 1] * dy + information[i, 2] * turn
                )
            pose = poses[p, 0], poses[p, 1], poses[p, 2]
            add_points(surface, beams, pose, (sigma, scales[number]), sums)
            step_of(sums, step)
            for i in range(3):
                poses[p, i] += step[i]
        if poses[p, 2] > pi or poses[p, 2] <= -pi:
            poses[p, 2] = atan2(sin(poses[p, 2]), cos(poses[p, 2]))
        at = 0
        for i in range(3):
            for j in range(i + 1):
                out[p, i, j] = sums[at]
                out[p, j, i] = sums[at]
                at += 1


@inlined
def way_to_wall(distances: Float32, at: Point, along: Point, most: float, frame: Frame) -> float:
    """Return the way to a wall from `at`, `along` a ray of length 1, at `most` so far [cells].

    The `distances` (H, W) are those of a :data:`Surface`, in a `frame`.
    """
    gone, per_meter = 0.0, 1.0 / frame[2]
    while gone < most:
        x, y = at[0] + gone * along[0], at[1] + gone * along[1]
        away = per_meter * distance_at(distances, frame[3], x, y, 1e3)
        if away < 0.8:
            return gone
        gone += max(0.5, away - 0.75)
    return most


@inlined
def crossing(wall: Float, x: float, y: float, along: Point) -> float:
    """Return how far a wall (4,) is along a ray from (x, y); -1e9 where the ray passes its ends."""
    wx, wy = wall[2] - wall[0], wall[3] - wall[1]
    sine = along[0] * wy - along[1] * wx
    if sine == 0.0:
        return -1e9
    ax, ay = wall[0] - x, wall[1] - y
    share = (ax * along[1] - ay * along[0]) / sine
    if share < 0.0 or share > 1.0:
        return -1e9
    return float((ax * wy - ay * wx) / sine)


@inlined
def is_free(surface: Surface, x: float, y: float, along: Point, most: float) -> bool:
    """Return whether a ray from (x, y) crosses no wall on a way of `most` [m].

    A wall that the ray passes closely is none that it crosses.
    """
    walls, distances, numbers, (x0, y0, cell, reach) = surface
    gone = 0.0
    while gone < most:
        u, v = (x + gone * along[0] - x0) / cell, (y + gone * along[1] - y0) / cell
        away = distance_at(distances, reach, u, v, 1e3)
        if away < 0.8 * cell:
            number = numbers[floor(v), floor(u)] - 1
            if number >= 0:
                at = crossing(walls[number], x, y, along)
                if max(0.0, gone - 2.0 * cell) < at < min(most, gone + 2.0 * cell):
                    return False
        gone += max(0.5 * cell, away - 0.75 * cell)
    return True


@kernel
def judge_poses(
    surface: Surface,
    beams: tuple[Float, Float, Float],
    poses: Float,
    limits: tuple[float, float, float],
    out: Float,
) -> None:
    """Count the beams that agree with the map at each of `poses` (P, 3), and the others.

    An echo at a wall agrees, whatever is in front of that on the map: things are carried off.

    Args:
        surface: The map.
        beams: Echoes in the robot's frame [m], shape (N, 2); ends of the part of other beams that
            is to be free, shape (M, 2); the origin of all, shape (2,).
        poses: Of the robot on the map [m, rad].
        limits: A point agrees within this of a wall [m], or this share of its range; a beam is
            through a wall that is so much nearer [m].
        out: Per pose the numbers of beams that agree, that are shorter than on the map, that go
            through walls to nowhere, and the mean square of the distances of those that agree, as a
            share of the limit; shape (P, 4).
    """
    _, distances, _, (x0, y0, cell, reach) = surface
    points, clear, origin = beams
    near, share, deep = limits
    for p in range(len(poses)):
        c, s = cos(poses[p, 2]), sin(poses[p, 2])
        ox = poses[p, 0] + c * origin[0] - s * origin[1]
        oy = poses[p, 1] + s * origin[0] + c * origin[1]
        agree, short, through, misfit = 0.0, 0.0, 0.0, 0.0
        for i in range(len(points) + len(clear)):
            u, v = 0.0, 0.0
            if i < len(points):
                u, v = points[i, 0], points[i, 1]
            else:
                u, v = clear[i - len(points), 0], clear[i - len(points), 1]
            dx = poses[p, 0] + c * u - s * v - ox
            dy = poses[p, 1] + s * u + c * v - oy
            length = sqrt(dx * dx + dy * dy)
            if length < cell:
                continue
            off = 2.0
            if i < len(points):
                x, y = (ox + dx - x0) / cell, (oy + dy - y0) / cell
                off = distance_at(distances, reach, x, y, 1e3) / max(near, share * length)
            if off <= 1.0:
                agree += 1.0
                misfit += off * off
            elif not is_free(surface, ox, oy, (dx / length, dy / length), length - deep):
                through += 1.0
            elif i < len(points):
                short += 1.0
        out[p, 0], out[p, 1], out[p, 2] = agree, short, through
        out[p, 3] = misfit / max(1.0, agree)
