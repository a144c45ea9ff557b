"""Actions that turn away from obstacles, and from contacts of bumpers."""

from dataclasses import dataclass, field
from math import inf, pi, radians

from pioneer3.behaviors.action import Action, Desire, Situation
from pioneer3.behaviors.actions.sensing import BLIND, TableSensors, ahead, table_seen
from pioneer3.behaviors.engine import TURNED
from pioneer3.behaviors.memory import BUMPER_ARC
from pioneer3.behaviors.surroundings import Buffer, Echo
from pioneer3.geometry import wrap

FRONT = radians(70)
"""Bearing up to which obstacles are in front [rad]."""


@dataclass(slots=True)
class AvoidFront(Action):
    """Turns on, always the same way, until nothing is near in front (facts.md 7.6).

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
            return Desire(v=0.0, turn=0.0, lacks=True, reason=BLIND)
        echo = situation.around.nearest(-FRONT, FRONT, Buffer.WINDOW)
        distance = echo.distance - situation.model.radius
        table = table_seen(situation) if self.use_table_sensor else TableSensors()
        if distance > self.obstacle_distance and not table:
            if not self._turning:
                return None
            self._turning = 0
            return Desire(turn=0.0, reason="the way is free")
        if not self._turning:
            self._turning = _side_to_turn(echo, table)
            self._amount = self.turn_amount
            self._quadrants.clear()
        self._look_around(situation.pose.theta)
        return Desire(
            v=0.0 if table else self._speed(distance),
            turn=self._turning * self._amount,
            reason=str(table) if table else ahead(distance, echo),
        )

    def _look_around(self, theta: float) -> None:
        self._quadrants.add(int((wrap(theta) + pi) // (pi / 2)) % 4)
        if len(self._quadrants) == 4:
            self._quadrants.clear()
            self._amount /= 2
            if self._amount < TURNED:
                self._amount = self.turn_amount

    def _speed(self, distance: float) -> float:
        if distance <= self.obstacle_distance / 2:
            return 0.0
        return self.avoid_velocity * distance / self.obstacle_distance


def _side_to_turn(echo: Echo, table: TableSensors) -> int:
    """Return 1 to turn left, -1 to turn right."""
    if table:
        return 1 if table.left else -1
    return 1 if echo.bearing < 0 else -1


STANDING_SPEED = 0.025
"""Speed below which a robot stands [m/s]."""
JUST_NOW = 1.0
"""A robot that moved so recently [s] was moving at the hit: driver and wall stop it at once."""
ARRIVED = radians(3)
"""Angle to its heading within which a turn is done [rad]."""


@dataclass(slots=True)
class Bumpers(Action):
    """Backs off and turns away when a bumper is hit (facts.md 7.6).

    ARIA's asks for a robot that still moves while the bumper is pressed. Ours has been stopped by
    then, by what it hit and by the last limits before the wire; so it counts which way it moved a
    moment ago.

    The turn afterwards takes `turn_time` [s] at most.
    """

    back_off_speed: float = 0.1
    back_off_time: float = 3.0
    turn_time: float = 3.0
    name: str = "bumpers"
    _v: float = field(default=0.0, init=False)
    _began: float = field(default=-inf, init=False)
    _target: float = field(default=0.0, init=False)
    _moved: tuple[int, float] = field(default=(0, -inf), init=False)

    def decide(self, situation: Situation) -> Desire | None:
        """Return the way back, then the turn away."""
        v = situation.twist.v
        if abs(v) > STANDING_SPEED:
            self._moved = (1 if v > 0 else -1, situation.now)
        if not self._v:
            return self._hit(situation)
        since = situation.now - self._began
        if since < self.back_off_time:
            return self._back_off(situation)
        left = wrap(self._target - situation.pose.theta)
        if since < self.back_off_time + self.turn_time and abs(left) > ARRIVED:
            return Desire(v=0.0, heading=self._target, reason="turning away from what was hit")
        self._v = 0.0
        return None

    def _hit(self, situation: Situation) -> Desire | None:
        way, when = self._moved
        bumpers = situation.snapshot.bumpers
        hit = bumpers.front if way > 0 else bumpers.rear
        if situation.now - when > JUST_NOW or not any(hit):
            return None
        self._v = -way * self.back_off_speed
        self._began = situation.now
        self._target = wrap(situation.pose.theta + way * _turn(hit))
        side = "front" if way > 0 else "rear"
        return Desire(v=self._v, heading=self._target, reason=f"the {side} bumper was hit")

    def _back_off(self, situation: Situation) -> Desire:
        bumpers = situation.snapshot.bumpers
        if any(bumpers.rear if self._v < 0 else bumpers.front):
            return Desire(v=0.0, turn=0.0, reason="bumpers hit on both ends")
        return Desire(v=self._v, turn=0.0, reason="backing off from what was hit")


def _turn(hit: tuple[bool, ...]) -> float:
    """Return how far to turn [rad]: the more, the nearer the hit was to the middle."""
    n = len(hit)
    angles = [(i + 0.5) * BUMPER_ARC / n - BUMPER_ARC / 2 for i in range(n) if hit[i]]
    mean = sum(angles) / len(angles)
    return -(BUMPER_ARC / 2 + mean) if mean < 0 else BUMPER_ARC / 2 - mean
