"""Turn when something above has slowed the robot down."""

from dataclasses import dataclass, field
from math import radians

from pioneer3.behaviors.actions.reasons import ahead
from pioneer3.behaviors.desire import Desire
from pioneer3.behaviors.situation import Situation

SIDE = radians(90)
LOOK = 3.0
"""Farther away [m] nothing decides the side."""


@dataclass(slots=True)
class TurnAway:
    """Turns the more, the slower the robot has become (ARIA's Turn, arcos.md 7.6).

    Below limiters of the speed it steers around what made them slow down. The side stays until the
    robot is fast again.

    Attributes:
        speed_start: Slower than this it turns [m/s].
        speed_full: Slower than this it turns in full [m/s].
        turn_amount: Full turn, ahead of the present heading [rad].
    """

    speed_start: float = 0.2
    speed_full: float = 0.1
    turn_amount: float = radians(15)
    name: str = "turn away"
    _side: int = field(default=0, init=False)

    def decide(self, situation: Situation) -> Desire | None:
        """Return the turn; nothing at speed."""
        v = situation.twist.v
        if v > self.speed_start:
            self._side = 0
            return None
        amount = self.turn_amount
        if v >= self.speed_full:
            amount *= (self.speed_start - v) / (self.speed_start - self.speed_full)
        echo = situation.around.nearest(-SIDE, SIDE)
        near = echo.distance < LOOK
        self._side = self._side or (-1 if near and echo.bearing > 0 else 1)
        reason = ahead(echo.distance - situation.model.radius, echo) if near else "slow"
        return Desire(turn=self._side * amount, reason=reason)
