"""The action that drives along planned ways."""

from collections.abc import Callable
from dataclasses import dataclass, field
from math import hypot, inf, isfinite

import numpy as np

from pioneer3.arrays import Float
from pioneer3.behaviors.action import MODE, Action, Desire, Goal, Ranked, Situation, Stack
from pioneer3.behaviors.actions.limiters import LimiterTableSensor
from pioneer3.behaviors.actions.recover import StallRecover
from pioneer3.geometry import Pose2
from pioneer3.nav.beams import beams_of
from pioneer3.nav.follower import Follower
from pioneer3.nav.moving import BESIDE
from pioneer3.nav.particles import points_by
from pioneer3.nav.planner import CostToGo
from pioneer3.nav.sightings import Sightings
from pioneer3.navigation.recovery import Recovery

PATIENCE = 40.0
"""Time after which a robot that comes no nearer gives up [s]."""
PATIENCE_AMONG_PEOPLE = 240.0
"""That time where people are about [s]: they go on sooner or later."""
DETOUR = 1.0
"""Length by which another way is longer that is a detour [m]."""
DETOURS = 8
"""Number of detours after which a robot has to come nearer on any way."""
NEARER = 0.1
"""Length of a way below which it is no progress [m]."""
AHEAD = 0.5
"""Distance ahead at which the speeds that are wanted count already [m]."""


def any_speed(x: float, y: float) -> float:
    """Return the speed that is wanted everywhere [m/s]: any."""
    return inf


