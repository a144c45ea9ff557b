"""The action that drives along planned ways."""

from collections.abc import Callable
from dataclasses import dataclass, field
from math import inf

import numpy as np
from numpy.typing import NDArray

from pioneer3.behaviors.action import MODE, Action, Desire, Goal, Ranked, Situation, Stack
from pioneer3.behaviors.actions.limiters import LimiterTableSensor
from pioneer3.behaviors.actions.recover import StallRecover
from pioneer3.geometry import Pose2
from pioneer3.nav.beams import beams_of
from pioneer3.nav.follower import Follower
from pioneer3.nav.sightings import Sightings, in_map

Float = NDArray[np.float64]

PATIENCE = 40.0
"""A robot that comes no nearer for so long gives up [s]."""
NEARER = 0.1
"""Less of a way is no progress [m]."""
AHEAD = 0.5
"""Speeds that are wanted so far ahead count already [m]."""
CELL = 0.05
"""Of points so near to each other one is enough [m]."""
LOOK = 2.0
"""Things farther than this are not looked at [m]."""


def any_speed(x: float, y: float) -> float:
    """Return the speed that is wanted everywhere [m/s]: any."""
    return inf


@dataclass(slots=True, kw_only=True)
class FollowWay:
    """Drives along the way of a :class:`Follower`, in the map's frame.

    Attributes:
        follower: Chooses the velocities.
        odom_in_map: Returns the transform of now.
        unsure: Returns the reason that nobody knows where the robot is, or `None`.
        sightings: Things that are not on the map.
        walls: Points of the map's walls [m], shape (W, 2).
        preferred_speed: Returns the highest speed that is wanted at a place of the map [m/s].
        top_speed: [m/s].
        last: Whether the goal is the last one; else somebody sends it on.
        arrived: Whether it stands at the goal.
        done: Whether it stands at the last one.
        failed: The reason to give up, or `None`.
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
    last: bool = True
    name: str = "follow way"
    wants_scans: bool = True
    arrived: bool = False
    done: bool = False
    failed: str | None = None
    blocked: bool = False
    waits: str = ""
    _best: float = field(default=inf, init=False)
    _since: float | None = field(default=None, init=False)

    @property
    def goal(self) -> Goal:
        """Where it goes, in odometry's frame."""
        x, y, heading = self.follower.goal
        there = self.odom_in_map().inverse() @ Pose2(x, y, heading or 0.0)
        return Goal(
            x=there.x,
            y=there.y,
            heading=None if heading is None else there.theta,
            to_go=self._best,
        )

    def decide(self, situation: Situation) -> Desire | None:
        """Return the next velocity, or `None` at the goal."""
        if self.done or self.failed:
            return None
        if unsure := self.unsure():
            self._wait(situation.now)
            return Desire(v=0.0, w=0.0, reason=f"not sure where it is: {unsure}")
        if self.arrived:
            return Desire(v=0.0, w=0.0, reason="has arrived there")
        if self.waits:
            self._best, self._since = inf, None
            return Desire(v=0.0, w=0.0, reason=self.waits)
        robot_in_map = self.odom_in_map() @ situation.pose
        step = self.follower.step(
            robot_in_map,
            situation.twist,
            self._obstacles(situation, robot_in_map),
            min(self.top_speed, self._preferred_speed(robot_in_map)),
        )
        self.arrived, self.blocked = step.arrived, step.blocked
        self.done = self.arrived and self.last
        self._check_progress(situation.now, robot_in_map)
        return Desire(v=step.v, w=step.w, reason=step.reason)

    def held_up(self, now: float) -> float:
        """Return for how long it has come no nearer [s]."""
        return 0.0 if self._since is None else now - self._since

    def send_on(self, follower: Follower, *, last: bool) -> None:
        """Drive to the next goal."""
        self.follower, self.last = follower, last
        self.arrived, self._best, self._since = False, inf, None

    def _preferred_speed(self, robot_in_map: Pose2) -> float:
        """Return the speed that is wanted here and a little ahead [m/s]."""
        ahead = robot_in_map @ Pose2(AHEAD, 0.0, 0.0)
        return min(self.preferred_speed(each.x, each.y) for each in (robot_in_map, ahead))

    def _wait(self, now: float) -> None:
        """Stand until somebody knows where the robot is; then begin to watch its progress anew."""
        self._best = inf
        if self._since is None:
            self._since = now
        elif now - self._since > PATIENCE:
            self.failed = "nobody knows where the robot is"

    def _check_progress(self, now: float, robot_in_map: Pose2) -> None:
        left = self.follower.cost_to_go.at(robot_in_map.x, robot_in_map.y)
        if self._since is None or left < self._best - NEARER:
            self._best, self._since = left, now
        elif now - self._since > PATIENCE:
            self.failed = "it comes no nearer: something is in the way"

    def _obstacles(self, situation: Situation, robot_in_map: Pose2) -> Float:
        """Return obstacles nearby: x, y in the map [m] and velocity [m/s], shape (N, 4)."""
        parts = [self.walls, self.sightings.points(situation.now)]
        if situation.scan is not None:
            beams = beams_of(situation.scan)
            parts.append(in_map(self.odom_in_map() @ beams.robot_in_odom, beams.points))
        else:
            echoes = [(point.x, point.y) for point in situation.around.points()]
            parts.append(in_map(robot_in_map, np.array(echoes).reshape(-1, 2)))
        points = np.concatenate(parts)
        away = np.hypot(points[:, 0] - robot_in_map.x, points[:, 1] - robot_in_map.y)
        points = points[away < LOOK]
        _, chosen = np.unique(np.round(points / CELL), axis=0, return_index=True)
        return np.pad(points[chosen], ((0, 0), (0, 2)))


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
