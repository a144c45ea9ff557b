"""Turn away from what is beside the robot."""

from dataclasses import dataclass, field
from math import radians

from pioneer3.behaviors.actions.reasons import beside
from pioneer3.behaviors.desire import Desire
from pioneer3.behaviors.situation import Situation
from pioneer3.behaviors.surroundings import Recall

FROM, TO = radians(60), radians(120)


@dataclass(slots=True)
class AvoidSide:
    """Stands and turns away from what is near beside the robot (arcos.md 7.6).

    When that is done it wants straight ahead once, as :class:`AvoidFront` does. ARIA's goes on
    wanting it for ever, and nothing of lower priority steers any more.

    Attributes:
        obstacle_distance: Nearer than this to the robot's circle is near [m].
        turn_amount: [rad].
    """

    obstacle_distance: float = 0.3
    turn_amount: float = radians(5)
    name: str = "avoid side"
    _turning: bool = field(default=False, init=False)

    def decide(self, situation: Situation) -> Desire | None:
        """Return the turn; the left side is looked at first."""
        radius = situation.model.radius
        for side, start, end, sign in (("left", FROM, TO, -1), ("right", -TO, -FROM, 1)):
            distance = situation.around.nearest(start, end, Recall.LATELY).distance - radius
            if distance < self.obstacle_distance:
                self._turning = True
                return Desire(v=0.0, turn=sign * self.turn_amount, reason=beside(distance, side))
        if not self._turning:
            return None
        self._turning = False
        return Desire(turn=0.0, reason="the sides are free")
