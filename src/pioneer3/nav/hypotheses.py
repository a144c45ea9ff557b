"""Poses of which any may be the right one, until the scans of a drive agree with one only.

Each is tracked by itself and none is drawn at random: of two that fit alike none gets lost, so a
robot in one of two equal rooms stays unsure for as long as it takes.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot, inf
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
CERTAIN_LEAD = 2.0
"""Logarithm of the ratio above which the best is the right one, where it explains everything."""
MOST_HYPOTHESES = 250
"""Hypotheses that are kept at most."""
PRIOR_SIGMA = 0.05
"""Standard deviation of a tracked hypothesis before a scan is taken [m]."""
PRIOR_TURN_SIGMA = 0.03
"""Standard deviation of its heading before a scan is taken [rad]."""
SCAN_SIGMA = 0.05
"""Standard deviation of a tracked hypothesis after a scan is taken [m]."""
SCAN_TURN_SIGMA = 0.03
"""Standard deviation of its heading after a scan is taken [rad]."""
NEW_WAY = 1.0
"""Way after which a scan tells as much as the first one [m]; scans before tell the same again."""
NEW_TURN = 1.0
"""Turn after which a scan tells as much as the first one [rad]."""
TRACK_SCALES = (0.4, 0.3, 0.2, 0.1, 0.05)
"""Distances at which points lose their weight, step by step [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class ComparedScan:
    """A scan that places are compared by, the robot by odometry, and its share of a new scan."""

    likelihood: ScanLikelihood
    robot_in_odom: Pose2
    share: float = 1.0


def share_of(motion: Pose2) -> float:
    """Return how much of a new scan one after a `motion` is, 0 to 1: the rest was seen before."""
    return min(1.0, hypot(motion.x, motion.y) / NEW_WAY + abs(motion.theta) / NEW_TURN)


class Hypotheses:
    """Poses (H, 3) [m, rad] on the map; the best is the first. The `verdict` is of the latest scan.

    All scans together weigh as much as one, each by its share: every scan from around a thing that
    was moved sees it, and places that look alike once do so again.
    """

    def __init__(self, poses: Float, verdict: Agreement, share: float = 1.0) -> None:
        self.poses, self.verdict = poses, verdict
        self._told = np.zeros(len(poses))
        self._likely, self._agreed = share * verdict.log_likelihood, share * verdict.agreement
        self._seen = share

    @classmethod
    def found(cls, poses: Float, looks: Sequence[ComparedScan], errors: MotionErrors) -> Self:
        """Return those of `poses` (P, 3) at the last of some looks that explain all of these.

        The scan is brought into line with each; they are wrong by some decimeters and degrees at
        most.
        """
        latest = looks[-1]
        loose = np.diag([0.15**-2, 0.15**-2, 0.08**-2])
        best, _ = latest.likelihood.refined(poses, loose)
        best = best[_first_in_bins(best, latest.likelihood.cost(best))]
        self = cls(best, latest.likelihood.judged(best), latest.share)
        self._thin(MOST_HYPOTHESES)
        at, before = latest.robot_in_odom, self.poses
        for look in reversed(looks[:-1]):
            motion, at = at.inverse() @ look.robot_in_odom, look.robot_in_odom
            before, strain = _tracked(before, look.likelihood, motion, errors)
            self._add(look.likelihood.judged(before), look.share, strain)
        self._thin(MOST_HYPOTHESES)
        return self

    def take(self, look: ComparedScan, motion: Pose2, errors: MotionErrors) -> None:
        """Move all by a `motion` of odometry, and weigh them by the scan after it."""
        self.poses, strain = _tracked(self.poses, look.likelihood, motion, errors)
        self.verdict = look.likelihood.judged(self.poses)
        self._add(self.verdict, look.share, strain)
        self._thin(MOST_HYPOTHESES)

    @property
    def logs(self) -> Float:
        """Logarithms of the weights, shape (H,)."""
        logs: Float = self._likely / self._seen + self._told
        return logs

    @property
    def is_certain(self) -> bool:
        """Whether the best is the right one, by a lead over all that are elsewhere.

        It has to be the greater, the less the best explains: of what was moved, more is unseen yet.
        """
        off = self.poses - self.poses[0]
        away, turned = np.hypot(off[:, 0], off[:, 1]), abs(wrapped(off[:, 2]))
        logs = self.logs
        elsewhere = logs[(away >= AGREEING_PLACE) | (turned >= AGREEING_HEADING)]
        lead = logs[0] - elsewhere.max(initial=-inf)
        return bool(lead >= CERTAIN_LEAD - self._likely[0] / self._seen)

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
        self._told = self._told - 0.5 * ((off / deviations) ** 2).sum(axis=2).min(axis=1)
        self._thin(MOST_HYPOTHESES)

    def drawn(self, count: int, rng: Generator) -> Float:
        """Return `count` poses drawn from the likely ones, shape (count, 3)."""
        weights = self._weights()
        chosen = rng.choice(len(weights), count, p=weights)
        spread = np.array([SCAN_SIGMA, SCAN_SIGMA, SCAN_TURN_SIGMA]) * rng.standard_normal(
            (count, 3)
        )
        poses: Float = self.poses[chosen] + spread
        return poses

    def covariance(self) -> Float:
        """Return the spread of the likely ones around the best, shape (3, 3)."""
        off = self.poses - self.poses[0]
        off[:, 2] = wrapped(off[:, 2])
        spread: Float = (self._weights()[:, None] * off).T @ off
        return spread + np.diag([SCAN_SIGMA**2, SCAN_SIGMA**2, SCAN_TURN_SIGMA**2])

    def _weights(self) -> Float:
        """Return the weights of sum 1, 0 where the best leads so far that it is the right one."""
        logs = self.logs
        weights = np.where(logs > logs[0] - CERTAIN_LEAD, np.exp(logs - logs[0]), 0.0)
        likely: Float = weights / weights.sum()
        return likely

    def _add(self, verdict: Agreement, share: float, strain: Float) -> None:
        self._likely = self._likely + share * verdict.log_likelihood - strain
        self._agreed = self._agreed + share * verdict.agreement
        self._seen += share

    def _thin(self, most: int) -> None:
        """Keep the best of those that are near each other, and none that is unlikely."""
        logs = self.logs
        order = np.argsort(-logs, kind="stable")
        order = order[logs[order] > logs[order[0]] - LEAST_LIKELY]
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
        self.poses, self._told = self.poses[chosen], self._told[chosen]
        self._likely, self._agreed = self._likely[chosen], self._agreed[chosen]
        v = self.verdict
        self.verdict = Agreement(
            v.agree[chosen], v.short[chosen], v.through[chosen], v.misfit[chosen]
        )


def _tracked(
    poses: Float, likelihood: ScanLikelihood, motion: Pose2, errors: MotionErrors
) -> tuple[Float, Float]:
    """Return `poses` (H, 3) after a motion by odometry, with the scan in line with each.

    The second array, of shape (H,), tells how little odometry explains that: half the squares of
    the corrections by their standard deviations. A wrong place along a corridor has to slide.
    """
    way, turn = errors.spread(motion)
    place, heading = PRIOR_SIGMA**2 + way**2, PRIOR_TURN_SIGMA**2 + turn**2
    information = np.diag([1 / place, 1 / place, 1 / heading])
    there = moved(poses, motion)
    best, _ = likelihood.refined(there, information, TRACK_SCALES)
    off = best - there
    off[:, 2] = wrapped(off[:, 2])
    strain: Float = 0.5 * (off**2 @ np.diag(information))
    return best, strain


def _first_in_bins(poses: Float, costs: Float) -> Int:
    """Return the cheapest of the poses (P, 3) in each bin of place and heading."""
    order = np.argsort(costs, kind="stable")
    size = ONE_PLACE / 2, ONE_PLACE / 2, ONE_HEADING / 2
    bins = np.floor(poses[order] / size).astype(np.int64)
    first = np.unique(bins, axis=0, return_index=True)[1]
    chosen: Int = order[np.sort(first)]
    return chosen
