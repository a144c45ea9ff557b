"""Poses of which any may be the right one, until the scans of a drive agree with one only.

Each is tracked by itself and none is drawn at random: of two that fit alike none gets lost, so a
robot in one of two equal rooms stays unsure for as long as it takes.
"""

from math import hypot
from typing import Self

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from pioneer3.arrays import Float
from pioneer3.geometry import Pose2
from pioneer3.nav.likelihood import Agreement, ScanLikelihood
from pioneer3.nav.particles import MotionErrors, moved, wrapped

Int = NDArray[np.intp]

ONE_PLACE = 0.2
"""Distance below which two hypotheses are one [m]."""
ONE_HEADING = 0.15
"""Difference of headings below which two hypotheses are one [rad]."""
AGREEING_PLACE = 0.4
"""Distance below which two hypotheses do not contradict each other [m]."""
AGREEING_HEADING = 0.2
"""Difference of headings below which two hypotheses do not contradict each other [rad]."""
LEAST_LIKELY = 12.0
"""Logarithm of the ratio to the best above which a less likely hypothesis is dropped."""
MOST_HYPOTHESES = 250
"""Hypotheses that are kept at most."""
PRIOR_SIGMA = 0.15
"""Standard deviation of a tracked hypothesis before a scan is taken [m]."""
PRIOR_TURN_SIGMA = 0.04
"""Standard deviation of its heading before a scan is taken [rad]."""
SCAN_SIGMA = 0.05
"""Standard deviation of a tracked hypothesis after a scan is taken [m]."""
SCAN_TURN_SIGMA = 0.03
"""Standard deviation of its heading after a scan is taken [rad]."""
NOISE = 1.5
"""Difference of the logarithms of a scan's likelihoods that tells nothing: the edge of a door may
hide one beam of forty, and does so in each scan from there."""
MOST_TOLD = 4.0
"""Difference of the logarithms that one scan tells at most: a cupboard that was moved makes the
right place look wrong from everywhere around."""
NEW_WAY = 1.0
"""Way after which a scan tells as much as the first one [m]; scans before tell the same again."""
NEW_TURN = 1.0
"""Turn after which a scan tells as much as the first one [rad]."""
TRACK_SCALES = (0.4, 0.3, 0.2, 0.1, 0.05)
"""Distances at which points lose their weight, step by step [m]."""


