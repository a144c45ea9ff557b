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
from pioneer3.sim.kernels.numpy_truth import any_of, indices_of
from pioneer3.sim.kernels.walls import SLACK, ranges

Float = NDArray[np.float64]
Int = NDArray[np.int64]

CLOSE = 1e-3
"""A segment whose line is this close to the laser is measured beam by beam [m]."""

MARGIN = 5e-6
"""Beams this close to a segment's end are measured one by one; above TOUCH / CLOSE [rad]."""

BLOCK = 1 << 14
"""Meetings of beam and segment worked on at a time."""

NO_BLOCKS = np.empty(0, dtype=np.int64)


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
    close = turn * turn <= CLOSE**2 * (ex * ex + ey * ey)
    low, span = _directions(seen, turn, fan)
    span[close] = -np.inf
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = np.array([ey, -ex]) / turn
    doubts = _spread(row, (low, span), inverse, fan, out)
    touched = indices_of(close)
    if len(touched):
        doubts.append((touched, np.zeros(len(touched)), np.full(len(touched), np.inf)))
    for which, lower, upper in doubts:
        beams = _beams(lower, upper, out.shape[1])
        _exactly(row[which], seen[:, which], beams, fan, out)


def _in_front(seen: Float, fan: Fan) -> Int:
    """Return which segments are not wholly behind a fan of at most half a circle."""
    start, step = fan.frame[3:]
    width = step * (fan.headings.shape[1] - 1)
    if width > pi:
        return np.arange(seen.shape[1])
    c, s = cos(start + width / 2), sin(start + width / 2)
    return indices_of(np.maximum(c * seen[0] + s * seen[1], c * seen[2] + s * seen[3]) >= -SLACK)


def _directions(seen: Float, turn: Float, fan: Fan) -> tuple[Float, Float]:
    """Return the first beam of each segment, counter-clockwise, and how many it is wide."""
    start, step = fan.frame[3:]
    first, last = np.arctan2(seen[1::2], seen[::2]) * (1 / step)
    low = np.where(turn < 0, last, first) - start / step
    span = np.copysign(1.0, turn) * (last - first)
    span += (span < 0) * (tau / step)
    return low, span


def _spread(
    row: Int, intervals: tuple[Float, Float], inverse: Float, fan: Fan, out: Float
) -> list[tuple[Int, Float, Float]]:
    """Paint what is surely met; return the intervals of beams in doubt: whose, first, last."""
    low, span = intervals
    margin, circle, beams = MARGIN / fan.frame[4], tau / fan.frame[4], out.shape[1]
    doubts = []
    # what is endlessly narrow gets endlessly far away
    low = low - np.floor((low + span + margin) * (1 / circle)) * circle
    for turns in range(ceil((beams + margin) / circle) + 1):
        here = indices_of(low < beams + margin - turns * circle)
        if len(here) == 0:
            break
        begin = low.take(here) + turns * circle
        outward = np.array([-begin, begin + span.take(here)])
        inner, outer = np.floor(outward - margin), np.floor(outward + margin)
        sure, last = -inner[0], inner[1]
        _surely(row.take(here), inverse.take(here, axis=1), _beams(sure, last, beams), fan, out)
        doubt = outer > inner
        if any_of(doubt):
            lower = np.array([-outer[0], np.maximum(last + 1, sure)])
            upper = np.array([sure - 1, outer[1]])
            doubts.append((here[np.nonzero(doubt)[1]], lower[doubt], upper[doubt]))
    return doubts


def _beams(lower: Float, upper: Float, beams: int) -> tuple[Int, Int]:
    """Return first beam and number of beams of each interval, clipped to the fan."""
    ends = np.array([lower, upper + 1])
    first, beyond = np.minimum(np.maximum(ends, 0, out=ends), beams, out=ends).astype(np.int64)
    return first, np.maximum(beyond - first, 0)


def _surely(row: Int, inverse: Float, beams: tuple[Int, Int], fan: Fan, out: Float) -> None:
    """Paint an interval of beams of each segment."""
    first, counts = beams
    total = counts.cumsum() // BLOCK
    blocks = indices_of(total[1:] != total[:-1]) + 1 if total[-1] else NO_BLOCKS
    for begin, end in pairwise([0, *blocks.tolist(), len(counts)]):
        some = counts[begin:end]
        beam = ranges(first[begin:end], some)
        depth = inverse[:, begin:end].repeat(some, axis=1)
        depth *= fan.headings.take(beam, axis=1)
        beam += row[begin:end].repeat(some)
        np.maximum.at(out.reshape(-1), beam, depth[0] + depth[1])


def _exactly(row: Int, seen: Float, beams: tuple[Int, Int], fan: Fan, out: Float) -> None:
    """Measure an interval of beams of each segment one by one."""
    first, counts = beams
    which, beam = np.repeat(np.arange(len(row)), counts), ranges(first, counts)
    met = measured(fan.headings[:, beam], seen[:, which])
    with np.errstate(divide="ignore"):
        np.maximum.at(out.reshape(-1), row[which] + beam, 1.0 / met)