@dataclass(slots=True, kw_only=True)
class FollowWay(Action):
    """Drives along the way of a :class:`Follower`, in the map's frame.

    Attributes:
        unsure: Returns the reason that nobody knows where the robot is, or `None`.
        walls: Points of the map's walls [m], shape (W, 2).
        preferred_speed: Returns the highest speed that is wanted at a place of the map [m/s].
        place: Name of the goal on the map, or empty.
        last: Whether the goal is the last one; else somebody sends it on.
        blocked: Whether no motion leads on.
        waits: The reason to stand for a while, or empty.
    """

    follower: Follower
    odom_in_map: Callable[[], Pose2]
    unsure: Callable[[], str | None]
    sightings: Sightings
    walls: Float
    preferred_speed: Callable[[float, float], float] = any_speed
    top_speed: float = inf
    place: str = ""
    last: bool = True
    name: str = "follow way"
    wants_scans: bool = True
    arrived: bool = False
    done: bool = False
    failed: str | None = None
    blocked: bool = False
    waits: str = ""
    _recovery: Recovery = field(init=False)
    _best: float = field(default=inf, init=False)
    _since: float | None = field(default=None, init=False)
    _way: CostToGo | None = field(default=None, init=False)
    _nearest: float = field(default=inf, init=False)
    _detours: int = field(default=0, init=False)

    def __post_init__(self) -> None:
        """Begin with nothing that holds it up."""
        self._recovery = Recovery(self.sightings)

    @property
    def goal(self) -> Goal:
        """Where it goes, in odometry's frame."""
        x, y, heading = self.follower.goal
        there = self.odom_in_map().inverse() @ Pose2(x, y, heading or 0.0)
        return Goal(
            x=there.x,
            y=there.y,
            heading=None if heading is None else there.theta,
            name=self.place,
            to_go=self._best,
        )

    def decide(self, situation: Situation) -> Desire | None:
        """Return the next velocity, or `None` at the goal."""
        if self.done or self.failed:
            return None
        if unsure := self.unsure():
            self._best, self._since = inf, None
            self._recovery = Recovery(self.sightings)  # its poses were of another place
            return stand_unsure(unsure)
        if self.arrived or self.waits:
            self._best, self._since = inf, None
            return Desire(v=0.0, w=0.0, reason=self.waits or "has arrived there")
        robot_in_map = self.odom_in_map() @ situation.pose
        self._listen(situation, robot_in_map)
        obstacles = self._obstacles(situation, robot_in_map)
        top_speed = min(self.top_speed, self._preferred_speed(robot_in_map))
        step = self.follower.step(
            robot_in_map,
            situation.twist,
            obstacles,
            top_speed,
            gently=self._is_beside_somebody(robot_in_map, situation.now),
        )
        self.arrived, self.blocked = step.arrived, step.blocked
        self.done = self.arrived and self.last
        self._check_progress(situation.now, robot_in_map)
        if not step.arrived and (recovers := self._recover(situation, robot_in_map, obstacles)):
            return recovers
        return Desire(v=step.v, w=step.w, reason=step.reason)

    def _recover(
        self, situation: Situation, robot_in_map: Pose2, obstacles: Float
    ) -> Desire | None:
        """Return the velocity of a robot that does not simply go on."""
        to_go, held_up = self.follower.cost_to_go, self.held_up(situation.now)
        return self._recovery.decide(
            situation, robot_in_map, obstacles, to_go, held_up, blocked=self.blocked
        )

    def renew(self, walls: Float, sightings: Sightings) -> None:
        """Go on with a map that has grown."""
        self.walls = walls
        self.sightings = self._recovery.sightings = sightings

    def held_up(self, now: float) -> float:
        """Return for how long it has come no nearer [s]."""
        return 0.0 if self._since is None else now - self._since

    def send_on(self, follower: Follower, *, last: bool) -> None:
        """Drive to the next goal."""
        self.follower, self.last = follower, last
        self._recovery = Recovery(self.sightings)
        self.arrived, self._best, self._since = False, inf, None
        self._way, self._nearest, self._detours = None, inf, 0

    def _preferred_speed(self, robot_in_map: Pose2) -> float:
        """Return the speed that is wanted here and a little ahead [m/s]."""
        ahead = robot_in_map @ Pose2(AHEAD, 0.0, 0.0)
        return min(self.preferred_speed(each.x, each.y) for each in (robot_in_map, ahead))

    def _check_progress(self, now: float, robot_in_map: Pose2) -> None:
        """Give up a robot that has come no nearer for a while, on the ways as they were planned."""
        x, y, way = robot_in_map.x, robot_in_map.y, self.follower.cost_to_go
        left = way.at(x, y)
        if way is not self._way:
            longer = left - self._way.at(x, y) if self._way else 0.0
            self._detours += longer > DETOUR
            if isfinite(longer) and (longer < 0 or self._detours <= DETOURS):
                self._best += longer
            self._way = way
        if left < self._nearest - NEARER:
            self._nearest, self._detours = left, 0
        if self._since is None or left < self._best - NEARER:
            self._best, self._since = left, now
        elif now - self._since > self._patience(now):
            self.failed = "it comes no nearer: something is in the way"

    def _patience(self, now: float) -> float:
        return PATIENCE_AMONG_PEOPLE if self.sightings.movers.are_about(now) else PATIENCE

    def _listen(self, situation: Situation, robot_in_map: Pose2) -> None:
        """Note things that sonars hear: a laser sees no glass, and nothing below or behind it."""
        mounts, sonar = situation.model.sonars, situation.snapshot.sonar
        fresh = [n for n in sonar.fresh if n < len(mounts) and sonar.ranges[n] >= 0]
        if situation.scan is not None and fresh:
            at = np.array([(mounts[n].x, mounts[n].y, mounts[n].theta) for n in fresh])
            ranges = np.array([sonar.ranges[n] for n in fresh])
            self.sightings.hear(at, ranges, robot_in_map, situation.now)

    def _is_beside_somebody(self, robot_in_map: Pose2, now: float) -> bool:
        """Whether somebody is beside the robot, or something that sonars alone notice."""
        x, y = robot_in_map.x, robot_in_map.y
        people = self.sightings.movers.people()
        near = any(hypot(each.x - x, each.y - y) < BESIDE for each in people)
        return near or len(self.sightings.echoes.near(x, y, BESIDE, now)) > 0

    def _obstacles(self, situation: Situation, robot_in_map: Pose2) -> Float:
        """Return obstacles nearby: x, y [m], velocity [m/s], radius [m] in the map, (N, 5)."""
        now, latest = situation.now, self.sightings.latest(situation.now)
        if situation.scan is not None and latest is not None:
            seen = latest
        elif situation.scan is not None:
            beams = beams_of(situation.scan)
            seen = points_by(self.odom_in_map() @ beams.robot_in_odom, beams.points)
        else:
            echoes = [(point.x, point.y) for point in situation.around.points()]
            seen = points_by(robot_in_map, np.array(echoes).reshape(-1, 2))
        return self.sightings.obstacles(robot_in_map.x, robot_in_map.y, self.walls, seen, now)


def stand_unsure(unsure: str) -> Desire:
    """Return the desire to stand until it is known again where the robot is."""
    return Desire(v=0.0, w=0.0, lacks=True, reason=f"not sure where it is: {unsure}")


def follow_way(
    action: Action, name: str = "goto", hint: str = "drives to a place of the map"
) -> Stack:
    """Return the mode that drives along a way, kept clear of what is not seen in time."""
    actions = [
        Ranked(110, StallRecover()),
        Ranked(100, LimiterTableSensor()),
        Ranked(50, action),
    ]
    return Stack.of(name, MODE, actions, hint)
