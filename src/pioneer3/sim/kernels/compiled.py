# ruff: noqa: PLR0917 (compiled functions take no keywords without a cost)
"""The loops that numba compiles. Each runs over robots `first` to `last`, so threads can share.

All in one file on purpose: numba compiles anew when the file of the function called has changed,
and does not notice a change in the file of one that it calls.

Names: a ray starts at (ox, oy) and runs along the unit vector (dx, dy); (ax, ay) and (bx, by) are
the ends of a segment; lattice units are cells. Arrays are those of Grid, Robots, Mounts and Fan.
"""

from math import ceil, cos, floor, hypot, inf, pi, sin, sqrt, tau

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.collision import TOUCH as DEEP
from pioneer3.sim.kernels.jit import compiled, inlined
from pioneer3.sim.kernels.walls import SLACK
from pioneer3.sim.raycast import TOUCH

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]
Int32 = NDArray[np.int32]

Walls = tuple[Float, Int32, Float]
"""Of a Grid: frame, cell_start, pieces."""

Others = tuple[Float, Float, Int32, Int32]
"""Of Robots: box, shapes, cell_start, cell_items."""

CLOSE = 1e-3
"""A segment's end or line this close to a laser is measured beam by beam [m]."""

MARGIN = 5e-5
"""Beams this close to a segment's end are measured one by one; above the error of _angle [rad]."""

EMPTY = 0.1
"""Along the edges of a grid at least this much has no walls [cells]."""

FAR = 1e9
"""From further away a ray does not find the grid [cells]; rounding would lose its way."""

HUGE = 1e300
"""Stands for the inverse of zero where infinity would make a NaN."""


@compiled
def _meeting(ax: float, ay: float, bx: float, by: float, dx: float, dy: float) -> float:
    """Return the range from the origin along a ray to a segment, or infinity; as the oracle."""
    across0, across1 = dx * ay - dy * ax, dx * by - dy * bx
    if min(across0, across1) > TOUCH or max(across0, across1) < -TOUCH:
        return inf
    along0, along1 = dx * ax + dy * ay, dx * bx + dy * by
    if abs(across0) <= TOUCH:
        across0 = 0.0
    if abs(across1) <= TOUCH:
        across1 = 0.0
    if across0 == 0.0 and across1 == 0.0:
        found = 0.0 if along0 * along1 <= 0.0 else min(along0, along1)
    else:
        found = along0 + (along1 - along0) * (across0 / (across0 - across1))
    return max(found, 0.0) if found >= -TOUCH else inf


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
def _walk(ox: float, oy: float, dx: float, dy: float, limit: float, walls: Walls) -> float:
    """Return the range along a ray to the walls: cell by cell, no further than the nearest hit."""
    frame, starts, pieces = walls
    columns, rows, per_metre = int(frame[4]), int(frame[5]), frame[3]
    px, py = (ox - frame[0]) * per_metre, (oy - frame[1]) * per_metre
    best, begin, end = limit, 0.0, limit * per_metre
    if not (0.0 <= px < columns and 0.0 <= py < rows):
        begin = _entry(px, py, dx, dy, columns, rows)
        px, py, end = px + begin * dx, py + begin * dy, end - begin
    if begin < FAR and end >= 0.0:
        column, row = min(max(floor(px), 0), columns - 1), min(max(floor(py), 0), rows - 1)
        each_x, each_y = min(1.0 / abs(dx), HUGE), min(1.0 / abs(dy), HUGE)
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
                if min(across0, across1) <= TOUCH and max(across0, across1) >= -TOUCH:
                    best = min(best, _meeting(ax, ay, bx, by, dx, dy))
                    end = min(end, best * per_metre - begin)
            leave = min(next_x, next_y)
            goes_x = next_x < next_y
            place += sideways if goes_x else upwards
            next_x += each_x if goes_x else 0.0
            next_y += 0.0 if goes_x else each_y
    return best


