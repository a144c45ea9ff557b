"""Drive a distance straight ahead."""

from dataclasses import dataclass, field
from math import cos, sin

from pioneer3.behaviors.desire import Desire
from pioneer3.behaviors.profile import approach
from pioneer3.behaviors.situation import Situation
from pioneer3.geometry import Pose2, wrap

KEEP_HEADING = 1.5
"""Turn rate per heading error [1/s]."""


@dataclass(slots=True, kw_only=True)
class Move:
    """Drive `distance` [m] along the heading at the start; negative is backwards.

    Attributes:
        speed: Top speed [m/s].
        deceleration: What the robot can do [m/s^2].
        tolerance: Near enough [m].
    """

    distance: float
    speed: float
    deceleration: float
    tolerance: float = 0.005
    name: str = "move"
    done: bool = False
    _start: Pose2 | None = field(default=None, init=False)

    def decide(self, situation: Situation) -> Desire | None:
        """Return the speed for what is left; stands still when done."""
        here = situation.pose
        start = self._start = self._start or here
        along = (here.x - start.x) * cos(start.theta) + (here.y - start.y) * sin(start.theta)
        remaining = self.distance - along
        if abs(remaining) <= self.tolerance:
            self.done = abs(situation.twist.v) < 0.01
            return Desire(v=0.0, w=0.0, reason="there")
        self.done = False
        return Desire(
            v=approach(remaining, self.speed, self.deceleration),
            w=KEEP_HEADING * wrap(start.theta - here.theta),
            reason=f"{remaining:z.2f} m to go",
        )
