"""Laser fans with numpy alone: a one-dimensional z-buffer of inverse ranges.

Along a segment the inverse range is linear in cosine and sine of the beam, so what is inside a
segment's interval of beams takes two multiplications. Beams so near its ends that rounding could
decide, and all beams where the laser nearly touches it, are measured as the oracle does.
"""

from math import ceil, tau

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.kernels.mounts import Fan
from pioneer3.sim.kernels.walls import ranges
from pioneer3.sim.raycast import meetings

Float = NDArray[np.float64]
Int = NDArray[np.int64]

CLOSE = 1e-3
"""A segment's end or line this close to the laser is measured beam by beam [m]."""

MARGIN = 5e-6
"""Beams this close to a segment's end are measured one by one; above TOUCH / CLOSE [rad]."""

BLOCK = 1 << 14
"""Meetings of beam and segment worked on at a time."""


def paint(owners: Int, seen: Float, fan: Fan, limit: float, out: Float) -> None:
    """Rasterise segments onto beams.

    Args:
        owners: Whose row of `out` each segment belongs to, shape (P,).
        seen: Ends `ax, ay, bx, by` in the laser's frame [m], shape (4, P).
        fan: The beams.
        limit: Longest range [m].
        out: Inverse ranges, contiguous [1/m], shape (F, B).
    """
    turn = seen[0] * seen[3] - seen[1] * seen[2]
    squared = (seen[2] - seen[0]) ** 2 + (seen[3] - seen[1]) ** 2
    near = turn**2 <= limit**2 * squared
    owners, seen, turn, squared = owners[near], seen[:, near], turn[near], squared[near]
    swap = turn < 0
    seen[:, swap] = seen[:, swap][[2, 3, 0, 1]]
    turn = abs(turn)
    ends = np.minimum(seen[0] ** 2 + seen[1] ** 2, seen[2] ** 2 + seen[3] ** 2)
    close = (turn**2 <= CLOSE**2 * squared) | (ends < CLOSE**2)
    row = owners * out.shape[1]
    _exactly(row[close], seen[:, close], np.zeros(close.sum()), np.inf, fan, out)
    clear = ~close
    _spread(row[clear], seen[:, clear], turn[clear], fan, out)


def _spread(row: Int, seen: Float, turn: Float, fan: Fan, out: Float) -> None:
    """Paint counter-clockwise segments that the laser does not touch."""
    start, step = fan.frame[3:]
    margin, circle, beams = MARGIN / step, tau / step, out.shape[1]
    low = np.arctan2(seen[1], seen[0])
    span = np.arctan2(seen[3], seen[2]) - low
    span = np.where(span < 0, span + tau, span) / step
    low = (low - start) / step
    low -= np.floor((low + span + margin) / circle) * circle
    inverse = np.stack([seen[3] - seen[1], seen[0] - seen[2]]) / turn
    for turns in range(ceil((beams + margin) / circle) + 1):
        begin = low + turns * circle
        here = np.flatnonzero(begin - margin < beams)
        if len(here) == 0:
            return
        begin, end, rows = begin[here], (begin + span)[here], row[here]
        sure, last = np.ceil(begin + margin), np.floor(end - margin)
        _surely(rows, inverse[:, here], sure, last, fan, out)
        some, before = seen[:, here], np.ceil(begin - margin)
        for lower, upper in ((before, sure - 1), (np.maximum(last + 1, sure), np.floor(end + margin))):
            doubt = np.flatnonzero(lower <= upper)
            _exactly(rows[doubt], some[:, doubt], lower[doubt], upper[doubt], fan, out)


def _intervals(lower: Float, upper: Float | float, beams: int) -> tuple[Int, Int]:
    """Return first beam and number of beams of each interval, clipped to the fan."""
    first = np.clip(lower, 0, beams).astype(np.int64)
    counts = np.clip(upper, -1, beams - 1).astype(np.int64) - first + 1
    return first, counts.clip(min=0)


def _surely(row: Int, inverse: Float, lower: Float, upper: Float, fan: Fan, out: Float) -> None:
    """Paint beams `lower` to `upper` of each segment."""
    flat, headings = out.reshape(-1), fan.headings
    first, counts = _intervals(lower, upper, out.shape[1])
    blocks = np.flatnonzero(np.diff(np.cumsum(counts) // BLOCK)) + 1
    edges = [0, *blocks.tolist(), len(counts)]
    for begin, end in zip(edges[:-1], edges[1:], strict=True):
        some = counts[begin:end]
        beam = ranges(first[begin:end], some)
        depth = np.repeat(inverse[0, begin:end], some) * headings[0].take(beam)
        depth += np.repeat(inverse[1, begin:end], some) * headings[1].take(beam)
        beam += np.repeat(row[begin:end], some)
        np.maximum.at(flat, beam, depth)


def _exactly(
    row: Int, seen: Float, lower: Float, upper: Float | float, fan: Fan, out: Float
) -> None:
    """Measure beams `lower` to `upper` of each segment one by one."""
    first, counts = _intervals(lower, upper, out.shape[1])
    which, beam = np.repeat(np.arange(len(row)), counts), ranges(first, counts)
    index, met = meetings(np.zeros(2), fan.headings.T[beam], seen.T[which])
    with np.errstate(divide="ignore"):
        np.maximum.at(out.reshape(-1), row[which[index]] + beam[index], 1.0 / met)