@inlined
def _cells(low: float, high: float, edge: float, per_metre: float) -> tuple[int, int]:
    """Return the first and last column (or row) of an interval; far away, merely outside."""
    first = floor(min(max((low - edge) * per_metre, -FAR), FAR))
    return first, floor(min(max((high - edge) * per_metre, -FAR), FAR))


@inlined
def _place(x: float, y: float, per_metre: float, mask: int) -> int:
    """Return where a point's cell is in the table."""
    column, _ = _cells(x, x, 0.0, per_metre)
    row, _ = _cells(y, y, 0.0, per_metre)
    return (row & mask) * (mask + 1) + (column & mask)


@compiled
def _neighbours(x: float, y: float, reach: float, skip: int, others: Others, found: Int32) -> int:
    """Fill `found` with the robots, but not `skip`, within `reach`; return how many."""
    box, shapes, places, items = others
    side, per_metre, wide, count = int(box[5]), box[6], reach + box[4] + SLACK, 0
    west, east = _cells(max(x - wide, box[0]), min(x + wide, box[2]), 0.0, per_metre)
    south, north = _cells(max(y - wide, box[1]), min(y + wide, box[3]), 0.0, per_metre)
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


@compiled
def _see_robots(near: int, found: Int32, shapes: Float, count: int, rays: Float) -> None:
    """Shorten the ranges of `count` rays where one of the robots `found` is nearer.

    `rays` has the rows ox, oy, dx, dy, the range, and one for this function's own use.
    """
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
                ox, oy, dx, dy = rays[0, k], rays[1, k], rays[2, k], rays[3, k]
                ax, ay = shapes[n, 9] - ox, shapes[n, 10] - oy
                for i in range(3, 11, 2):
                    bx, by = shapes[n, i] - ox, shapes[n, i + 1] - oy
                    rays[4, k] = min(rays[4, k], _meeting(ax, ay, bx, by, dx, dy))
                    ax, ay = bx, by


