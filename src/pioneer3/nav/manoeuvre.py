"""Manoeuvres: out of places where a robot that is longer than wide has to line up with a gap."""

from dataclasses import dataclass
from math import atan2, cos, hypot, pi, radians, sin, sqrt

import numpy as np

from pioneer3.arrays import Float
from pioneer3.geometry import Pose2, wrap
from pioneer3.jit import fast
from pioneer3.limits import Limits
from pioneer3.models import RobotModel
from pioneer3.nav.costs import COST_CELL, PASSING_DISTANCE
from pioneer3.nav.kernels import CACHE
from pioneer3.nav.kernels.arcs import ROUNDING
from pioneer3.nav.kernels.manoeuvres import manoeuvre
from pioneer3.nav.particles import points_by
from pioneer3.nav.planner import CostToGo


def gaps_at(at: Pose2, model: RobotModel, obstacles: Float) -> Float:
    """Return the gap between a robot and each obstacle [m], less than 0 within one, shape (N,).

    Args:
        at: Where the robot is [m, rad].
        model: Its outline.
        obstacles: x, y [m], velocity [m/s] and radius [m] in the same frame, shape (N, 5).
    """
    x, y = points_by(at.inverse(), obstacles[:, :2]).T
    off_x = np.maximum(np.maximum(x - model.length_front, -model.length_rear - x), 0.0)
    off_y = np.maximum(np.abs(y) - model.width / 2, 0.0)
    gaps: Float = np.hypot(off_x, off_y) - obstacles[:, 4]
    return gaps


SIDE = 64
"""Side of the window that is searched [cells]."""
HEADINGS = 48
"""Number of headings."""
MOVE_LENGTH = 0.08
"""[m]."""
RADIUS = 0.5
"""Radius of arcs [m]."""
TURN_COST = 0.3
"""Cost of a turn [m/rad]."""
GAP = 0.03
"""Distance kept from everything, and needed to turn freely in the end [m]; where the robot has
less of it already, that is kept."""
BODY_GAP = 0.02
"""Distance kept from people, who are taken wider than they are [m]: a P3-AT can turn before one
who has stepped up to it."""
PROGRESS = 0.3
"""Way to its goal that a manoeuvre saves [m in the open]."""
MOST_STATES = 16_000
"""States after which a search gives up: longer ones would hold up the robot."""
STATES_AT_ONCE = 1500
"""States that a tick may look at: 3 ms."""
SPEED = 0.2
"""Speed of a manoeuvre [m/s]."""
TURN_RATE = 0.6
"""Turn rate of a manoeuvre, and the highest one beside people [rad/s]."""
SLOWEST_TURN = radians(3)
"""Turn rate below which wheels stick [rad/s]."""
MOVES_AHEAD = 2
"""Number of moves ahead to the point by which arcs are steered."""
THERE = 0.02
"""Distance from a place that is near enough [m]."""
ALIGNED = radians(1.0)
"""Angle off a heading that is near enough [rad]."""


def turn_rate(off: float, fastest: float, limits: Limits) -> float:
    """Return the turn rate for the rest of a turn [rad/s], `off` [rad] before its end.

    It brakes with half of what it can: wheels follow late, and slip.
    """
    rate = max(SLOWEST_TURN, min(sqrt(limits.turn_deceleration * abs(off)), fastest))
    return rate if off > 0 else -rate


class Search:
    """A search for a manoeuvre: over places and headings, a part of it in each tick.

    Args:
        here: Where the robot is [m, rad].
        model: Its outline.
        obstacles: Everything nearby, as a follower takes it, shape (N, 5).
        to_go: The cost to its goal.
        ways: Points of the ways of others, which it gets out of [m], shape (K, 2); else it looks
            for a drive to where its own way goes on.
        ahead: Whether it only drives ahead and turns: people step up to a robot that backs off.

    Attributes:
        aside: Whether it looks for the nearest place beside the ways of others; that is one pose
            where the robot is beside them already.
        done: Whether it is over.
        poses: x, y [m] and heading [rad] in the map's frame, one after the other, shape (K, 3);
            `None` if there are none.
    """

    def __init__(
        self,
        here: Pose2,
        model: RobotModel,
        obstacles: Float,
        to_go: CostToGo,
        ways: Float | None = None,
        *,
        ahead: bool = False,
    ) -> None:
        self.aside, self.ahead, self.done = ways is not None, ahead, False
        self.poses: Float | None = None
        ways = np.empty((0, 2)) if ways is None else ways
        reach = SIDE * COST_CELL / 2 + model.corner
        near = _within(reach, here, obstacles)
        things = np.ascontiguousarray(near[:, [0, 1, 4]])  # else another kernel is compiled
        # a robot that is nearer to something already only comes no nearer to that
        kept = np.where(things[:, 2] > 0.0, BODY_GAP, GAP)
        things[:, 2] += np.minimum(kept, gaps_at(here, model, near) - ROUNDING) - GAP
        outline = (model.length_front, model.length_rear, model.width / 2, GAP, model.corner + GAP)
        least = to_go.at(here.x, here.y) - PROGRESS
        raster, places, states = to_go.raster, SIDE * SIDE, SIDE * SIDE * HEADINGS
        self._found, self._before = np.empty((states, 3)), np.full(states, -1, dtype=np.int32)
        self._arguments = (
            np.array([here.x, here.y, here.theta]),
            _moves((1,) if ahead else (1, -1)),
            np.array([*outline, least, PASSING_DISTANCE]),
            things,
            np.pad(_within(reach + PASSING_DISTANCE, here, ways), ((0, 0), (0, 1))),
            to_go.values,
            np.array([raster.x, raster.y, raster.cell, COST_CELL]),
            np.array([SIDE, HEADINGS, MOST_STATES, STATES_AT_ONCE], dtype=np.int32),
            self._found,
            np.full(states, np.inf, dtype=np.float32),
            np.empty(states, dtype=np.float32),
            self._before,
            np.empty(4 * states, dtype=np.int32),
            np.full(places, np.nan),
            np.empty(places),
            np.zeros(2, dtype=np.int32),
        )

    def go_on(self) -> None:
        """Look at some more states."""
        last = fast(manoeuvre, CACHE)(*self._arguments)
        self.done = last >= 0 or not self._arguments[-1][0]
        if last < 0:
            return
        path = [last]
        while (state := -2 - int(self._before[path[-1]])) != path[-1]:
            path.append(state)
        self.poses = self._found[path[::-1]]


