"""Never drive faster than the robot can stop before what its sonars hear now."""

from dataclasses import dataclass, field
from math import inf, sqrt

from pioneer3.behaviors.actions.reasons import BLIND
from pioneer3.behaviors.desire import Desire
from pioneer3.behaviors.situation import Situation
from pioneer3.behaviors.tracking.pings import Listener, Ping
from pioneer3.geometry import Pose2

FRESH = 0.7
"""Older echoes do not count [s]: two turns of a ring."""
DELAY = 0.25
"""Until the robot begins to brake: the turn of a ring, in the mean, and a report [s]."""
SHARE = 0.7
"""Of the deceleration that is planned with."""


@dataclass(slots=True, kw_only=True)
class Brake:
    """Limits the speed forwards to what can be braked in time.

    Where the other limiters keep clear of all that has been heard in the last seconds, and so of
    where somebody ahead has just walked, this one knows only what each transducer heard last.
    With distance d to what is ahead, less `clearance`, speed v is allowed where
    v `DELAY` + v^2 / (2 `SHARE` deceleration) <= d. It lets the robot come as near as `clearance`.

    Attributes:
        clearance: To be kept between the front end and what is ahead [m].
        beside: To be kept on either side of the robot [m].
    """

    clearance: float = 0.1
    beside: float = 0.08
    name: str = "brake"
    _listener: Listener = field(default_factory=Listener, init=False)

    def decide(self, situation: Situation) -> Desire | None:
        """Return the limit, if anything is ahead; without sonars, no motion forwards."""
        self._listener.listen(situation)
        recent = self._recent(situation)
        if not recent:
            return Desire(v_max=0.0, reason=BLIND)
        gap = min(_gap(ping, situation, self.beside) for ping in recent)
        if gap == inf:
            return None
        top = stopping_speed(gap - self.clearance, situation.limits.deceleration)
        if top >= situation.limits.max_speed:
            return None
        return Desire(v_max=top, reason=f"{gap:.2f} m ahead")

    def _recent(self, situation: Situation) -> list[Ping]:
        return [p for p in self._listener.latest.values() if situation.now - p.stamp <= FRESH]


def stopping_speed(distance: float, deceleration: float) -> float:
    """Return the speed from which a robot comes to stand within `distance` [m]."""
    a = SHARE * deceleration
    return a * (sqrt(DELAY**2 + 2 * max(distance, 0.0) / a) - DELAY)


def _gap(ping: Ping, situation: Situation, beside: float) -> float:
    """Return how far ahead of the front end an echo is; `inf` if it is not in the way."""
    if ping.distance == inf:
        return inf
    there, model = situation.pose.inverse() @ Pose2(*ping.point), situation.model
    inside = there.x > 0 and abs(there.y) <= model.width / 2 + beside
    return max(0.0, there.x - model.length_front) if inside else inf
