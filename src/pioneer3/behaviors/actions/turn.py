"""Turn on the spot by an angle."""

from dataclasses import dataclass, field
from math import degrees, radians

from pioneer3.behaviors.desire import Desire
from pioneer3.behaviors.profile import approach
from pioneer3.behaviors.situation import Situation
from pioneer3.geometry import wrap

SLOWEST = radians(2)
"""Wheels of a standing robot stick below this [rad/s]; commands are whole degrees."""


@dataclass(slots=True, kw_only=True)
class Turn:
    """Turn by `angle` [rad], counter-clockwise positive; more than a full turn is possible.

    Attributes:
        rate: Top turn rate [rad/s].
        deceleration: What the robot can do [rad/s^2].
        tolerance: Near enough [rad].
    """

    angle: float
    rate: float
    deceleration: float
    tolerance: float = radians(0.7)
    name: str = "turn"
    done: bool = False
    _turned: float = field(default=0.0, init=False)
    _last: float | None = field(default=None, init=False)

    def decide(self, situation: Situation) -> Desire | None:
        """Return the turn rate for what is left; stands still when done."""
        theta = situation.pose.theta
        if self._last is not None:
            self._turned += wrap(theta - self._last)
        self._last = theta
        remaining = self.angle - self._turned
        if abs(remaining) <= self.tolerance:
            self.done = abs(situation.twist.w) < SLOWEST
            return Desire(v=0.0, w=0.0, reason="there")
        self.done = False
        rate = approach(remaining, self.rate, self.deceleration)
        if abs(rate) < SLOWEST:
            rate = SLOWEST if rate > 0 else -SLOWEST
        return Desire(v=0.0, w=rate, reason=f"{degrees(remaining):z.0f} deg to go")
