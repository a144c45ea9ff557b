"""Finds out from scans and odometry how far a laser is turned from where it is said to look."""

from math import cos, degrees, sin, sqrt

from pioneer3.arrays import Float
from pioneer3.geometry import Pose2

STRAIGHT_TURN = 0.1
"""Turn below which a way tells where a laser looks [rad]."""
MOST_ASKEW = 0.2
"""Angle of a laser from where it is said to look at most [rad]."""
LEAST_ASKEW = 0.01
"""Angle of a laser from where it is said to look from which on that is worth a remark [rad]."""
FEWEST_WAYS = 40
"""Ways from which on the angle of a laser may be certain."""
ASKEW_SIGMAS = 5.0
"""Standard deviations of the angle of a laser from which on it is certain."""
MOUNTING_WEIGHT = 0.5
"""Weight against all ways that a laser looks where it is said to [m^2]: about two metres."""


class LearnedMounting:
    """Finds out how far a laser is turned from where it is said to look.

    A robot that drives ahead moves aside in the scans of such a laser. The prior of odometry would
    pull it back at each scan, and bend straight walls.
    """

    def __init__(self) -> None:
        self._along, self._aside = MOUNTING_WEIGHT, 0.0
        self._squares, self._ways = 0.0, 0

    @property
    def angle(self) -> float:
        """[rad]; positive if it is turned to the left."""
        return self._aside / self._along

    @property
    def is_certain(self) -> bool:
        """Whether the laser is certainly turned by more than is worth a word."""
        if self._ways < FEWEST_WAYS:
            return False
        variance = max(0.0, self._squares / self._along - self.angle**2) / self._ways
        return abs(self.angle) > max(LEAST_ASKEW, ASKEW_SIGMAS * sqrt(variance))

    def take(self, odometry: Pose2, step: Pose2) -> None:
        """Learn from a way by odometry that is known by scans as `step`."""
        if max(abs(odometry.theta), abs(step.theta)) > STRAIGHT_TURN:
            return
        # along the chords, as turns may be told wrong
        half = (step.theta - odometry.theta) / 2
        c, s = cos(half), sin(half)
        x, y = c * odometry.x - s * odometry.y, s * odometry.x + c * odometry.y
        along, aside = step.x * x + step.y * y, step.x * y - step.y * x
        if abs(aside) < MOST_ASKEW * along:
            self._along += along
            self._aside += aside
            self._squares += aside**2 / along
            self._ways += 1

    def seen(self, odometry: Pose2, origin: Float) -> Pose2:
        """Return a way by odometry as it is in the scans of a laser at `origin` (2,) [m]."""
        x, y = origin.tolist()
        turned = Pose2(x, y, self.angle) @ Pose2(-x, -y)
        return turned.inverse() @ odometry @ turned

    def remark(self, laser: Pose2) -> str | None:
        """Return a sentence, without a final stop, if a laser looks elsewhere than said.

        It is said to be at the pose `laser` on the robot.
        """
        if not self.is_certain:
            return None
        side = "left" if self.angle > 0 else "right"
        pose = f"{laser.x:g},{laser.y:g},{degrees(laser.theta + self.angle):.1f}"
        looks = f"the laser looks {degrees(abs(self.angle)):.1f} degrees to the {side} of where it"
        return f"{looks} is said to; --laser-pose {pose} mends it"
