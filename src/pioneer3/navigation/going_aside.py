"""Lets people pass who wait for a robot that does not come on."""

from dataclasses import dataclass, field
from math import atan2, hypot, inf

import numpy as np
from numpy.typing import NDArray

from pioneer3.behaviors.action import Desire, Situation
from pioneer3.geometry import Pose2, wrap
from pioneer3.nav.follower import Follower
from pioneer3.nav.giving_way import WINDOW, refuge, ways_of
from pioneer3.nav.manoeuvre import APART, Manoeuvre, find_way_aside
from pioneer3.nav.mover import Mover
from pioneer3.nav.sightings import Sightings

Float = NDArray[np.float64]

MOVED, TURNED, STUCK = 0.1, 0.3, 1.0
"""A robot that has not come so far [m] nor turned so much [rad] in so long [s] is stuck."""
STUCK_ASIDE = 3.0
"""One that has gone aside, or does not get there, looks for another place after this [s]."""
MEETS, GONE = 0.95, 0.7
"""Who stands so near [m] waits for the robot; it goes on once nobody has for the latter [s]."""
PATIENT = 12.0
"""Who has stood there for less than this [s] may turn back or walk round a robot that stands."""
FARTHER = 0.1
"""Where they do not pass, it goes so much farther from their ways the next time [m]."""
SEARCH_AGAIN = 1.0
"""So often a robot that waits looks for a place beside their way [s]."""
AT_GOAL = 0.5
"""Nearer to its goal than this it waits rather than leave it again [m]."""
ASIDE = 0.3
"""Speed of a robot that goes aside [m/s]."""
LETS, STAYS, SAME = 12.0, 60.0, 0.3
"""Who has stood for so long while the robot went aside [s] does not wait for it, and is let be for
the second time [s] while they stay so near to where they stood [m]."""
LONGEST = 120.0
"""Time spent aside that is forgiven on one way [s]."""


