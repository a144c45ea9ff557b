"""The result of localization: where a robot is on the map, and how sure that is."""

from dataclasses import dataclass
from math import hypot, inf, sqrt
from typing import Literal

import numpy as np

from pioneer3.arrays import Float
from pioneer3.geometry import Pose2

CHI_SQUARED = 5.991
"""Quantile of the chi-squared distribution in two dimensions, at 95 %."""

Stage = Literal["lost", "looking", "sure"]
"""`lost`: the robot may be anywhere. `looking`: it is at one of some places, or near one that
somebody has told. `sure`: it is where the estimate says."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Estimate:
    """Where a robot is on the map.

    Attributes:
        robot_in_map: Most likely pose [m, rad]; `None` where nothing is known.
        odom_in_map: The same as the pose of odometry's frame; it changes little while the robot
            drives.
        covariance: Of x, y and heading in the map's frame [m, rad], shape (3, 3).
        sure: Whether the robot may act upon it.
        agreement: Share of the readings that agree with the map there, 0 to 1.
        reason: The stage for people, one sentence without a full stop.
        remark: The same about the laser that is mounted askew, or empty.
    """

    robot_in_map: Pose2 | None
    odom_in_map: Pose2 | None
    covariance: Float
    sure: bool
    agreement: float
    stage: Stage
    reason: str
    remark: str = ""

    @property
    def deviation(self) -> float:
        """Standard deviation of the position in its worst direction [m]."""
        return deviation_of(self.covariance)

    @property
    def ellipse(self) -> tuple[float, float, float] | None:
        """The ellipse that holds the position with 95 %; `None` where nothing is known.

        Its half axes [m], and the angle of the longer one in the map's frame [rad].
        """
        if self.robot_in_map is None or not np.isfinite(self.covariance).all():
            return None
        squares, axes = np.linalg.eigh(self.covariance[:2, :2])
        shorter, longer = np.sqrt(np.maximum(squares, 0.0) * CHI_SQUARED)
        return float(longer), float(shorter), float(np.arctan2(axes[1, 1], axes[0, 1]))


def deviation_of(covariance: Float) -> float:
    """Return the largest standard deviation of a position [m] by its covariance (2+, 2+)."""
    if not np.isfinite(covariance).all():
        return inf
    (xx, xy), (_, yy) = covariance[:2, :2].tolist()
    return sqrt(max(0.0, (xx + yy) / 2 + hypot((xx - yy) / 2, xy)))  # root of the larger eigenvalue
