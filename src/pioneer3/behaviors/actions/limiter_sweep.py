"""No faster into what the robot's own outline would meet, corners and memory included."""

from dataclasses import dataclass
from itertools import chain
from math import atan2, hypot, inf, radians, sqrt

from pioneer3.behaviors.desire import Desire
from pioneer3.behaviors.situation import Situation
from pioneer3.behaviors.surroundings import Point, Recall
from pioneer3.geometry import TURN, wrap
from pioneer3.models import RobotModel

UNSURE = radians(20)
"""How far off its axis a sonar's echo may come from, and what wheels that slip make of a turn."""


@dataclass(slots=True)
class LimiterSweep:
    """Slows the robot down before it meets what it sees or has seen; never below a creep.

    Not one of ARIA's, whose limiters look ahead only, at what is seen now: things that sonars have
    lost and corners of a turning robot are what it runs into. Because memory may be wrong, a robot
    may always go on at a creep, at which touching something does no harm.

    Attributes:
        creep: Speed at which any point of the robot may meet something [m/s].
        margin: Kept beside and before the robot [m].
        deceleration: The speed ahead is what this can end in time [m/s^2].
        turn_time: It takes at least this long to turn until something is met [s].
    """

    creep: float = 0.04
    margin: float = 0.05
    deceleration: float = 0.3
    turn_time: float = 1.2
    name: str = "limiter sweep"

    def decide(self, situation: Situation) -> Desire | None:
        """Return limits of the speed forwards and of both turns, or `None`."""
        model, around = situation.model, situation.around
        corner = hypot(max(model.length_front, model.length_rear), model.width / 2)
        side, reach = model.width / 2 + self.margin, corner + self.margin
        ahead, left, right = inf, inf, inf
        for point in chain(around.points(Recall.LATELY), around.points(Recall.REMEMBERED)):
            x, y, distance, _ = point
            if 0 < x < ahead and -side < y < side:
                ahead = x
            if distance < reach:
                to_left, to_right = self._turns_to(point, model)
                left, right = min(left, to_left), min(right, to_right)
        gap = ahead - model.length_front
        fastest = sqrt(2 * self.deceleration * max(0.0, gap - self.margin))
        slowed = fastest < situation.limits.max_speed
        if not slowed and left == right == inf:
            return None
        return Desire(
            v_max=max(self.creep, fastest) if slowed else None,
            left_max=self._rate(left, corner),
            right_max=self._rate(right, corner),
            reason=f"{gap:.2f} m ahead" if slowed else "a corner is near something",
        )

    def _rate(self, angle: float, corner: float) -> float | None:
        return max(self.creep / corner, angle / self.turn_time) if angle < inf else None

    def _turns_to(self, point: Point, model: RobotModel) -> tuple[float, float]:
        """Return how far [rad] the robot can turn left, and right, until it meets `point`."""
        left = right = inf
        for x in (model.length_front, -model.length_rear):
            for y in (model.width / 2, -model.width / 2):
                if point.distance < hypot(x, y) + self.margin:
                    between = wrap(point.bearing - atan2(y, x))
                    left = min(left, max(0.0, between % TURN - UNSURE))
                    right = min(right, max(0.0, -between % TURN - UNSURE))
        return left, right
