"""A way out of where nothing else finds one."""

from dataclasses import dataclass, field
from math import hypot, inf

from pioneer3.behaviors.actions.explore import Explore
from pioneer3.behaviors.desire import Desire
from pioneer3.behaviors.situation import Situation
from pioneer3.geometry import ORIGIN, Pose2


@dataclass(slots=True)
class Unstick:
    """Takes the way with most room when the robot has hardly moved for a while.

    Not one of ARIA's: its avoiders turn for ever where something is near all around, though there
    is room enough to drive out.

    Attributes:
        patience: So long it waits [s].
        distance: Moving less is hardly moving [m].
        seconds: So long it drives at most [s].
        way: So far it drives at most [m].
        speed: [m/s].
    """

    patience: float = 12.0
    distance: float = 0.3
    seconds: float = 15.0
    way: float = 1.2
    speed: float = 0.15
    name: str = "unstick"
    _explore: Explore = field(default_factory=Explore, init=False)
    _anchor: Pose2 = field(default=ORIGIN, init=False)
    _since: float | None = field(default=None, init=False)
    _until: float = field(default=-inf, init=False)

    def decide(self, situation: Situation) -> Desire | None:
        """Return the way out while it is needed."""
        here, now = situation.pose, situation.now
        moved = hypot(here.x - self._anchor.x, here.y - self._anchor.y)
        if now < self._until and moved < self.way:
            self._explore.speed = self.speed
            desire = self._explore.decide(situation)
            return Desire(v=desire.v, heading=desire.heading, reason=f"way out, {desire.reason}")
        if self._since is None or self._until > -inf or moved > self.distance:
            self._anchor, self._since, self._until = here, now, -inf
        elif now - self._since > self.patience:
            self._until = now + self.seconds
            self._anchor = here
        return None