@dataclass(slots=True)
class GoingAside:
    """Drives to a place beside the way of people, and waits there until they have passed.

    Attributes:
        sightings: Tells who is near.
        forgiven: Time spent aside in the last moment that does not count as waiting in vain [s].
    """

    sightings: Sightings
    forgiven: float = field(default=0.0, init=False)
    _to: Follower | Manoeuvre | None = field(default=None, init=False)
    _anchor: Pose2 = field(default=Pose2(inf), init=False)
    _anchored: float = field(default=-inf, init=False)
    _asked: float = field(default=0.0, init=False)
    _before: float = field(default=0.0, init=False)
    _spent: float = field(default=0.0, init=False)
    _aside_since: float = field(default=0.0, init=False)
    _searched: float = field(default=-inf, init=False)
    _tries: int = field(default=0, init=False)
    _in_vain: int = field(default=0, init=False)
    _stay: list[tuple[float, float, float]] = field(default_factory=list, init=False)

    def decide(
        self,
        situation: Situation,
        robot_in_map: Pose2,
        obstacles: Float,
        to_go: float = inf,
        *,
        blocked: bool = True,
    ) -> Desire | None:
        """Return the velocity of a robot that goes aside, or `None` if nobody waits for it.

        Args:
            situation: Of now.
            robot_in_map: Where the robot is.
            obstacles: Nearby, as a follower takes them.
            to_go: Distance from its goal [m].
            blocked: Whether no motion leads on; a robot that goes on waits for nobody.
        """
        now, here = situation.now, (robot_in_map.x, robot_in_map.y)
        self.forgiven = 0.0
        came = hypot(here[0] - self._anchor.x, here[1] - self._anchor.y)
        if came > MOVED or abs(wrap(robot_in_map.theta - self._anchor.theta)) > TURNED:
            self._anchor, self._anchored = robot_in_map, now
        self._stay = [(x, y, end) for x, y, end in self._stay if end > now and self._is_there(x, y)]
        stuck, waiting = now - self._anchored, self._waiting(here, now)
        if waiting:
            self._asked = now
        waits = blocked and stuck > STUCK if self._to is None else stuck > STUCK_ASIDE
        if waiting and waits:
            lately = self._to is None and _came_lately(waiting, now)
            if lately and (to_go < AT_GOAL or now - self._searched < SEARCH_AGAIN):
                return self._stand(now)
            found: Follower | Manoeuvre | None
            found, is_last = self._beside(situation, robot_in_map, waiting, obstacles)
            if found is None and is_last and not lately:
                found = self._place(situation, robot_in_map, waiting)
            if is_last:
                self._searched = now
            if self._to is None and found is None and (lately or not is_last):
                return self._stand(now)
            if is_last:
                self._in_vain += 1  # unless they pass now
                self._to, self._anchored = found or self._to, now
        else:
            self._tries = 0
            if self._to is not None and now - self._asked > GONE:
                self._to, self._anchored = None, now
        if self._to is None:
            self._before = self._aside_since = now
            self._in_vain = 0
            return None
        self._spend(now)
        v, w, there = self._drive(self._to, situation, robot_in_map, obstacles)
        self._let_be(waiting, now)
        reason = "lets somebody pass" if there else "goes aside for somebody"
        return Desire(v=v, w=w, reason=reason)

    def _stand(self, now: float) -> Desire:
        self._spend(now)
        self._aside_since = now
        return Desire(v=0.0, w=0.0, reason="waits for somebody")

    def _spend(self, now: float) -> None:
        """Let time pass that does not count as waiting in vain."""
        passed, self._before = max(0.0, min(now - self._before, 1.0)), now
        self._spent += passed
        self.forgiven = passed if self._spent < LONGEST else 0.0

    def _let_be(self, waiting: list[Mover], now: float) -> None:
        """Note people who do not wait for the robot: they stay though it goes aside."""
        self._stay += [
            (each.x, each.y, now + STAYS)
            for each in waiting
            if now - max(_stands_since(each), self._aside_since) > LETS
        ]

    def _drive(
        self, to: Follower | Manoeuvre, situation: Situation, robot_in_map: Pose2, obstacles: Float
    ) -> tuple[float, float, bool]:
        """Return the next velocity [m/s, rad/s], and whether the robot is there."""
        if isinstance(to, Manoeuvre):
            v, w = to.step(robot_in_map, obstacles)
            return v, w, to.done
        step = to.step(robot_in_map, situation.twist, obstacles, ASIDE)
        return step.v, step.w, step.arrived

    def _beside(
        self, situation: Situation, at: Pose2, near: list[Mover], obstacles: Float
    ) -> tuple[Manoeuvre | None, bool]:
        """Look for a drive to the nearest pose beside people's ways, in one way: it takes long.

        Returns:
            The drive, if there is one; and whether there is nothing else to try.
        """
        first = _nearest(near, at)
        tries = (
            lambda: ways_of(near, at),
            lambda: ways_of([first], at),
            lambda: ways_of([first], at, to_robot=False),
        )
        model, ways = situation.model, tries[self._tries]()
        apart = APART + min(self._in_vain, 3) * FARTHER
        costs = self.sightings.costs
        poses = find_way_aside(at, model, obstacles, ways, costs, apart=apart)
        self._tries = 0 if poses is not None else (self._tries + 1) % len(tries)
        drive = None if poses is None else Manoeuvre(poses, model, situation.limits)
        return drive, self._tries == 0

    def _place(self, situation: Situation, at: Pose2, near: list[Mover]) -> Follower | None:
        """Return the follower to a place where nobody goes, if there is one."""
        where = at.x, at.y, WINDOW, situation.now
        seen = np.concatenate([self.sightings.near(*where), self.sightings.echoes.near(*where)])
        model = situation.model
        to_go = refuge(self.sightings.costs, model.corner, at, near, seen)
        if to_go is None:
            return None
        nearest = _nearest(near, at)
        facing = atan2(nearest.y - to_go.y, nearest.x - to_go.x)  # to see when they have passed
        goal = to_go.x, to_go.y, facing
        return Follower(model, situation.limits, goal, to_go, either_way=True)

    def _is_there(self, x: float, y: float) -> bool:
        """Return whether somebody is at a place still [m]; who comes there anew may wait."""
        return any(hypot(o.x - x, o.y - y) < SAME for o in self.sightings.movers.people())

    def _waiting(self, here: tuple[float, float], now: float) -> list[Mover]:
        """Return the people who stand so near that the robot may be in their way."""
        return [
            each
            for each in self.sightings.movers.people()
            if hypot(each.x - here[0], each.y - here[1]) < MEETS
            and (each.stands is not None or now - each.seen > STUCK)
            and not any(hypot(each.x - x, each.y - y) < SAME for x, y, _ in self._stay)
        ]


def _nearest(people: list[Mover], at: Pose2) -> Mover:
    """Return who is the nearest to a place [m]."""
    return min(people, key=lambda each: hypot(each.x - at.x, each.y - at.y))


def _came_lately(waiting: list[Mover], now: float) -> bool:
    """Return whether one of those who wait has not stood for long."""
    return any(now - _stands_since(each) < PATIENT for each in waiting)


def _stands_since(somebody: Mover) -> float:
    """Return since when somebody stands [s]; who left the view while they walked, since then."""
    return somebody.seen if somebody.stands is None else somebody.stands
