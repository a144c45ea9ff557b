"""Poses as arrays, how odometry moves them, and particles: weighed guesses of one pose."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot

import numpy as np
from numpy.random import Generator

from pioneer3.arrays import Float
from pioneer3.geometry import Pose2, wrap


@dataclass(frozen=True, slots=True, kw_only=True)
class MotionErrors:
    """Standard deviations of a motion by odometry: of its way [m], and of its turn [rad, rad/m].

    The slip of skid-steered wheels is no noise: a P3-AT loses 5 % of every turn. Particles have to
    reach so far each time.
    """

    way: float = 0.008
    way_share: float = 0.03
    turn: float = 0.01
    turn_share: float = 0.06
    turn_per_way: float = 0.02

    def spread(self, motion: Pose2) -> tuple[float, float]:
        """Return the standard deviations of a motion's way [m] and turn [rad]."""
        way, turn = hypot(motion.x, motion.y), abs(motion.theta)
        return (
            hypot(self.way, self.way_share * way),
            hypot(self.turn, self.turn_share * turn + self.turn_per_way * way),
        )


def array_of(pose: Pose2) -> Float:
    """Return a pose as an array, shape (3,)."""
    return np.array([pose.x, pose.y, pose.theta])


def rows_of(poses: Sequence[Pose2]) -> Float:
    """Return poses as the rows of an array, shape (N, 3)."""
    return np.array([(pose.x, pose.y, pose.theta) for pose in poses]).reshape(-1, 3)


def pose_of(values: Float) -> Pose2:
    """Return the pose of an array (3,)."""
    x, y, theta = values.tolist()
    return Pose2(x, y, wrap(theta))


def moved(poses: Float, motion: Pose2) -> Float:
    """Return `poses` (P, 3) after the same motion, in the frame of each."""
    c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    x = poses[:, 0] + c * motion.x - s * motion.y
    y = poses[:, 1] + s * motion.x + c * motion.y
    return np.stack([x, y, wrapped(poses[:, 2] + motion.theta)], axis=1)


def moved_by(frame: Pose2, poses: Float) -> Float:
    """Return `poses` (N, 3) that are given in `frame` in the frame around that."""
    return np.column_stack([points_by(frame, poses[:, :2]), poses[:, 2] + frame.theta])


def points_by(frame: Pose2, points: Float) -> Float:
    """Return `points` (N, 2) that are given in `frame` in the frame around that [m]."""
    (x, y), c, s = points.T, np.cos(frame.theta), np.sin(frame.theta)
    return np.stack([frame.x + c * x - s * y, frame.y + s * x + c * y], axis=1)


def wrapped(angles: Float) -> Float:
    """Return angles [rad] between -pi and pi."""
    inside: Float = (angles + np.pi) % (2 * np.pi) - np.pi
    return inside


class Particles:
    """Weighed guesses of one pose on the map: `poses` (N, 3) [m, rad], `weights` (N,) of sum 1."""

    def __init__(self, poses: Float, rng: Generator, errors: MotionErrors) -> None:
        self.poses = poses
        self.weights = np.full(len(poses), 1 / len(poses))
        self._rng, self._errors = rng, errors

    @classmethod
    def around(
        cls, mean: Float, deviations: Float, count: int, rng: Generator, errors: MotionErrors
    ) -> "Particles":
        """Return `count` particles around a mean pose (3,), with standard deviations (3,)."""
        return cls(mean + deviations * rng.standard_normal((count, 3)), rng, errors)

    def move(self, motion: Pose2) -> None:
        """Move all by what odometry tells, each with errors of its own."""
        way, turn = self._errors.spread(motion)
        noise = self._rng.standard_normal((len(self.poses), 3))
        self.poses[:, 2] += turn / 2 * noise[:, 2]  # half before the way, half after
        self.poses = moved(self.poses, motion)
        self.poses[:, :2] += way * noise[:, :2]
        self.poses[:, 2] += turn / 2 * noise[:, 2]

    def weigh(self, costs: Float) -> None:
        """Multiply the weights by likelihoods, of which `costs` (N,) are negative logarithms."""
        weights = self.weights * np.exp(costs.min() - costs)
        self.weights = weights / weights.sum()

    def resample(self, count: int, fresh: Float | None = None) -> None:
        """Draw `count` particles by their weights, if these have become too unequal.

        Poses that are `fresh` (F, 3) take the places of some of them.
        """
        enough = 1 / (self.weights**2).sum() > 0.5 * len(self.weights)
        if enough and count == len(self.weights):
            return
        at = (np.arange(count) + self._rng.random()) / count
        chosen = np.searchsorted(np.cumsum(self.weights), at).clip(max=len(self.weights) - 1)
        self.poses = self.poses[chosen]
        self.weights = np.full(count, 1 / count)
        if fresh is not None:
            places = self._rng.permutation(count)[: len(fresh)]
            self.poses[places] = fresh[: len(places)]

    def mean(self) -> tuple[Float, Float]:
        """Return the mean pose (3,) and its covariance (3, 3)."""
        weights, poses = self.weights, self.poses
        theta = np.arctan2(weights @ np.sin(poses[:, 2]), weights @ np.cos(poses[:, 2]))
        mean = np.append(weights @ poses[:, :2], theta)
        off = poses - mean
        off[:, 2] = wrapped(off[:, 2])
        return mean, (weights[:, None] * off).T @ off
