"""Turn away from what is in front."""

from dataclasses import dataclass, field
from math import pi, radians

from pioneer3.behaviors.actions.reasons import BLIND, ahead
from pioneer3.behaviors.actions.table import Table, table_seen
from pioneer3.behaviors.desire import Desire
from pioneer3.behaviors.engine import TURNED
from pioneer3.behaviors.situation import Situation
from pioneer3.behaviors.surroundings import Echo, Recall
from pioneer3.geometry import wrap

FRONT = radians(70)


@dataclass(slots=True)
class AvoidFront:
    """Turns on, always the same way, until nothing is near in front (arcos.md 7.6).

    When it has looked into all four quadrants and found no way out, it goes on in half the steps;
    once they are too small to be carried out, in whole ones again.

    Attributes:
        obstacle_distance: Nearer than this to the robot's circle is near [m].
        avoid_velocity: Speed at that distance [m/s], less when nearer, none within half of it.
        turn_amount: How far ahead of the present heading it aims [rad].
        use_table_sensor: Whether tables count, where the robot can see them.
    """

    obstacle_distance: float = 0.45
    avoid_velocity: float = 0.2
    turn_amount: float = radians(15)
    use_table_sensor: bool = True
    name: str = "avoid front"
    _turning: int = field(default=0, init=False)
    _amount: float = field(default=0.0, init=False)
    _quadrants: set[int] = field(default_factory=set, init=False)

    def decide(self, situation: Situation) -> Desire | None:
        """Return the next step of the turn; straight ahead once when the way is free again."""
        if situation.higher.strength("turn") >= 1:
            self._turning = 0
        if not situation.around.sensing:
            return Desire(v=0.0, turn=0.0, reason=BLIND)
        echo = situation.around.nearest(-FRONT, FRONT, Recall.LATELY)
        distance = echo.distance - situation.model.radius
        table = table_seen(situation) if self.use_table_sensor else Table()
        if distance > self.obstacle_distance and not table:
            if not self._turning:
                return None
            self._turning = 0
            return Desire(turn=0.0, reason="the way is free")
        if not self._turning:
            self._turning = _away(echo, table)
            self._amount = self.turn_amount
            self._quadrants.clear()
        self._look_around(situation.pose.theta)
        return Desire(
            v=0.0 if table else self._speed(distance),
            turn=self._turning * self._amount,
            reason=str(table) if table else ahead(distance, echo),
        )

    def _look_around(self, theta: float) -> None:
        self._quadrants.add(_quadrant(theta))
        if len(self._quadrants) == 4:
            self._quadrants.clear()
            self._amount /= 2
            if self._amount < TURNED:
                self._amount = self.turn_amount

    def _speed(self, distance: float) -> float:
        if distance <= self.obstacle_distance / 2:
            return 0.0
        return self.avoid_velocity * distance / self.obstacle_distance


def _away(echo: Echo, table: Table) -> int:
    """Return 1 to turn left, -1 to turn right."""
    if table:
        return 1 if table.left else -1
    return 1 if echo.bearing < 0 else -1


def _quadrant(theta: float) -> int:
    return int((wrap(theta) + pi) // (pi / 2)) % 4
