"""As fast as still can be stopped in time, and as near as slow driving allows."""

from dataclasses import dataclass
from math import inf, sqrt

from pioneer3.behaviors.actions.reasons import BLIND, ahead, behind
from pioneer3.behaviors.desire import Desire
from pioneer3.behaviors.situation import Situation
from pioneer3.behaviors.surroundings import Recall

FAR = 16.0
"""How far beyond the padding it looks [m]."""
OTHER_WAY = 0.1
"""Faster than this [m/s] the other way it is not asked."""
INSIDE = 0.001
MOVING, FAST = 0.005, 0.1
TOP = 2.0
"""Harder brakes no Pioneer (arcos.md 5.1) [m/s^2]."""


@dataclass(slots=True, kw_only=True)
class DeceleratingLimiter:
    """Limits the speed one way so that the robot can stop before what is there (arcos.md 7.6).

    The room it keeps grows with the speed. Outside of it the speed may be as high as
    `preferred_decel` can end in time, `reaction` after it was seen. ARIA says speed 0 at that
    distance and lets the deceleration make the curve, with no time to react. Our driver brakes
    harder than ARIA's by itself: the robot would stop and start over and over on its way, and from
    rest it might speed up at any distance.

    Attributes:
        backwards: Which way.
        clearance: Kept in any case ahead of the robot [m].
        side_clearance_at_slow_speed: Kept beside it [m].
        side_clearance_at_fast_speed: [m].
        padding_at_slow_speed: Kept ahead beyond `clearance` [m].
        padding_at_fast_speed: [m].
        slow_speed: At and below it the former of two hold [m/s]; between the speeds, in proportion.
        fast_speed: At and above it the latter hold [m/s].
        preferred_decel: [m/s^2].
        reaction: From an echo until the robot obeys [s]: a report's cycle and 0.3 s each way, as
            over a bad radio link.
        emergency_decel: When something is nearer than `clearance` [m/s^2]; 0 for the robot's own.
    """

    backwards: bool = False
    clearance: float = 0.1
    side_clearance_at_slow_speed: float = 0.05
    side_clearance_at_fast_speed: float = 0.4
    padding_at_slow_speed: float = 0.05
    padding_at_fast_speed: float = 0.3
    slow_speed: float = 0.2
    fast_speed: float = 1.0
    preferred_decel: float = 0.6
    reaction: float = 0.7
    emergency_decel: float = 0.0
    name: str = ""

    def __post_init__(self) -> None:
        if not self.name:
            self.name = f"decelerating limiter {'backwards' if self.backwards else 'forwards'}"

    def decide(self, situation: Situation) -> Desire | None:
        """Return the limit; without range sensors, no motion."""
        v = -situation.twist.v if self.backwards else situation.twist.v
        if v < -OTHER_WAY:
            return None
        if not situation.around.sensing:
            return self._limit(0.0, BLIND)
        share = min(1.0, max(0.0, (abs(v) - self.slow_speed) / (self.fast_speed - self.slow_speed)))
        side = _between(share, self.side_clearance_at_slow_speed, self.side_clearance_at_fast_speed)
        padding = _between(share, self.padding_at_slow_speed, self.padding_at_fast_speed)
        inside, reason = self._room(situation, self.side_clearance_at_slow_speed, 0.0)
        if inside < INSIDE:
            return self._too_near(v, situation.limits.deceleration, reason)
        room, reason = self._room(situation, side, padding)
        fastest = self._fastest(max(0.0, room))
        if fastest >= situation.limits.max_speed:
            return None
        return self._limit(fastest, reason, self._braking(v, room, inside, situation))

    def _fastest(self, room: float) -> float:
        """Return the speed [m/s] that ends within `room` [m]: v t + v^2 / (2 a) = room."""
        a, t = self.preferred_decel, self.reaction
        return a * (sqrt(t**2 + 2 * room / a) - t)

    def _room(self, situation: Situation, side: float, padding: float) -> tuple[float, str]:
        """Return how far one may go [m], and why not farther."""
        model, way = situation.model, -1 if self.backwards else 1
        taken = model.length / 2 + self.clearance + padding
        half = model.width / 2 + side
        echo = situation.around.nearest_in_box(0.0, -half, way * (taken + FAR), half, Recall.LATELY)
        edge = echo.distance - model.length / 2
        return echo.distance - taken, behind(edge) if self.backwards else ahead(edge, echo)

    def _too_near(self, v: float, own: float, reason: str) -> Desire:
        if abs(v) <= MOVING:
            return self._limit(0.0, reason)
        brake = (self.emergency_decel or own) if abs(v) > FAST else None
        return self._limit(0.0, reason, brake, v=0.0)

    def _braking(self, v: float, room: float, inside: float, situation: Situation) -> float | None:
        """Return the deceleration needed beyond the robot's own [m/s^2], or `None`."""
        needed = v**2 / (2 * room) if room > 0 else inf
        if v <= MOVING or needed <= situation.limits.deceleration:
            return None
        if self.emergency_decel:
            return self.emergency_decel
        hard = v**2 / (2 * inside)
        return min(hard if hard > self.preferred_decel else min(needed, self.preferred_decel), TOP)

    def _limit(
        self, top: float, reason: str, brake: float | None = None, v: float | None = None
    ) -> Desire:
        if self.backwards:
            return Desire(back_max=top, deceleration=brake, v=v, reason=reason)
        return Desire(v_max=top, deceleration=brake, v=v, reason=reason)


def _between(share: float, slow: float, fast: float) -> float:
    return slow + share * (fast - slow)
