"""Follow somebody whose place and speed are estimated from all echoes of the front."""

from dataclasses import dataclass, field
from math import atan2, copysign, cos, degrees, hypot, pi, radians

from pioneer3.behaviors.desire import Desire
from pioneer3.behaviors.goal import Goal
from pioneer3.behaviors.situation import Situation
from pioneer3.behaviors.tracking.acquire import Hearing
from pioneer3.behaviors.tracking.clutter import Clutter
from pioneer3.behaviors.tracking.pings import RING, Listener, Ping
from pioneer3.behaviors.tracking.target import RADIUS, Target
from pioneer3.geometry import wrap

COAST = 1.2
"""Who has not been heard for this long is lost [s]."""
RETURN = 4.0
"""For this long, who was lost is looked for around where they were expected [s]."""
BLINK = 0.4
"""A pause of echoes this short is none [s]: a transducer fires every 0.32 s."""
STANDS_STILL = 10.0
"""What has never walked is furniture after this time [s]."""
ALIKE = 0.15
"""Echoes from nearly as far away [m] may come from the same person."""
LEAD = 0.1
"""The robot acts this much later [s]."""
SETTLE = 0.8
"""Time in which a wrong distance is to be made good [s]."""
TURN_GAIN = 2.0
"""Turn rate per bearing [1/s]."""
FACING = radians(4)
"""Somebody this straight ahead need not be turned to [rad]."""
ASIDE = radians(60)
"""Somebody this far aside is turned to before driving on [rad]."""


@dataclass(slots=True, kw_only=True)
class FollowTracking:
    """Follow somebody with a filter and a memory for furniture.

    Attributes:
        keep: Distance from the robot's front end to the person's outline [m].
        speed: Top speed [m/s].
        back: The same, backwards; only while they are heard [m/s].
        turn_rate: Top turn rate [rad/s].
        target: Who is followed, or `None`.
    """

    keep: float = 0.3
    speed: float = 0.5
    back: float = 0.3
    turn_rate: float = radians(60)
    name: str = "follow"
    target: Target | None = field(default=None, init=False)
    _listener: Listener = field(default_factory=Listener, init=False)
    _clutter: Clutter = field(default_factory=Clutter, init=False)
    _lost: Target | None = field(default=None, init=False)

    @property
    def goal(self) -> Goal | None:
        """Where whom it follows was taken to be at the last echo or silence."""
        if self.target is None:
            return None
        x, y = self.target.estimate.position
        return Goal(x=x, y=y, person=True)

    def decide(self, situation: Situation) -> Desire | None:
        """Return the motion towards somebody, or stand still and look for them."""
        now = situation.now
        self._hear(self._listener.listen(situation))
        self._give_up(now)
        if self.target is None:
            self._find(situation)
        if self.target is None:
            return Desire(v=0.0, w=0.0, reason="looks for somebody")
        return self._follow(self.target, situation)

    def _hear(self, pings: list[Ping]) -> None:
        """Share new echoes out between the person and the furniture."""
        if self.target is not None:
            pings = self.target.hear(pings, self._clutter)
        for ping in pings:
            self._clutter.take(ping)

    def _give_up(self, now: float) -> None:
        """Forget who has been silent for too long, and what turns out to be furniture."""
        target = self.target
        if target is None:
            return
        if now - target.heard > COAST:
            self.target, self._lost = None, target
        elif not target.walked and now - target.found > STANDS_STILL:
            self.target = self._lost = None
            self._clutter.learn(target.echoes.values())

    def _find(self, situation: Situation) -> None:
        """Look for who was lost, then for anybody."""
        now, lost = situation.now, self._lost
        if now - self._listener.since < RING:
            return  # only a part of what is around has been heard
        hearing = Hearing(self._listener.latest, now, situation.model, self._clutter)
        ping = None
        if lost is not None and now - lost.heard <= RETURN:
            ping = hearing.returning_person(*lost.estimate.at(now))
        ping = ping or hearing.nearest_person()
        if ping is not None:
            self._lost = None
            self.target = self._acquire(ping, hearing)

    def _acquire(self, first: Ping, hearing: Hearing) -> Target:
        """Return who sent an echo; what else is heard at this time is not them."""
        target, alike = Target(first), []
        for ping in hearing.echoes():
            if ping is not first and abs(ping.distance - first.distance) < ALIKE:
                alike.append(ping)
            elif ping is not first:
                self._clutter.learn([ping])
        target.hear(alike, self._clutter)
        return target

    def _follow(self, target: Target, situation: Situation) -> Desire:
        """Keep the distance, and face them; drive on only as far as they are ahead."""
        x, y = target.estimate.at(situation.now + LEAD)
        here = situation.pose
        dx, dy = x - here.x, y - here.y
        away, bearing = hypot(dx, dy), wrap(atan2(dy, dx) - here.theta)
        gap = away - RADIUS - situation.model.length_front
        silent = situation.now - target.heard
        vx, vy = target.estimate.velocity
        leaves = (vx * dx + vy * dy) / max(away, RADIUS)
        ahead = cos(bearing * (pi / 2) / ASIDE) if abs(bearing) < ASIDE else 0.0
        v = (leaves + (gap - self.keep) / SETTLE) * ahead
        v = max(-self.back if silent < BLINK else 0.0, min(self.speed, v))
        turn = max(0.0, abs(bearing) - FACING)
        w = copysign(min(self.turn_rate, TURN_GAIN * turn), bearing)
        return Desire(v=v, w=w, reason=_words(gap, bearing, silent))


def _words(gap: float, bearing: float, silent: float) -> str:
    if silent < BLINK:
        return f"follows at {gap:.2f} m"
    side = "left" if bearing > 0 else "right"
    ahead = "ahead" if abs(bearing) < radians(10) else f"{abs(degrees(bearing)):.0f} deg {side}"
    return f"lost for {silent:.1f} s, expects them {ahead}"
