"""Ways and turns as the wheels count them, and the poses that a correction makes of them."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from typing import Self

import numpy as np

from pioneer3.arrays import Float
from pioneer3.geometry import Pose2
from pioneer3.models import OdometryCorrection
from pioneer3.models.odometry import true_of_measured


@dataclass(frozen=True, slots=True, eq=False)
class RawTrack:
    """A piece of raw odometry.

    Attributes:
        stamps: Times of the poses [s], shape (N + 1,).
        steps: Way [m] and turn [rad] between them, shape (N, 2).
    """

    stamps: Float
    steps: Float

    @classmethod
    def of(cls, stamps: Sequence[float], poses: Sequence[Pose2]) -> Self:
        """Return the track through poses of one frame, in which no correction is."""
        rows = np.array([(pose.x, pose.y, pose.theta) for pose in poses]).reshape(-1, 3)
        turn = (np.diff(rows[:, 2]) + pi) % (2 * pi) - pi
        along = rows[:-1, 2] + turn / 2
        chord = np.diff(rows[:, 0]) * np.cos(along) + np.diff(rows[:, 1]) * np.sin(along)
        return cls(np.array(stamps), np.stack([chord / np.sinc(turn / (2 * pi)), turn], axis=1))

    def part(self, first: int, last: int) -> "RawTrack":
        """Return the track from one of its poses to another."""
        return RawTrack(self.stamps[first : last + 1], self.steps[first:last])

    @property
    def way(self) -> float:
        """How far it leads, forwards and backwards added [m]."""
        return float(np.abs(self.steps[:, 0]).sum())

    @property
    def turn(self) -> float:
        """How far it turns, left and right added [rad]."""
        return float(np.abs(self.steps[:, 1]).sum())

    def poses(self, correction: OdometryCorrection, wheel_base: float) -> Float:
        """Return the corrected poses [m, rad], shape (N + 1, 3), of which the first is the origin.

        Headings go on beyond a full turn.
        """
        ways, turns = matrix_of(correction, wheel_base) @ self.steps.T
        headings = np.concatenate([[0.0], np.cumsum(turns)])
        along = headings[:-1] + turns / 2
        chords = ways * np.sinc(turns / (2 * pi))
        x = np.concatenate([[0.0], np.cumsum(chords * np.cos(along))])
        y = np.concatenate([[0.0], np.cumsum(chords * np.sin(along))])
        return np.stack([x, y, headings], axis=1)


def matrix_of(correction: OdometryCorrection, wheel_base: float) -> Float:
    """Return the map from counted ways and turns to true ones, shape (2, 2)."""
    ratios = correction.scale, correction.base_ratio, correction.wheel_ratio
    return np.array(true_of_measured(*ratios, wheel_base)).reshape(2, 2)


def square(side: float, *, left: bool) -> RawTrack:
    """Return a square as odometry sees it: four sides [m], and a corner after each of them."""
    corner = (0.0, pi / 2 if left else -pi / 2)
    return RawTrack(np.arange(9.0), np.array([(side, 0.0), corner] * 4))
