"""Keeps track of a robot whose place is known roughly, by its laser or by its sonars."""

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

from pioneer3.arrays import Float
from pioneer3.geometry import Pose2
from pioneer3.nav.estimate import deviation_of
from pioneer3.nav.likelihood import LAST_SCALES, Agreement, ScanLikelihood
from pioneer3.nav.likelihood_sonar import EchoMap, PingLikelihood, Pings
from pioneer3.nav.particles import MotionErrors, Particles, moved_by

POSITION_FLOOR = 0.004
"""Standard deviation that no estimate is below [m]: the errors of maps."""
HEADING_FLOOR = 0.002
"""Standard deviation that no estimate of a heading is below [rad]."""
PARTICLES_PER_FRESH = 10
"""Particles of which one comes from the scan, not from the particles before."""
SONAR_PARTICLES = 1
"""Particles with sonars, in times of those with a laser."""
SONAR_BEGIN_PARTICLES = 4
"""Particles with sonars until the place is known, in times of those with a laser."""
SONAR_DEVIATION = 0.3
"""Standard deviation below which a place counts as known by sonar [m]."""
SONAR_TURN_DEVIATION = 0.15
"""Standard deviation below which a heading counts as known by sonar [rad]."""
ECHO_MEMORY = 60.0
"""Echoes that the share of those that agree is averaged over."""
UNHEARD_AGREEMENT = 0.4
"""Share before any echo: not enough to be sure, too much to be lost."""


@dataclass(frozen=True, slots=True, eq=False)
class Fix:
    """A pose on the map [m, rad], its covariance, and the share of readings that agree there."""

    pose: Float
    covariance: Float
    agreement: float


class LaserTrack:
    """Particles (N, 3) [m, rad] that scans weigh; the pose is refined by the walls around it."""

    def __init__(self, poses: Float, rng: Generator, errors: MotionErrors) -> None:
        self._count, self._rng = len(poses), rng
        self._particles = Particles(poses, rng, errors)

    def move(self, motion: Pose2) -> None:
        """Move by what odometry tells."""
        self._particles.move(motion)

    def take(self, likelihood: ScanLikelihood) -> tuple[Fix, Agreement]:
        """Weigh the particles by a scan; return the pose, and how the scan agrees with it."""
        particles = self._particles
        particles.weigh(likelihood.cost(particles.poses))
        mean, covariance = particles.mean()
        least = np.diag([POSITION_FLOOR**2, POSITION_FLOOR**2, HEADING_FLOOR**2])
        held: Float = np.linalg.inv(covariance + least).astype(np.float64)
        refined, information = likelihood.refined(mean[None], held, LAST_SCALES, all_points=True)
        known = np.linalg.inv(information[0]) + least
        spread = self._rng.standard_normal((self._count // PARTICLES_PER_FRESH, 3))
        particles.resample(self._count, refined[0] + spread @ np.linalg.cholesky(known).T)
        verdict = likelihood.judged(refined)
        return Fix(refined[0], known, float(verdict.agreement[0])), verdict


class SonarTrack:
    """Particles that pings weigh, a few reports at a time.

    The `start` is where the robot is, roughly, and the standard deviations [m, rad], both (3,);
    `count` is the number of particles that track a laser.
    """

    def __init__(
        self,
        echoes: EchoMap,
        start: tuple[Float, Float],
        count: int,
        rng: Generator,
        errors: MotionErrors,
    ) -> None:
        self._echoes, self._usual = echoes, SONAR_PARTICLES * count
        self._particles = Particles.around(*start, SONAR_BEGIN_PARTICLES * count, rng, errors)
        self._pings: list[Float] = []
        self._agreement = UNHEARD_AGREEMENT

    def listen(self, pings: Pings) -> None:
        """Keep pings until the robot has moved."""
        if len(pings.ranges):
            at = moved_by(pings.robot_in_odom, pings.mounts)
            self._pings.append(np.column_stack([at, pings.ranges]))

    def take(self, motion: Pose2, robot_in_odom: Pose2) -> Fix:
        """Move by odometry and weigh the particles by the pings since the last call."""
        particles = self._particles
        particles.move(motion)
        likelihood = None
        if self._pings:
            pings = np.concatenate(self._pings)
            pings[:, :3] = moved_by(robot_in_odom.inverse(), pings[:, :3])
            self._pings.clear()
            likelihood = PingLikelihood(self._echoes, np.ascontiguousarray(pings))
            particles.weigh(likelihood.cost(particles.poses))
        mean, covariance = particles.mean()
        known = is_known(covariance)
        if known and likelihood is not None:
            self._remember(likelihood, mean)
        particles.resample(self._usual if known else len(particles.poses))
        return Fix(mean, covariance, self._agreement)

    def _remember(self, likelihood: PingLikelihood, pose: Float) -> None:
        agree, heard = likelihood.agreeing(pose)
        share = min(1.0, heard / ECHO_MEMORY)
        if heard:
            self._agreement += share * (agree / heard - self._agreement)


def is_known(covariance: Float) -> bool:
    """Return whether a place with this covariance (3, 3) counts as known by sonar."""
    turn = float(covariance[2, 2]) ** 0.5
    return deviation_of(covariance) < SONAR_DEVIATION and turn < SONAR_TURN_DEVIATION