class Hypotheses:
    """Poses (H, 3) [m, rad] on the map with the logarithms of their weights; the best is the first.

    The `verdict` tells how the latest scan agreed with each. Those that explain every scan as well
    as the best of that scan, but for its noise, keep their weight.
    """

    def __init__(self, poses: Float, logs: Float, verdict: Agreement) -> None:
        self.poses, self.logs, self.verdict = poses, logs, verdict
        self._agreed, self._seen = verdict.agreement, 1.0

    @classmethod
    def found(cls, poses: Float, likelihood: ScanLikelihood, *, told: bool = False) -> Self:
        """Return those of `poses` (P, 3) that remain after a scan was brought into line with each.

        They are wrong by some decimeters and degrees at most. Of a few places that were `told` the
        scan decides.
        """
        loose = np.diag([0.15**-2, 0.15**-2, 0.08**-2])
        best, _ = likelihood.refined(poses, loose)
        best = best[_first_in_bins(best, likelihood.cost(best))]
        verdict = likelihood.judged(best)
        logs = verdict.log_likelihood if told else _told(verdict)
        self = cls(best, logs, verdict)
        self._thin(MOST_HYPOTHESES)
        return self

    def move(self, motion: Pose2) -> None:
        """Move all by what odometry tells."""
        self.poses = moved(self.poses, motion)

    def take(self, likelihood: ScanLikelihood, motion: Pose2, errors: MotionErrors) -> None:
        """Weigh all by a scan after a `motion` that they were moved by."""
        way, turn = errors.spread(motion)
        place, heading = PRIOR_SIGMA**2 + way**2, PRIOR_TURN_SIGMA**2 + turn**2
        information = np.diag([1 / place, 1 / place, 1 / heading])
        self.poses, _ = likelihood.refined(self.poses, information, TRACK_SCALES)
        self.verdict = likelihood.judged(self.poses)
        new = hypot(motion.x, motion.y) / NEW_WAY + abs(motion.theta) / NEW_TURN
        share = min(1.0, new)
        self.logs = self.logs + share * _told(self.verdict)
        self._agreed, self._seen = self._agreed + share * self.verdict.agreement, self._seen + share
        self._thin(MOST_HYPOTHESES)

    @property
    def share(self) -> float:
        """Share of the weight that the best has, together with those that hardly differ."""
        off = self.poses - self.poses[0]
        away, turned = np.hypot(off[:, 0], off[:, 1]), abs(wrapped(off[:, 2]))
        weights = np.exp(self.logs - self.logs[0])
        alike = (away < AGREEING_PLACE) & (turned < AGREEING_HEADING)
        return float(weights[alike].sum() / weights.sum())

    @property
    def agreement(self) -> float:
        """How well the latest scan agrees with the best, 0 to 1."""
        return float(self.verdict.agreement[0])

    @property
    def explained(self) -> float:
        """How well all scans so far agree with the best, 0 to 1."""
        return float(self._agreed[0] / self._seen)

    def near(self, poses: Float, deviations: Float) -> None:
        """Weigh all by how near one of `poses` (S, 3) is, with these standard deviations (3,)."""
        off = self.poses[:, None] - poses
        off[..., 2] = wrapped(off[..., 2])
        self.logs = self.logs - 0.5 * ((off / deviations) ** 2).sum(axis=2).min(axis=1)
        self._thin(MOST_HYPOTHESES)

    def drawn(self, count: int, rng: Generator) -> Float:
        """Return `count` poses drawn by the weights, shape (count, 3)."""
        weights = np.exp(self.logs - self.logs[0])
        chosen = rng.choice(len(weights), count, p=weights / weights.sum())
        spread = np.array([SCAN_SIGMA, SCAN_SIGMA, SCAN_TURN_SIGMA]) * rng.standard_normal(
            (count, 3)
        )
        poses: Float = self.poses[chosen] + spread
        return poses

    def covariance(self) -> Float:
        """Return the spread of all around the best, shape (3, 3)."""
        off = self.poses - self.poses[0]
        off[:, 2] = wrapped(off[:, 2])
        weights = np.exp(self.logs - self.logs[0])
        weights /= weights.sum()
        spread: Float = (weights[:, None] * off).T @ off
        return spread + np.diag([SCAN_SIGMA**2, SCAN_SIGMA**2, SCAN_TURN_SIGMA**2])

    def _thin(self, most: int) -> None:
        """Keep the best of those that are near each other, and none that is unlikely."""
        order = np.lexsort((-self._agreed, -self.logs))
        order = order[self.logs[order] > self.logs[order[0]] - LEAST_LIKELY]
        kept: list[int] = []
        poses = self.poses[order]
        open_ = np.ones(len(order), dtype=np.bool_)
        for i in range(len(order)):
            if open_[i]:
                kept.append(int(order[i]))
                off = poses - poses[i]
                near = np.hypot(off[:, 0], off[:, 1]) < ONE_PLACE
                open_ &= ~(near & (abs(wrapped(off[:, 2])) < ONE_HEADING))
                if len(kept) == most:
                    break
        chosen = np.array(kept, dtype=np.intp)
        self.poses, self.logs = self.poses[chosen], self.logs[chosen]
        self._agreed = self._agreed[chosen]
        v = self.verdict
        self.verdict = Agreement(
            v.agree[chosen], v.short[chosen], v.through[chosen], v.misfit[chosen]
        )


def _told(verdict: Agreement) -> Float:
    """Return the logarithms of the weights that one scan tells, shape (H,)."""
    logs = verdict.log_likelihood
    told: Float = (logs - logs.max() + NOISE).clip(-MOST_TOLD, 0.0)
    return told


def _first_in_bins(poses: Float, costs: Float) -> Int:
    """Return the cheapest of the poses (P, 3) in each bin of place and heading."""
    order = np.argsort(costs, kind="stable")
    size = ONE_PLACE / 2, ONE_PLACE / 2, ONE_HEADING / 2
    bins = np.floor(poses[order] / size).astype(np.int64)
    first = np.unique(bins, axis=0, return_index=True)[1]
    chosen: Int = order[np.sort(first)]
    return chosen
