"""Brings a robot on that is held up: through a narrow place, round people, or aside for them."""

from dataclasses import dataclass, field
from math import hypot, inf

import numpy as np

from pioneer3.arrays import Float
from pioneer3.behaviors.action import Desire, Situation
from pioneer3.geometry import Pose2
from pioneer3.models import RobotModel
from pioneer3.nav.costs import PASSING_DISTANCE
from pioneer3.nav.manoeuvre import PROGRESS, Manoeuvre, Search, gaps_at
from pioneer3.nav.mover import Mover
from pioneer3.nav.moving import BESIDE
from pioneer3.nav.planner import CostToGo
from pioneer3.nav.sightings import STANDING_TIME, Sightings, standing

MOVED = 0.2
"""Way below which a robot has not moved [m]; in a manoeuvre, that of a corner as it turns."""
HELD_UP_TIME = 4.0
"""Time without headway after which it looks for a manoeuvre [s]; half of it is between searches."""
BLOCKED_TIME = 1.0
"""Time where it is after which a robot that nothing leads on from waits for people [s]."""
STAYING_TIME = 30.0
"""Time after which somebody who stands does not wait for it [s]."""


@dataclass(slots=True)
class Recovery:
    """Looks for a manoeuvre where a robot is held up, and drives it.

    Attributes:
        sightings: Tells who is near.
    """

    sightings: Sightings
    _manoeuvre: Manoeuvre | None = field(default=None, init=False)
    _search: Search | None = field(default=None, init=False)
    _aside: bool = field(default=False, init=False)
    _for_people: bool = field(default=False, init=False)
    _shut: bool = field(default=False, init=False)
    _met: float = field(default=-inf, init=False)
    _kept_from_it: float = field(default=-inf, init=False)
    _searched: float = field(default=-inf, init=False)
    _anchor: Pose2 = field(default=Pose2(inf), init=False)
    _anchored: float = field(default=-inf, init=False)

    def decide(
        self,
        situation: Situation,
        robot_in_map: Pose2,
        obstacles: Float,
        to_go: CostToGo,
        held_up: float,
        *,
        blocked: bool,
    ) -> Desire | None:
        """Return the next velocity, or `None` where the robot simply goes on.

        Args:
            situation: Of now.
            robot_in_map: Where the robot is [m, rad].
            obstacles: Everything nearby, as a follower takes it, shape (N, 5).
            to_go: The cost to its goal.
            held_up: For how long it has come no nearer [s].
            blocked: Whether no motion leads on.
        """
        here, now = robot_in_map, situation.now
        moved = self._anchor.inverse() @ here
        turned = situation.model.corner * moved.theta if self._manoeuvre else 0.0
        if hypot(moved.x, moved.y, turned) > MOVED:
            self._anchor, self._anchored = here, now
        still = now - self._anchored
        waiting = self._waiting(here, now)
        self._met = now if waiting else self._met
        passed = now - self._met > BLOCKED_TIME and not blocked
        if self._manoeuvre is not None:
            command = self._manoeuvre.step(here)
            if command and not (self._for_people and passed) and still < HELD_UP_TIME:
                why = "goes round somebody" if waiting else "lines up with a narrow place"
                why = "goes aside for somebody" if self._aside else why
                return Desire(v=command[0], w=command[1], reason=why)
            if command and self._aside and not passed:
                self._kept_from_it = now
            self._aside &= command is None
            self._manoeuvre, self._anchored, still = None, now, 0.0
        self._aside &= now - self._met < BLOCKED_TIME and still < HELD_UP_TIME
        if self._aside:
            return Desire(v=0.0, w=0.0, reason="lets somebody pass")
        arrives = to_go.at(here.x, here.y) <= PROGRESS
        meets = bool(waiting) or (arrives and self.sightings.movers.are_about(now))
        waits = meets and blocked and still > BLOCKED_TIME
        may_search = waits or min(held_up, still, now - self._met) > HELD_UP_TIME
        search = self._search
        if search is not None and (search.aside or search.ahead) != waits:
            self._search = None
        if self._search is None and may_search and now - self._searched > HELD_UP_TIME / 2:
            # who steps up to a robot that moves waits anew before they turn back
            patient = min(held_up, now - self._kept_from_it) > STANDING_TIME
            aside = waits and still > HELD_UP_TIME and patient
            if aside and (arrives or self._shut):
                ways = self._ways(waiting, here, situation.model)
                self._search = Search(here, situation.model, obstacles, to_go, ways)
            elif not arrives:
                self._search = Search(here, situation.model, obstacles, to_go, ahead=waits)
            self._searched = now
        if self._goes_on_searching(situation):
            why = "waits for somebody" if waits else "looks for a way on"
            return Desire(v=0.0, w=0.0, reason=why)
        if waits and self._manoeuvre is None:
            return Desire(v=0.0, w=0.0, reason="waits for somebody")
        return None

    def _goes_on_searching(self, situation: Situation) -> bool:
        """Search on, and take the manoeuvre that is found; whether it is to go on."""
        if self._search is None:
            return False
        self._search.go_on()
        if not self._search.done:
            return True
        poses, aside, ahead = self._search.poses, self._search.aside, self._search.ahead
        self._search, self._for_people = None, aside or ahead
        self._shut = poses is None and not aside
        if poses is not None:
            self._manoeuvre = Manoeuvre(poses, situation.limits)
            self._aside, self._anchored = aside, situation.now
        return False

    def _ways(self, people: list[Mover], here: Pose2, model: RobotModel) -> Float:
        """Return points on the ways of people who wait for the robot [m], (K, 2).

        Somebody whom nothing sees wants to where the robot is.
        """
        ways = []
        for each in people:
            place = each.x, each.y
            way = self.sightings.way_of(place, each.heading)
            gaps = gaps_at(here, model, standing(way, 0.0))
            if not any(each.heading) or gaps.min() >= min(gaps[0], PASSING_DISTANCE):
                # nobody waits for a robot beside their way: they have turned round
                way = self.sightings.way_of(place, (here.x - each.x, here.y - each.y))
            ways.append(way)
        return np.concatenate(ways or [np.array([(here.x, here.y)])])

    def _waiting(self, here: Pose2, now: float) -> list[Mover]:
        """Return the people who stand so near that the robot may be in their way."""
        return [
            each
            for each in self.sightings.movers.people()
            if hypot(each.x - here.x, each.y - here.y) < BESIDE
            and (each.stands is not None or now - each.seen > BLOCKED_TIME)
            and now - each.still_since < STAYING_TIME
        ]
