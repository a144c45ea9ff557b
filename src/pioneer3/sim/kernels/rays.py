# ruff: noqa: PLR0917 (compiled functions take no keywords without a cost)
"""Sonar and single rays: from cell to cell through the grid."""

from math import cos, floor, inf, sin, sqrt

import numpy as np

from pioneer3.arrays import Float, Int32
from pioneer3.jit import inlined, kernel
from pioneer3.sim.kernels.echoes import SHADE
from pioneer3.sim.kernels.robots import FAR, Others, Walls, cells, neighbours
from pioneer3.sim.raycast import TOUCH

EMPTY = 0.1
"""Along the edges of a grid at least this much has no walls [cells]."""

TINY = 1e-300
"""Stands for zero where infinity would make a NaN."""
HUGE = 1e300
"""Stands for the inverse of zero there."""


@inlined
def crossing(along0: float, across0: float, along1: float, across1: float) -> float:
    """Return the range along a ray to a segment that its line meets, or infinity; as the oracle.

    The ends are given by how far along the ray and across it they are.
    """
    across0 = 0.0 if abs(across0) <= TOUCH else across0
    across1 = 0.0 if abs(across1) <= TOUCH else across1
    if across0 == 0.0 and across1 == 0.0:
        found = 0.0 if along0 * along1 <= 0.0 else min(along0, along1)
    else:
        found = along0 + (along1 - along0) * (across0 / (across0 - across1))
    return max(found, 0.0) if found >= -TOUCH else inf


@kernel
def meeting(ax: float, ay: float, bx: float, by: float, dx: float, dy: float) -> float:
    """Return the range from the origin along a ray to a segment, or infinity; as the oracle."""
    across0, across1 = dx * ay - dy * ax, dx * by - dy * bx
    if min(across0, across1) > TOUCH or max(across0, across1) < -TOUCH:
        return inf
    return crossing(dx * ax + dy * ay, across0, dx * bx + dy * by, across1)


@inlined
def _entry(px: float, py: float, dx: float, dy: float, columns: int, rows: int) -> float:
    """Return how far along a ray the grid begins, 0 from inside, infinity where it misses."""
    begin, end = 0.0, inf
    if dx != 0.0:
        one, other = -px / dx, (columns - px) / dx
        begin, end = max(begin, min(one, other)), min(end, max(one, other))
    elif not 0.0 <= px <= columns:
        begin = inf
    if dy != 0.0:
        one, other = -py / dy, (rows - py) / dy
        begin, end = max(begin, min(one, other)), min(end, max(one, other))
    elif not 0.0 <= py <= rows:
        begin = inf
    return begin if begin <= end else inf


@inlined
def walk(
    ox: float, oy: float, dx: float, dy: float, limit: float, steep: float, walls: Walls
) -> tuple[float, float]:
    """Return range to the nearest wall along a ray, and to the nearest that sends an echo back.

    That is one that the ray meets at an angle whose sine is at least `steep`.
    """
    frame, starts, pieces = walls
    columns, rows, per_metre = int(frame[4]), int(frame[5]), frame[3]
    px, py = (ox - frame[0]) * per_metre, (oy - frame[1]) * per_metre
    best, heard, begin, end = limit, limit, 0.0, limit * per_metre
    inside = 0.0 <= px < columns and 0.0 <= py < rows
    if not inside:
        begin = _entry(px, py, dx, dy, columns, rows)
        if begin < FAR:
            px, py, end = px + begin * dx, py + begin * dy, end - begin
    if begin < FAR and end >= 0.0:
        column, row = floor(px), floor(py)
        if not inside:
            column, row = min(max(column, 0), columns - 1), min(max(row, 0), rows - 1)
        each_x = 1.0 / abs(dx) if abs(dx) > TINY else HUGE
        each_y = 1.0 / abs(dy) if abs(dy) > TINY else HUGE
        next_x = (column + 1 - px if dx >= 0 else px - column) * each_x
        next_y = (row + 1 - py if dy >= 0 else py - row) * each_y
        end_x = (columns - px if dx >= 0 else px) * each_x
        end_y = (rows - py if dy >= 0 else py) * each_y
        # the grid is empty along its edges: whatever rounding does, the walk ends inside
        end, leave = min(end, end_x - EMPTY, end_y - EMPTY), 0.0
        sideways, upwards = (1 if dx >= 0 else -1), (columns if dy >= 0 else -columns)
        place = row * columns + column
        while leave <= end:
            for k in range(starts[place], starts[place + 1]):
                ax, ay = pieces[k, 0] - ox, pieces[k, 1] - oy
                bx, by = pieces[k, 2] - ox, pieces[k, 3] - oy
                across0, across1 = dx * ay - dy * ax, dx * by - dy * bx
                if not (across0 > TOUCH < across1 or across0 < -TOUCH > across1):
                    along0, along1 = dx * ax + dy * ay, dx * bx + dy * by
                    found = crossing(along0, across0, along1, across1)
                    if found < best:
                        best, end = found, min(end, found * per_metre - begin)
                    ex, ey, turn = bx - ax, by - ay, across1 - across0
                    if found < heard and turn * turn >= steep * steep * (ex * ex + ey * ey):
                        heard = found
            if next_x < next_y:
                leave, next_x, place = next_x, next_x + each_x, place + sideways
            else:
                leave, next_y, place = next_y, next_y + each_y, place + upwards
    return best, heard


