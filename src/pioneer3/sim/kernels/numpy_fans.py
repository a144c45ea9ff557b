"""Laser fans with numpy alone: a one-dimensional z-buffer of inverse ranges.

Along a segment the inverse range is linear in cosine and sine of the beam, so what is inside a
segment's interval of beams takes two multiplications. Beams so near its ends that rounding could
decide, and all beams where the laser nearly touches it, are measured as the oracle does.
"""

from itertools import pairwise
from math import ceil, cos, pi, sin, tau

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.kernels.mounts import Fan
from pioneer3.sim.kernels.numpy_rays import measured
from pioneer3.sim.kernels.walls import SLACK, ranges

Float = NDArray[np.float64]
Int = NDArray[np.int64]

CLOSE = 1e-3
"""A segment's end or line this close to the laser is measured beam by beam [m]."""

MARGIN = 5e-6
"""Beams this close to a segment's end are measured one by one; above TOUCH / CLOSE [rad]."""

BLOCK = 1 << 14
"""Meetings of beam and segment worked on at a time."""


def paint(owners: Int, seen: Float, fan: Fan, out: Float) -> None:
    """Rasterise segments onto beams.

    Args:
        owners: Whose row of `out` each segment belongs to, shape (P,).
        seen: Ends `ax, ay, bx, by` in the laser's frame [m], shape (4, P).
        fan: The beams.
        out: Inverse ranges, contiguous [1/m], shape (F, B).
    """
    here = _in_front(seen, fan)
    row, seen = owners[here] * out.shape[1], seen.take(here, axis=1)
    ax, ay, bx, by = seen
    ex, ey, turn = bx - ax, by - ay, ax * by - ay * bx
    ends = np.minimum(ax * ax + ay * ay, bx * bx + by * by)
    close = (turn * turn <= CLOSE**2 * (ex * ex + ey * ey)) | (ends < CLOSE**2)
    low, span = _directions(seen, turn, fan)
    span[close] = -np.inf
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = np.stack([ey / turn, -ex / turn])
    touched = np.flatnonzero(close)
    doubts = [(touched, np.zeros(len(touched)), np.full(len(touched), np.inf))]
    doubts += _spread(row, (low, span), inverse, fan, out)
    which, lower, upper = (np.concatenate(parts) for parts in zip(*doubts, strict=True))
    if len(which):
        beams = _beams(lower, upper, out.shape[1])
        _exactly(row[which], seen[:, which], beams, fan, out)


def _in_front(seen: Float, fan: Fan) -> Int:
    """Return which segments are not wholly behind a fan of at most half a circle."""
    start, step = fan.frame[3:]
    width = step * (fan.headings.shape[1] - 1)
    if width > pi:
        return np.arange(seen.shape[1])
    c, s = cos(start + width / 2), sin(start + width / 2)
    return np.flatnonzero(
        np.maximum(c * seen[0] + s * seen[1], c * seen[2] + s * seen[3]) >= -SLACK
    )


def _directions(seen: Float, turn: Float, fan: Fan) -> tuple[Float, Float]:
    """Return the first beam of each segment, counter-clockwise, and how many it is wide."""
    start, step = fan.frame[3:]
    first, last = np.arctan2(seen[1], seen[0]), np.arctan2(seen[3], seen[2])
    low = (np.where(turn < 0, last, first) - start) / step
    span = np.where(turn < 0, first - last, last - first) / step
    span[span < 0] += tau / step
    return low, span


def _spread(
    row: Int, intervals: tuple[Float, Float], inverse: Float, fan: Fan, out: Float
) -> list[tuple[Int, Float, Float]]:
    """Paint what is surely met; return the intervals of beams in doubt: whose, first, last."""
    low, span = intervals
    margin, circle, beams = MARGIN / fan.frame[4], tau / fan.frame[4], out.shape[1]
    doubts = []
    low = low - np.floor((low + span.clip(min=0) + margin) / circle) * circle
    for turns in range(ceil((beams + margin) / circle) + 1):
        here = np.flatnonzero((low + (turns * circle - margin) < beams) & (span >= 0))
        if len(here) == 0:
            break
        begin = low[here] + turns * circle
        end = begin + span[here]
        sure, last = np.ceil(begin + margin), np.floor(end - margin)
        _surely(row[here], inverse[:, here], _beams(sure, last, beams), fan, out)
        after = np.maximum(last + 1, sure)
        for lower, upper in ((np.ceil(begin - margin), sure - 1), (after, np.floor(end + margin))):
            doubt = np.flatnonzero(lower <= upper)
            doubts.append((here[doubt], lower[doubt], upper[doubt]))
    return doubts


def _beams(lower: Float, upper: Float, beams: int) -> tuple[Int, Int]:
    """Return first beam and number of beams of each interval, clipped to the fan."""
    first = np.clip(lower, 0, beams).astype(np.int64)
    counts = np.clip(upper, -1, beams - 1).astype(np.int64) - first + 1
    return first, counts.clip(min=0)


def _surely(row: Int, inverse: Float, beams: tuple[Int, Int], fan: Fan, out: Float) -> None:
    """Paint an interval of beams of each segment."""
    flat, headings = out.reshape(-1), fan.headings
    first, counts = beams
    blocks = np.flatnonzero(np.diff(np.cumsum(counts) // BLOCK)) + 1
    for begin, end in pairwise([0, *blocks.tolist(), len(counts)]):
        some = counts[begin:end]
        beam = ranges(first[begin:end], some)
        depth = np.repeat(inverse[0, begin:end], some) * headings[0].take(beam)
        depth += np.repeat(inverse[1, begin:end], some) * headings[1].take(beam)
        beam += np.repeat(row[begin:end], some)
        np.maximum.at(flat, beam, depth)


def _exactly(row: Int, seen: Float, beams: tuple[Int, Int], fan: Fan, out: Float) -> None:
    """Measure an interval of beams of each segment one by one."""
    first, counts = beams
    which, beam = np.repeat(np.arange(len(row)), counts), ranges(first, counts)
    met = measured(fan.headings[:, beam], seen[:, which])
    with np.errstate(divide="ignore"):
        np.maximum.at(out.reshape(-1), row[which] + beam, 1.0 / met)