@compiled
def sonar(
    first: int,
    last: int,
    limit: float,
    poses: Float,
    owners: Int32,
    mounts: tuple[Float, Int32, Int32],
    walls: Walls,
    others: Others,
    out: Float,
) -> None:
    """Fill rows `first` to `last` of `out` with the nearest range of each transducer's rays."""
    table, offsets, kinds = mounts
    shapes, per_mount = others[1], (table.shape[1] - 2) // 2
    rays, found = np.empty((6, out.shape[1] * per_mount)), np.empty(len(shapes) + 1, np.int32)
    for n in range(first, last):
        x, y, c, s = poses[0, n], poses[1, n], cos(poses[2, n]), sin(poses[2, n])
        begin, count, reach = offsets[kinds[n]], 0, 0.0
        for m in range(begin, offsets[kinds[n] + 1]):
            mx, my = table[m, 0], table[m, 1]
            ox, oy = x + c * mx - s * my, y + s * mx + c * my
            for k in range(2, 2 + 2 * per_mount, 2):
                dx, dy = (
                    c * table[m, k] - s * table[m, k + 1],
                    s * table[m, k] + c * table[m, k + 1],
                )
                best = _walk(ox, oy, dx, dy, limit, walls)
                rays[0, count], rays[1, count], rays[2, count], rays[3, count] = ox, oy, dx, dy
                rays[4, count] = best
                reach = max(reach, best + abs(ox - x) + abs(oy - y))
                count += 1
        near = (
            _neighbours(x, y, reach, owners[n], others, found)
            if len(shapes) > 1 or owners[n] < 0
            else 0
        )
        if near > 0:
            _see_robots(near, found, shapes, count, rays)
        out[n, :] = limit
        for k in range(count):
            out[n, k // per_mount] = min(out[n, k // per_mount], rays[4, k])


@inlined
def _angle(x: float, y: float) -> float:
    """Return atan2(y, x) within 1.2e-5 rad (Abramowitz and Stegun 4.4.49), in (-pi, pi]."""
    ax, ay = abs(x), abs(y)
    t = min(ax, ay) / max(ax, ay)
    u = t * t
    a = t * (0.9998660 + u * (-0.3302995 + u * (0.1801410 + u * (-0.0851330 + u * 0.0208351))))
    if ay > ax:
        a = pi / 2 - a
    if x < 0:
        a = pi - a
    return -a if y < 0 else a


@compiled
def _paint_slowly(seen: Float, i: int, first: int, last: int, headings: Float, out: Float) -> None:
    """Measure a segment along beams `first` to `last`, one by one, into `out` [1/m]."""
    ax, ay, bx, by = seen[0, i], seen[1, i], seen[2, i], seen[3, i]
    for k in range(max(first, 0), min(last + 1, len(out))):
        out[k] = max(out[k], 1.0 / _meeting(ax, ay, bx, by, headings[0, k], headings[1, k]))


@compiled
def _plan(count: int, seen: Float, limit: float, start: float, step: float, plan: Float) -> None:
    """Compute what painting needs: no branches, so that the processor does several at once.

    Rows of `plan`: first beam, a whole number of turns back where that is still before the fan;
    how many beams wide, infinite where all are to be measured one by one, negative if none; then
    the inverse range per cosine and per sine of a beam: an inverse range is linear in these.
    """
    margin, circle = MARGIN / step, tau / step
    for i in range(count):
        ax, ay, bx, by = seen[0, i], seen[1, i], seen[2, i], seen[3, i]
        turn = ax * by - ay * bx
        flip = turn < 0
        ax, bx = (bx, ax) if flip else (ax, bx)
        ay, by = (by, ay) if flip else (ay, by)
        turn = abs(turn)
        ex, ey = bx - ax, by - ay
        squared = ex * ex + ey * ey
        low = _angle(ax, ay)
        span = _angle(bx, by) - low
        span = (span if span >= 0 else span + tau) / step
        low = (low - start) / step
        close = turn * turn <= CLOSE * CLOSE * squared
        close |= min(ax * ax + ay * ay, bx * bx + by * by) < CLOSE * CLOSE
        span = -1.0 if turn * turn > limit * limit * squared else span
        plan[0, i] = low - np.floor((low + span + margin) / circle) * circle
        plan[1, i] = inf if close else span
        plan[2, i], plan[3, i] = ey / turn, -ex / turn


@compiled
def _paint(
    count: int,
    seen: Float,
    plan: Float,
    limit: float,
    start: float,
    step: float,
    headings: Float,
    out: Float,
) -> None:
    """Rasterise segments, seen from the laser, onto the beams: inverse ranges into `out` [1/m].

    A segment covers one interval of beams. Those near its ends are measured one by one, as are
    all where the laser nearly touches it.
    `seen` has the rows ax, ay, bx, by.
    """
    _plan(count, seen, limit, start, step, plan)
    margin, circle, beams = MARGIN / step, tau / step, len(out)
    for i in range(count):
        low, span, per_x, per_y = plan[0, i], plan[1, i], plan[2, i], plan[3, i]
        if span == inf:
            _paint_slowly(seen, i, 0, beams - 1, headings, out)
            continue
        while span >= 0 and low - margin < beams:
            first = max(ceil(low - margin), 0)
            sure = min(max(ceil(low + margin), 0), beams)
            end = max(min(floor(low + span - margin) + 1, beams), sure)
            last = min(floor(low + span + margin) + 1, beams)
            if first < sure:
                _paint_slowly(seen, i, first, sure - 1, headings, out)
            for k in range(sure, end):
                out[k] = max(out[k], per_x * headings[0, k] + per_y * headings[1, k])
            if end < last:
                _paint_slowly(seen, i, end, last - 1, headings, out)
            low += circle


@inlined
def _hidden(x: float, y: float, radius: float, start: float, step: float, out: Float) -> bool:
    """Return whether a circle, seen from the laser, is behind what all its beams have met."""
    distance = sqrt(x * x + y * y)
    if distance < 2 * radius:
        return False
    # asin(t) <= t pi / 2
    half = (radius / distance * (pi / 2) + MARGIN) / step
    middle, circle, nearest = (_angle(x, y) - start) / step, tau / step, 1.0 / (distance - radius)
    middle -= np.floor((middle + half) / circle) * circle
    while middle - half < len(out):
        for k in range(max(int(middle - half), 0), min(int(middle + half) + 2, len(out))):
            if out[k] < nearest:
                return False
        middle += circle
    return True


@compiled
def fans(
    first: int,
    last: int,
    limit: float,
    owners: Int32,
    fan: Float,
    headings: Float,
    poses: Float,
    walls: Walls,
    others: Others,
    out: Float,
) -> None:
    """Fill rows `first` to `last` of `out` with the ranges of each laser's beams."""
    frame, starts, pieces = walls
    shapes, columns, rows, start, step = others[1], int(frame[4]), int(frame[5]), fan[3], fan[4]
    found = np.empty(len(shapes) + 1, np.int32)
    room = max(len(pieces), 4 * len(shapes)) + 1
    seen, plan, beams = np.empty((4, room)), np.empty((4, room)), np.empty(out.shape[1])
    for n in range(first, last):
        owner = owners[n]
        turned = poses[2, owner]
        c, s = cos(turned), sin(turned)
        x = poses[0, owner] + c * fan[0] - s * fan[1]
        y = poses[1, owner] + s * fan[0] + c * fan[1]
        c, s = cos(turned + fan[2]), sin(turned + fan[2])
        beams[:] = 1.0 / limit
        west, east = _cells(x - limit - SLACK, x + limit + SLACK, frame[0], frame[3])
        south, north = _cells(y - limit - SLACK, y + limit + SLACK, frame[1], frame[3])
        west, east = max(west, 0), min(east, columns - 1)
        south, north = max(south, 0), min(north, rows - 1)
        count = 0
        for row in range(south, north + 1 if west <= east else south):
            for k in range(starts[row * columns + west], starts[row * columns + east + 1]):
                ax, ay = pieces[k, 0] - x, pieces[k, 1] - y
                bx, by = pieces[k, 2] - x, pieces[k, 3] - y
                seen[0, count], seen[1, count] = c * ax + s * ay, c * ay - s * ax
                seen[2, count], seen[3, count] = c * bx + s * by, c * by - s * bx
                # a wall that was in the box one cell before is met already
                count += not (west <= pieces[k, 4] <= east and south <= pieces[k, 5] <= north)
        _paint(count, seen, plan, limit, start, step, headings, beams)
        count = 0
        for i in range(_neighbours(x, y, limit, owner, others, found) if len(shapes) > 1 else 0):
            k = found[i]
            dx, dy = shapes[k, 0] - x, shapes[k, 1] - y
            if not _hidden(c * dx + s * dy, c * dy - s * dx, shapes[k, 2], start, step, beams):
                outside = dx * dx + dy * dy > shapes[k, 2] * shapes[k, 2]
                dx, dy = shapes[k, 9] - x, shapes[k, 10] - y
                ax, ay = c * dx + s * dy, c * dy - s * dx
                for j in range(3, 11, 2):
                    dx, dy = shapes[k, j] - x, shapes[k, j + 1] - y
                    bx, by = c * dx + s * dy, c * dy - s * dx
                    seen[0, count], seen[1, count] = ax, ay
                    seen[2, count], seen[3, count] = bx, by
                    # from outside, the sides that face away are behind the others
                    count += not (outside and ax * by - ay * bx > 0)
                    ax, ay = bx, by
        _paint(count, seen, plan, limit, start, step, headings, beams)
        for i in range(len(beams)):
            out[n, i] = min(1.0 / beams[i], limit)


@compiled
def _stands_on(
    ax: float,
    ay: float,
    bx: float,
    by: float,
    c: float,
    s: float,
    middle: float,
    length: float,
    width: float,
) -> bool:
    """Return whether a segment, relative to the pose, reaches into the rectangle; as the oracle."""
    mx, my, hx, hy = (ax + bx) / 2, (ay + by) / 2, (bx - ax) / 2, (by - ay) / 2
    mx, my = c * mx + s * my - middle, c * my - s * mx
    hx, hy = c * hx + s * hy, c * hy - s * hx
    return (
        abs(mx) <= length + abs(hx)
        and abs(my) <= width + abs(hy)
        and abs(hx * my - hy * mx) <= length * abs(hy) + width * abs(hx)
    )


@compiled
def blocked(
    first: int,
    last: int,
    poses: Float,
    state: Float,
    walls: Walls,
    others: Others,
    out: Bool,
) -> None:
    """Fill `out` from `first` to `last` with whether robots would stand on something."""
    frame, starts, pieces = walls
    shapes, columns, rows = others[1], int(frame[4]), int(frame[5])
    found = np.empty(len(shapes) + 1, np.int32)
    for n in range(first, last):
        px, py, c, s = poses[0, n], poses[1, n], cos(poses[2, n]), sin(poses[2, n])
        front, rear, half = state[3, n], state[4, n], state[5, n]
        middle, length, width = (front - rear) / 2, (front + rear) / 2 - DEEP, half - DEEP
        hit, reach = False, hypot(max(front, rear), half)
        west, east = _cells(px - reach, px + reach, frame[0], frame[3])
        south, north = _cells(py - reach, py + reach, frame[1], frame[3])
        west, east = max(west, 0), min(east, columns - 1)
        for row in range(max(south, 0), min(north, rows - 1) + 1 if west <= east else 0):
            for k in range(starts[row * columns + west], starts[row * columns + east + 1]):
                ax, ay = pieces[k, 0] - px, pieces[k, 1] - py
                bx, by = pieces[k, 2] - px, pieces[k, 3] - py
                hit |= _stands_on(ax, ay, bx, by, c, s, middle, length, width)
        for i in range(0 if hit else _neighbours(px, py, reach, n, others, found)):
            k = found[i]
            ax, ay = shapes[k, 9] - px, shapes[k, 10] - py
            for j in range(3, 11, 2):
                bx, by = shapes[k, j] - px, shapes[k, j + 1] - py
                hit |= _stands_on(ax, ay, bx, by, c, s, middle, length, width)
                ax, ay = bx, by
        out[n] = hit


@compiled
def place(state: Float, others: Others) -> None:
    """Compute outlines, and sort the robots into the table by counting."""
    box, shapes, places, items = others
    mask, per_metre = int(box[5]) - 1, box[6]
    box[0], box[1], box[2], box[3] = inf, inf, -inf, -inf
    places[:] = 0
    for n in range(len(shapes)):
        x, y, c, s = state[0, n], state[1, n], cos(state[2, n]), sin(state[2, n])
        front, rear, half = state[3, n], state[4, n], state[5, n]
        middle = (front - rear) / 2
        mx, my = x + c * middle, y + s * middle
        shapes[n, 0], shapes[n, 1], shapes[n, 2] = mx, my, hypot((front + rear) / 2, half)
        shapes[n, 3], shapes[n, 4] = x + c * front - s * half, y + s * front + c * half
        shapes[n, 5], shapes[n, 6] = x - c * rear - s * half, y - s * rear + c * half
        shapes[n, 7], shapes[n, 8] = x - c * rear + s * half, y - s * rear - c * half
        shapes[n, 9], shapes[n, 10] = x + c * front + s * half, y + s * front - c * half
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
