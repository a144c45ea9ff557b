# ruff: noqa: PLR0917 (compiled functions take no keywords without a cost)
"""Laser fans: near segments rasterised onto the beams, the nearest one wins.

Where there are many segments, as in scanned maps, most are hidden; then each beam walks through the
grid as far as it sees.
"""

from math import ceil, cos, floor, inf, pi, sin, sqrt, tau

import numpy as np

from pioneer3.arrays import Float, Int32
from pioneer3.jit import inlined, kernel
from pioneer3.sim.kernels.rays import meeting, walk
from pioneer3.sim.kernels.robots import Others, Walls, cells, neighbours
from pioneer3.sim.kernels.walls import SLACK

CLOSE = 1e-3
"""A segment's end or line this close to a laser is measured beam by beam [m]."""

TINY = 1e-300
"""In place of zero, which nothing is divided by."""

NEAREST = 1e-12
"""A range below this [m] is none; its inverse is finite."""

MANY = 16
"""Pieces of walls for each beam from which on walking is faster than rasterising them."""

MARGIN = 5e-5
"""Beams this close to a segment's end are measured one by one; above the error of _angle [rad]."""


@inlined
def _angle(x: float, y: float) -> float:
    """Return atan2(y, x) within 1.2e-5 rad (Abramowitz and Stegun 4.4.49), in (-pi, pi]."""
    ax, ay = abs(x), abs(y)
    t = min(ax, ay) / max(ax, ay, TINY)
    u = t * t
    a = t * (0.9998660 + u * (-0.3302995 + u * (0.1801410 + u * (-0.0851330 + u * 0.0208351))))
    if ay > ax:
        a = pi / 2 - a
    if x < 0:
        a = pi - a
    return -a if y < 0 else a


@kernel
def _paint_slowly(seen: Float, i: int, first: int, last: int, headings: Float, out: Float) -> None:
    """Measure a segment along beams `first` to `last`, one by one, into `out` [1/m]."""
    ax, ay, bx, by = seen[0, i], seen[1, i], seen[2, i], seen[3, i]
    for k in range(max(first, 0), min(last + 1, len(out))):
        away = meeting(ax, ay, bx, by, headings[0, k], headings[1, k])
        out[k] = max(out[k], 1.0 / max(away, NEAREST))


@kernel
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
        turn = max(turn, TINY)
        plan[2, i], plan[3, i] = ey / turn, -ex / turn


@kernel
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


@kernel
def _walk_beams(
    x: float,
    y: float,
    c: float,
    s: float,
    limit: float,
    headings: Float,
    walls: Walls,
    out: Float,
) -> None:
    """Measure each beam of a laser at (x, y), turned by the angle of (c, s), into `out` [1/m]."""
    for k in range(len(out)):
        dx, dy = c * headings[0, k] - s * headings[1, k], s * headings[0, k] + c * headings[1, k]
        away, _ = walk(x, y, dx, dy, limit, 0.0, walls)
        out[k] = 1.0 / max(away, NEAREST)


@kernel
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
    corners = shapes.shape[1]
    room = max(len(pieces), corners // 2 * len(shapes)) + 1
    seen, plan, beams = np.empty((4, room)), np.empty((4, room)), np.empty(out.shape[1])
    for n in range(first, last):
        owner = owners[n]
        turned = poses[2, owner]
        c, s = cos(turned), sin(turned)
        x = poses[0, owner] + c * fan[0] - s * fan[1]
        y = poses[1, owner] + s * fan[0] + c * fan[1]
        c, s = cos(turned + fan[2]), sin(turned + fan[2])
        beams[:] = 1.0 / limit
        west, east = cells(x - limit - SLACK, x + limit + SLACK, frame[0], frame[3])
        south, north = cells(y - limit - SLACK, y + limit + SLACK, frame[1], frame[3])
        west, east = max(west, 0), min(east, columns - 1)
        south, north = max(south, 0), min(north, rows - 1)
        bottom, top = south * columns, (north + 1 if west <= east else south) * columns
        count = 0
        for row in range(bottom, top, columns):
            count += starts[row + east + 1] - starts[row + west]
        if count > MANY * len(beams):
            _walk_beams(x, y, c, s, limit, headings, walls, beams)
        else:
            count = 0
            for row in range(bottom, top, columns):
                for k in range(starts[row + west], starts[row + east + 1]):
                    ax, ay = pieces[k, 0] - x, pieces[k, 1] - y
                    bx, by = pieces[k, 2] - x, pieces[k, 3] - y
                    seen[0, count], seen[1, count] = c * ax + s * ay, c * ay - s * ax
                    seen[2, count], seen[3, count] = c * bx + s * by, c * by - s * bx
                    # a wall that was in the box one cell before is met already
                    before = west <= pieces[k, 4] <= east and south <= pieces[k, 5] <= north
                    count += not before
            _paint(count, seen, plan, limit, start, step, headings, beams)
        count = 0
        for i in range(neighbours(x, y, limit, owner, others, found) if len(shapes) > 1 else 0):
            k = found[i]
            dx, dy = shapes[k, 0] - x, shapes[k, 1] - y
            if not _hidden(c * dx + s * dy, c * dy - s * dx, shapes[k, 2], start, step, beams):
                outside = dx * dx + dy * dy > shapes[k, 2] * shapes[k, 2]
                dx, dy = shapes[k, corners - 2] - x, shapes[k, corners - 1] - y
                ax, ay = c * dx + s * dy, c * dy - s * dx
                for j in range(3, corners, 2):
                    dx, dy = shapes[k, j] - x, shapes[k, j + 1] - y
                    bx, by = c * dx + s * dy, c * dy - s * dx
                    seen[0, count], seen[1, count] = ax, ay
                    seen[2, count], seen[3, count] = bx, by
                    # from outside, the sides that face away are behind the others; sides may
                    # have no length
                    behind = outside and ax * by - ay * bx > 0
                    count += not (behind or (ax == bx and ay == by))
                    ax, ay = bx, by
        _paint(count, seen, plan, limit, start, step, headings, beams)
        for i in range(len(beams)):
            out[n, i] = min(1.0 / beams[i], limit) if beams[i] > 0.0 else limit
