"""The correction that fits all runs best, and whether it is better than chance."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np

from pioneer3.arrays import Float
from pioneer3.calibration.ends import MeasuredRun
from pioneer3.calibration.track import RawTrack, matrix_of, square
from pioneer3.geometry import ORIGIN, Pose2, wrap
from pioneer3.models import OdometryCorrection
from pioneer3.models.odometry import GREATEST_RATIO, LEAST_RATIO, UNCORRECTED

NAMES = ("scale", "base_ratio", "wheel_ratio")
USUAL_ERROR = 0.2
"""Standard deviation of a ratio's logarithm before anything was measured."""
LASER_ERROR = 0.1
"""Standard deviation of the place of a laser before [m]."""
LASER_TURN_ERROR = 0.1
"""Standard deviation of where it looks before [rad]."""
KNOWN = 0.02
"""Standard deviation of a ratio above which nobody knows it."""
CERTAIN = 7.81
"""Quantile of the chi-squared distribution with three degrees of freedom, at 95 %."""
STEP = 1e-6
"""Change of a parameter by which derivatives are told."""
ROUNDS = 30
SETTLED = 1e-9
"""Change of all parameters at which a fit ends."""
SHOWN_SIDE = 4.0
"""Side of the square by which errors are told [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """Parameters (N,) that fit best, with their covariance (N, N) and the residuals' squares."""

    parameters: Float
    covariance: Float
    squares: float


def fit(residuals: Callable[[Float], Float], sigma: Float) -> Fit:
    """Return the least squares of `residuals` over parameters, which are 0 within `sigma` before.

    Derivatives are those of small steps; it is the method of Gauss and Newton, damped.
    """

    def all_of(parameters: Float) -> Float:
        return np.concatenate([residuals(parameters), parameters / sigma])

    here = np.zeros(len(sigma))
    now = all_of(here)
    slopes = _slopes(all_of, here, now)
    for _ in range(ROUNDS):
        step = np.linalg.lstsq(slopes, -now, rcond=None)[0]
        there = all_of(here + step)
        while there @ there > now @ now * (1 + SETTLED) and np.abs(step).max() > SETTLED:
            step, there = step / 2, all_of(here + step / 2)
        here, now = here + step, there
        slopes = _slopes(all_of, here, now)
        if np.abs(step).max() < SETTLED:
            break
    measured = now[: -len(sigma)]
    covariance: Float = np.linalg.inv(slopes.T @ slopes).astype(np.float64)
    return Fit(here, covariance, float(measured @ measured))


def _slopes(function: Callable[[Float], Float], at: Float, value: Float) -> Float:
    steps = STEP * np.eye(len(at))
    return np.stack([(function(at + step) - value) / STEP for step in steps], axis=1)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CorrectionEstimate:
    """A correction by measurement.

    Attributes:
        correction: That fits best.
        before: The one in force while the robot was measured.
        wheel_base: Distance of the wheels that the controller takes [m].
        covariance: Of the logarithms of the three ratios, in the order of `NAMES`, shape (3, 3).
        laser: Place of the laser on the robot; `None` if no run tells it.
        laser_sigma: Its standard deviations [m, m, rad].
    """

    correction: OdometryCorrection
    before: OdometryCorrection
    wheel_base: float
    covariance: Float
    laser: Pose2 | None = None
    laser_sigma: tuple[float, ...] = ()

    @property
    def is_certain(self) -> bool:
        """Whether it differs from the one before by more than chance would, 19 times in 20."""
        off = logarithms(self.correction) - logarithms(self.before)
        return bool(off @ np.linalg.solve(self.covariance, off) > CERTAIN)

    @property
    def is_known(self) -> bool:
        """Whether the runs tell all three ratios."""
        return max(self.sigmas) < KNOWN

    @property
    def sigmas(self) -> tuple[float, ...]:
        """Standard deviations of the three ratios."""
        ratios = np.exp(logarithms(self.correction))
        return tuple((np.sqrt(np.diag(self.covariance)) * ratios).tolist())

    def return_error(
        self, correction: OdometryCorrection, side: float = SHOWN_SIDE
    ) -> tuple[float, float]:
        """Return how far from its beginning a square ends by a correction, and the spread [m].

        It is the larger error of the two ways around, as UMBmark counts.
        """
        mean = logarithms(self.correction)
        roots = sqrt(3) * np.linalg.cholesky(self.covariance).T
        errors = [
            max(
                _return(correction_of(each), correction, self.wheel_base, side, left=left)
                for left in (True, False)
            )
            for root in roots
            for each in (mean + root, mean - root)
        ]
        return float(np.mean(errors)), float(np.std(errors))


def estimate(
    runs: Sequence[MeasuredRun],
    wheel_base: float,
    before: OdometryCorrection = UNCORRECTED,
    laser: Pose2 = ORIGIN,
) -> CorrectionEstimate:
    """Return the correction, and the place of the laser, that fit `runs` best.

    Ratios that no run tells stay as they are in `before`, the correction that is in force; so does
    the `laser`, which is said to be there on the robot.
    """
    known = logarithms(before)

    def residuals(change: Float) -> Float:
        correction, place = correction_of(known + change[:3]), _moved(laser, change[3:])
        return np.concatenate([run.residuals(correction, wheel_base, place) for run in runs])

    found = fit(residuals, np.array([USUAL_ERROR] * 3 + [LASER_ERROR] * 2 + [LASER_TURN_ERROR]))
    free = sum(len(run.measured) for run in runs) - 3
    worse = max(1.0, found.squares / free) if free > 0 else 1.0
    covariance = found.covariance * worse
    seen = any(run.of_laser for run in runs)
    return CorrectionEstimate(
        correction=correction_of(known + found.parameters[:3]),
        before=before,
        wheel_base=wheel_base,
        covariance=covariance[:3, :3],
        laser=_moved(laser, found.parameters[3:]) if seen else None,
        laser_sigma=tuple(np.sqrt(np.diag(covariance)[3:]).tolist()),
    )


def _moved(place: Pose2, by: Float) -> Pose2:
    x, y, theta = by.tolist()
    return Pose2(place.x + x, place.y + y, wrap(place.theta + theta))


def logarithms(correction: OdometryCorrection) -> Float:
    """Return those of the three ratios, in the order of `NAMES`."""
    return np.log([getattr(correction, name) for name in NAMES])


def correction_of(values: Float) -> OdometryCorrection:
    """Return the correction that has these logarithms, within what a file may say."""
    ratios = np.clip(np.exp(values), LEAST_RATIO, GREATEST_RATIO).tolist()
    return OdometryCorrection(**dict(zip(NAMES, ratios, strict=True)))


def _return(
    truth: OdometryCorrection,
    believed: OdometryCorrection,
    wheel_base: float,
    side: float,
    *,
    left: bool,
) -> float:
    """Return how far from its beginning a square ends of a robot that corrects as it believes."""
    wanted = square(side, left=left)
    counted: Float = np.linalg.solve(matrix_of(believed, wheel_base), wanted.steps.T).T.astype(
        np.float64
    )
    x, y, _ = RawTrack(wanted.stamps, counted).poses(truth, wheel_base)[-1].tolist()
    return float(np.hypot(x, y))