def _within(reach: float, here: Pose2, points: Float) -> Float:
    """Return those of `points` (N, any) that are not farther from a place than this [m]."""
    return points[np.hypot(points[:, 0] - here.x, points[:, 1] - here.y) < reach]


@dataclass(slots=True)
class Manoeuvre:
    """Drives along the poses of a manoeuvre, slowly.

    Attributes:
        poses: As found, shape (K, 3).
        limits: Bounds on its motion.
    """

    poses: Float
    limits: Limits

    def step(self, robot_in_map: Pose2) -> tuple[float, float] | None:
        """Return the next velocity [m/s, rad/s], `None` once it is over."""
        while len(self.poses) > 1:
            # runs are as long as they go one way: 1 or -1, 0 for turns
            dx, dy, _ = np.diff(self.poses, axis=0).T
            theta = self.poses[:-1, 2]
            ways = np.sign(dx * np.cos(theta) + dy * np.sin(theta))
            ways[np.hypot(dx, dy) < MOVE_LENGTH / 2] = 0
            others = np.flatnonzero(ways != ways[0])
            end = int(others[0]) if len(others) else len(ways)
            run, way = self.poses[: end + 1], int(ways[0])
            command = self._drive(robot_in_map, run, way) if way else self._turn(robot_in_map, run)
            if command is not None:
                return command
            self.poses = self.poses[end:]
        return None

    def _turn(self, at: Pose2, run: Float) -> tuple[float, float] | None:
        off = wrap(float(run[-1, 2]) - at.theta)
        return None if abs(off) < ALIGNED else (0.0, turn_rate(off, TURN_RATE, self.limits))

    def _drive(self, at: Pose2, run: Float, way: int) -> tuple[float, float] | None:
        """Return the velocity along a run of arcs, or `None` at its end."""
        x, y, theta = run[-1]
        left = way * ((x - at.x) * cos(theta) + (y - at.y) * sin(theta))
        if left < THERE:
            return None
        nearest = int(np.hypot(run[:, 0] - at.x, run[:, 1] - at.y).argmin())
        if nearest + MOVES_AHEAD < len(run):
            to_x, to_y = run[nearest + MOVES_AHEAD, :2]
        else:  # beyond the end, straight on
            beyond = way * max(0.0, MOVES_AHEAD * MOVE_LENGTH - left)
            to_x, to_y = x + beyond * cos(theta), y + beyond * sin(theta)
        dx, dy = to_x - at.x, to_y - at.y
        bearing = wrap(atan2(dy, dx) - at.theta - (pi if way < 0 else 0.0))
        curvature = 2 * sin(bearing) / max(hypot(dx, dy), MOVE_LENGTH)
        v = min(SPEED, max(0.03, sqrt(self.limits.deceleration * left)))
        w = max(-TURN_RATE, min(TURN_RATE, v * curvature))
        return way * v, w


def _moves(ways: tuple[int, ...]) -> Float:
    """Return the moves of a robot that drives these `ways`: 1 for ahead, -1 for backwards."""
    bend, turn = MOVE_LENGTH / RADIUS, 2 * pi / HEADINGS
    rows = [(way * MOVE_LENGTH, side * bend) for way in ways for side in (0, 1, -1)]
    rows += [(0.0, turn), (0.0, -turn)]
    costs = [abs(way) + TURN_COST * abs(turn) for way, turn in rows]
    return np.column_stack([rows, costs])