@kernel
def _see_robots(near: int, found: Int32, shapes: Float, count: int, rays: Float) -> None:
    """Shorten the ranges of `count` rays where one of the robots `found` is nearer.

    `rays` has the rows ox, oy, dx, dy, the range, and one for this function's own use.
    """
    corners = shapes.shape[1]
    for j in range(near):
        n = found[j]
        x, y, radius, hits = shapes[n, 0], shapes[n, 1], shapes[n, 2] + TOUCH, 0
        for k in range(count):
            rx, ry = x - rays[0, k], y - rays[1, k]
            along = rays[2, k] * rx + rays[3, k] * ry
            across = abs(rays[2, k] * ry - rays[3, k] * rx)
            apart = max(across, -along, along - rays[4, k]) - radius
            rays[5, k] = apart
            hits += apart <= 0.0
        for k in range(count if hits else 0):
            if rays[5, k] <= 0.0:
                ox, oy, dx, dy, best = rays[0, k], rays[1, k], rays[2, k], rays[3, k], rays[4, k]
                ax, ay = shapes[n, corners - 2] - ox, shapes[n, corners - 1] - oy
                along0, across0 = dx * ax + dy * ay, dx * ay - dy * ax
                for i in range(3, corners, 2):
                    ax, ay = shapes[n, i] - ox, shapes[n, i + 1] - oy
                    along1, across1 = dx * ax + dy * ay, dx * ay - dy * ax
                    if min(across0, across1) <= TOUCH and max(across0, across1) >= -TOUCH:
                        best = min(best, crossing(along0, across0, along1, across1))
                    along0, across0 = along1, across1
                rays[4, k] = best


@kernel
def _nearest_edge(
    ox: float,
    oy: float,
    ax: float,
    ay: float,
    wide: float,
    reach: float,
    edges: Walls,
    walls: Walls,
) -> float:
    """Return the range to the nearest edge in a beam and in sight, or `reach` if that is nearer.

    The beam is given by the sum (ax, ay) of the unit vectors of its outermost rays, and by `wide`,
    what this is along either of them.
    """
    frame, starts, pieces = edges
    columns, rows = int(frame[4]), int(frame[5])
    west, east = cells(ox - reach, ox + reach, frame[0], frame[3])
    south, north = cells(oy - reach, oy + reach, frame[1], frame[3])
    west, east = max(west, 0), min(east, columns - 1)
    south, north = max(south, 0), min(north, rows - 1)
    for row in range(south, north + 1 if west <= east else south):
        for k in range(starts[row * columns + west], starts[row * columns + east + 1]):
            ex, ey = pieces[k, 0] - ox, pieces[k, 1] - oy
            away = sqrt(ex * ex + ey * ey)
            if away < reach and ax * ex + ay * ey >= wide * away:
                sight = max(away - SHADE, 0.0)
                scale = 1.0 / max(away, TOUCH)
                best, _ = walk(ox, oy, ex * scale, ey * scale, sight, 0.0, walls)
                if best >= sight:
                    reach = away
    return reach


@kernel
def sonar(
    first: int,
    last: int,
    limit: float,
    echoes: tuple[float, float],
    poses: Float,
    owners: Int32,
    mounts: tuple[Float, Int32, Int32],
    walls: Walls,
    edges: Walls,
    others: Others,
    out: Float,
) -> None:
    """Fill rows `first` to `last` of `out` with what the transducers of `owners` hear.

    That is the nearest of a transducer's rays that comes back, or of the edges between them. A wall
    met at a smaller angle than that of `steep`, its sine, sends the ray elsewhere; a robot is never
    so smooth. `echoes` are `steep` and how far edges are heard.
    """
    steep, edge_range = echoes
    table, offsets, kinds = mounts
    shapes, per_mount = others[1], (table.shape[1] - 2) // 2
    rays, found = np.empty((7, out.shape[1] * per_mount)), np.empty(len(shapes) + 1, np.int32)
    for n in range(first, last):
        x, y, c, s = poses[0, n], poses[1, n], cos(poses[2, n]), sin(poses[2, n])
        begin, count, reach = offsets[kinds[n]], 0, 0.0
        crowded = len(shapes) > 1 or owners[n] < 0
        for m in range(out.shape[1]):
            out[n, m] = limit
        for m in range(begin, offsets[kinds[n] + 1]):
            mx, my = table[m, 0], table[m, 1]
            ox, oy = x + c * mx - s * my, y + s * mx + c * my
            nearest = back = limit
            for i in range(per_mount):
                # the one in the middle first: what it hears limits the others
                k = 2 + 2 * ((i + per_mount // 2) % per_mount)
                ahead, left = table[m, k], table[m, k + 1]
                dx, dy = c * ahead - s * left, s * ahead + c * left
                # beyond the nearest echo so far the transducer does not listen
                best, heard = walk(ox, oy, dx, dy, nearest, steep, walls)
                if heard <= best + TOUCH:
                    nearest, back = min(nearest, heard), min(back, best)
                if crowded:
                    rays[0, count], rays[1, count], rays[2, count], rays[3, count] = ox, oy, dx, dy
                    rays[4, count] = rays[6, count] = best
                    reach = max(reach, best + abs(ox - x) + abs(oy - y))
                    count += 1
            reached = min(edge_range, nearest)
            if reached > 0.0:
                k = table.shape[1] - 2
                ax, ay = table[m, 2] + table[m, k], table[m, 3] + table[m, k + 1]
                wide = ax * table[m, 2] + ay * table[m, 3]
                ax, ay = c * ax - s * ay, s * ax + c * ay
                edge = _nearest_edge(ox, oy, ax, ay, wide, reached, edges, walls)
                back = min(back, edge) if edge < reached else back
            out[n, m - begin] = back
        near = neighbours(x, y, reach, owners[n], others, found) if crowded else 0
        if near > 0:
            _see_robots(near, found, shapes, count, rays)
            for k in range(count):
                if rays[4, k] < rays[6, k]:
                    out[n, k // per_mount] = min(out[n, k // per_mount], rays[4, k])
