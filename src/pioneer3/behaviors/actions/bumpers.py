"""Back off from what a bumper touches."""

from dataclasses import dataclass, field
from math import inf, radians

from pioneer3.behaviors.desire import Desire
from pioneer3.behaviors.memory import BUMPER_ARC
from pioneer3.behaviors.situation import Situation
from pioneer3.geometry import wrap

MOVING = 0.025
"""Slower [m/s] is standing."""
JUST_NOW = 1.0
"""Who moved so recently [s] was moving when it hit: our driver and the wall stop it at once."""
ARRIVED = radians(3)


@dataclass(slots=True)
class Bumpers:
    """Backs off and turns away when a bumper is hit (arcos.md 7.6).

    ARIA's asks for a robot that still moves while the bumper is pressed. Ours has been stopped by
    then, by what it hit and by the last limits before the wire; so it counts which way it moved a
    moment ago.

    Attributes:
        back_off_speed: [m/s].
        back_off_time: [s].
        turn_time: Longest turn afterwards [s].
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
        self._notice_motion(situation)
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

    def _notice_motion(self, situation: Situation) -> None:
        v = situation.twist.v
        if abs(v) > MOVING:
            self._moved = (1 if v > 0 else -1, situation.now)

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
