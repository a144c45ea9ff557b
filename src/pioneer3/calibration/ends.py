"""Ends of runs: how far from its beginning a robot was in truth, and how well that is known."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import hypot, inf, isfinite

import numpy as np

from pioneer3.arrays import Float
from pioneer3.calibration.track import RawTrack
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.models import OdometryCorrection

WAY_NOISE = 0.004
"""Chance error of a way by wheels, by its root [m^0.5] (docs/explanation/realism.md)."""
TURN_NOISE = 0.01
"""Chance error of a turn by wheels, by its root [rad^0.5]."""
DRIFT_NOISE = 0.008
"""Chance error of the heading by the root of the way [rad/m^0.5]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MeasuredRun:
    """A run, and its measured end in the frame of its beginning.

    Attributes:
        track: As the wheels counted it.
        end: True x, y [m] and turn [rad]; NaN where it was not measured. A turn goes on beyond a
            full one.
        sigma: Standard deviations of these.
        begin_sigma: Standard deviation of the heading at the beginning [rad].
        of_laser: Whether the end is that of the laser, in the frame of its own beginning.
        name: For people.
    """

    track: RawTrack
    end: Sequence[float]
    sigma: Sequence[float]
    begin_sigma: float = 0.0
    of_laser: bool = False
    name: str = "run"
    _whiten: Float = field(init=False)

    def __post_init__(self) -> None:
        """Work out how much each number is worth."""
        object.__setattr__(self, "_whiten", np.linalg.inv(np.linalg.cholesky(self._covariance())))

    @property
    def measured(self) -> list[int]:
        """Which of x, y and turn were measured."""
        return [i for i in range(3) if isfinite(self.end[i]) and self.sigma[i] < inf]

    def off(
        self, correction: OdometryCorrection, wheel_base: float, laser: Pose2 = ORIGIN
    ) -> Float:
        """Return the distance of odometry from the end [m, rad]; NaN where it was not measured.

        `laser` is the place of the laser on the robot.
        """
        x, y, turn = self.track.poses(correction, wheel_base)[-1].tolist()
        if self.of_laser:
            seen = laser.inverse() @ Pose2(x, y, turn) @ laser
            x, y = seen.x, seen.y
        off: Float = np.array([x, y, turn]) - np.array(self.end, dtype=np.float64)
        return off

    def residuals(
        self, correction: OdometryCorrection, wheel_base: float, laser: Pose2 = ORIGIN
    ) -> Float:
        """Return the same in standard deviations, independent of each other."""
        whitened: Float = self._whiten @ self.off(correction, wheel_base, laser)[self.measured]
        return whitened

    def _covariance(self) -> Float:
        """Return that of the measured numbers: of the tape, the beginning, and the wheels."""
        rough = self.track.poses(OdometryCorrection(), 1.0)
        x, y, _ = rough[-1].tolist()
        way, turn = self.track.way, self.track.turn
        aside = np.array([-y, x, 0.0])
        away = float(np.mean(np.hypot(*(rough[:, :2] - rough[-1, :2]).T)))
        heading = TURN_NOISE**2 * turn + DRIFT_NOISE**2 * way
        place = WAY_NOISE**2 * way + heading * max(away, hypot(x, y) / 2) ** 2
        full = np.diag(np.square(self.sigma) + np.array([place, place, heading]))
        full += self.begin_sigma**2 * np.outer(aside, aside)
        kept = self.measured
        return full[np.ix_(kept, kept)]
