"""Tells where odometry leads to, how far from there a robot may be, and how long its ways are."""

from math import hypot

import numpy as np

from pioneer3.geometry import Pose2
from pioneer3.nav.matching import Prior
from pioneer3.nav.mounting import STRAIGHT_TURN
from pioneer3.nav.settings import MapperSettings

BEND = 0.05
"""Turn that odometry does not tell, by the way [rad/m]: that of wheels one of which is 2 % larger.
"""
LEVER = 0.03
"""Error of the place of a laser, and of the middle of a turn [m]."""
STILL_ERROR = 0.007
"""Error of a stretch without a way [m]: of the time of odometry, mostly."""
STILL_TURN_ERROR = 0.01
"""Error of the heading of a stretch without a way [rad]."""
SCALE_WEIGHT = 1.0
"""Weight against all ways that odometry tells their lengths right [m]."""
FIXED_SHARE = 0.6
"""Share of a scan in a way, beside odometry, from which on it tells the length of that."""
MOST_SCALED = 0.1
"""Share by which odometry tells a way wrong at most: above, wheels slipped."""
SEARCHED_SIGMAS = 2.5
"""Standard deviations of odometry within which the pose is searched for."""
SEARCHED_WAY = 1.5
"""Distance within which the pose is searched for at most [m]: a log may miss much, and a search
takes time with its area."""
SEARCHED_TURN = 1.5
"""Turn within which the pose is searched for at most [rad]."""


class LearnedScale:
    """Finds out how long the ways are that odometry tells, where scans fix them.

    In a corridor nothing but odometry tells how far a robot has driven.
    """

    def __init__(self) -> None:
        self._told = self._driven = SCALE_WEIGHT

    @property
    def ratio(self) -> float:
        """Ratio of the length of a way to its length by odometry."""
        return self._driven / self._told

    def take(self, odometry: Pose2, step: Pose2, share: float) -> None:
        """Learn from a way that is known as `step`, to a `share` by scans, else by odometry."""
        told = hypot(odometry.x, odometry.y)
        if share < FIXED_SHARE or max(abs(odometry.theta), abs(step.theta)) > STRAIGHT_TURN:
            return
        driven = (step.x * odometry.x + step.y * odometry.y) / told if told else 0.0
        expected = self.ratio * told
        driven = expected + (driven - expected) / share  # had odometry not drawn it there
        if abs(driven - told) < MOST_SCALED * told:
            self._told += share * told
            self._driven += share * driven

    def seen(self, odometry: Pose2) -> Pose2:
        """Return a way by odometry in its length by scans."""
        return Pose2(self.ratio * odometry.x, self.ratio * odometry.y, odometry.theta)


def slip(settings: MapperSettings, way: float, turn: float) -> tuple[float, float]:
    """Return the standard deviations of odometry [m, rad] after a way and a turn."""
    return (
        STILL_ERROR + settings.way_error * way + LEVER * turn,
        STILL_TURN_ERROR + settings.turn_error * turn + BEND * way,
    )


def backwards(step: Pose2) -> Pose2:
    """Return a way with the other sign and the same turn."""
    return Pose2(-step.x, -step.y, step.theta)


def search_window(step: Pose2, sigma: float, sigma_theta: float) -> tuple[float, float]:
    """Return the way [m] and the turn [rad] within which the end of a step is searched for."""
    aside = hypot(step.x, step.y) * sigma_theta
    return (
        min(SEARCHED_WAY, SEARCHED_SIGMAS * (sigma + aside / 2)),
        min(SEARCHED_TURN, SEARCHED_SIGMAS * sigma_theta),
    )


def expected_pose(begin: Pose2, odometry: Pose2, sigma: float, sigma_theta: float) -> Prior:
    """Return where odometry leads to, with its errors `sigma` [m] and `sigma_theta` [rad].

    An error of the heading that arises somewhere on the way puts the robot aside of its end, by
    between none and all of it, and half of it if it arises evenly.
    """
    end = begin @ odometry
    aside = np.array([begin.y - end.y, end.x - begin.x])
    even = sigma_theta * np.array([*(aside / 2), 1.0])
    covariance = np.outer(even, even)
    covariance[:2, :2] += np.outer(aside, aside) * sigma_theta**2 / 12
    covariance += np.diag([sigma**2, sigma**2, 0.0])
    return Prior(end, np.linalg.inv(covariance).astype(np.float64))
