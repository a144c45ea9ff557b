"""The action that drives a robot to the edges of a map that is being made."""

from collections.abc import Callable
from dataclasses import dataclass

from pioneer3.behaviors.action import Action, Desire, Goal, Situation
from pioneer3.navigation.follow_way import FollowWay, stand_unsure


@dataclass(slots=True, kw_only=True)
class Explore(Action):
    """Drives one way after the other; between them the robot stands.

    Attributes:
        unsure: Returns the reason that nobody knows where the robot is, or `None`.
        leg: The present way, or `None` while the next one is looked for.
        done: Whether no edge is left.
    """

    unsure: Callable[[], str | None]
    leg: FollowWay | None = None
    name: str = "explore"
    wants_scans: bool = True
    done: bool = False

    @property
    def goal(self) -> Goal | None:
        """Where it goes, in odometry's frame."""
        return self.leg.goal if self.leg else None

    def decide(self, situation: Situation) -> Desire | None:
        """Return the next velocity, or `None` at the end."""
        if self.done:
            return None
        leg = self.leg
        if leg is None or leg.done or leg.failed:
            if unsure := self.unsure():
                return stand_unsure(unsure)
            return Desire(v=0.0, w=0.0, reason="looks where the map ends")
        desire = leg.decide(situation)
        return desire or Desire(v=0.0, w=0.0, reason="has seen the edge of the map")
