"""True turns by what sonars hear: after a full turn they hear everything once more.

Echoes of each transducer are laid over each other at a supposed length of a full turn, as it is
counted. At the right one they differ least: phase dispersion minimization (Stellingwerf, 1978).
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import pi

import numpy as np

from pioneer3.arrays import Float
from pioneer3.errors import DeviceError

FARTHEST = 2.5
"""Echoes from farther away are all taken to be as far as this [m]."""
LEAST_RATIO = 0.75
"""Shortest full turn that is looked for, over that of right wheels."""
GREATEST_RATIO = 1.3
"""Longest one."""
COARSE = 400
"""Lengths of a full turn that are tried first."""
FINE = 60
"""Lengths that are tried around the best of these."""
BINS = 72
"""Parts of a full turn in which echoes are compared."""
LEAST_TURNS = 2.0
"""Full turns from which on echoes tell something."""
CLEAR = 0.8
"""Share of the dispersion of wrong lengths above which a length is no better than others."""
GROUPS = 4
"""Groups of transducers whose answers are compared."""
LEAST_SIGMA = 0.0007
"""Standard deviation of a full turn at least, as a share of it: 0.25 degrees."""


@dataclass(frozen=True, slots=True)
class FullTurn:
    """Length of a true full turn as it is counted [rad], with its standard deviation."""

    counted: float
    sigma: float


def full_turn(echoes: Float) -> FullTurn:
    """Return the length of a full turn by echoes (M, 3) of a robot that turns on the spot.

    A row is the counted heading [rad], number of the transducer, and range [m].

    Raises:
        DeviceError: The echoes do not tell.
    """
    if not len(echoes) or np.ptp(echoes[:, 0]) < 2 * pi * LEAST_TURNS:
        raise DeviceError(f"too few echoes: let the robot turn {LEAST_TURNS:g} times or more")
    best = _best(echoes, np.linspace(LEAST_RATIO, GREATEST_RATIO, COARSE) * 2 * pi)
    answers = [_refined(group, best) for group in _groups(echoes)]
    several = np.array([answer for answer in answers if abs(answer / best - 1) < 0.05])
    if len(several) < 2:
        raise DeviceError("the sonars hear nothing that tells turns apart: turn beside a wall")
    length = _refined(echoes, best)
    spread = float(np.std(several, ddof=1) / np.sqrt(len(several)))
    return FullTurn(length, max(spread, LEAST_SIGMA * length))


def _groups(echoes: Float) -> Iterator[Float]:
    for group in range(GROUPS):
        part = echoes[echoes[:, 1] % GROUPS == group]
        if len(part):
            yield part


def _best(echoes: Float, lengths: Float) -> float:
    dispersions = np.array([_dispersion(echoes, length) for length in lengths.tolist()])
    best = int(np.argmin(dispersions))
    if not dispersions[best] < CLEAR * np.median(dispersions):
        raise DeviceError(
            "the sonars hear the same all around: leave half a metre between the robot's side and "
            "a wall, and turn it there once more"
        )
    return float(lengths[best])


def _refined(echoes: Float, around: float) -> float:
    """Return the middle of the lengths that are nearly the best [rad]."""
    lengths = np.linspace(0.985, 1.015, FINE) * around
    dispersions = np.array([_dispersion(echoes, length) for length in lengths.tolist()])
    low, usual = dispersions.min(), np.median(dispersions)
    weights = np.clip(low + 0.25 * (usual - low) - dispersions, 0.0, None)
    return float((weights * lengths).sum() / weights.sum()) if weights.sum() > 0 else around


def _dispersion(echoes: Float, length: float) -> float:
    """Return the mean square by which echoes of one bearing differ [m^2]."""
    share = echoes[:, 0] / length % 1.0
    bins = (share * BINS).astype(np.int64) + BINS * echoes[:, 1].astype(np.int64)
    ranges = np.minimum(np.nan_to_num(echoes[:, 2], posinf=FARTHEST), FARTHEST)
    counts = np.bincount(bins)
    sums, squares = np.bincount(bins, ranges), np.bincount(bins, ranges**2)
    several = counts > 1
    within = squares[several] - sums[several] ** 2 / counts[several]
    return float(within.sum() / max(1, (counts[several] - 1).sum()))
