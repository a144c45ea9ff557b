"""The velocity that takes a robot along its way, around the things that its sensors see."""

from dataclasses import dataclass, field
from math import atan2, cos, hypot, inf, pi, radians, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import Pose2, Twist2, wrap
from pioneer3.jit import fast
from pioneer3.limits import Limits
from pioneer3.models import RobotModel
from pioneer3.nav.kernels import CACHE
from pioneer3.nav.kernels.arcs import ROUNDING, arcs
from pioneer3.nav.kernels.ways import walk_down
from pioneer3.nav.manoeuvre import gaps_at
from pioneer3.nav.planner import CostToGo

Float = NDArray[np.float64]

HOLD, SHORT_HOLD, STEP = 1.0, 0.4, 0.1
"""A command is judged as if it were held so long, then braked; in these steps [s]."""
HOLD_PER_METRE = 0.6
"""Near the goal commands are held no longer than this [s/m]: else the robot creeps up to it."""
DELAY = 0.15
"""From the sensors' readings until the robot obeys [s]."""
SPEEDS, TURNS = 8, 17
"""Numbers of speeds and turn rates that are tried."""
KEEP, KEEP_PER_SPEED = 0.04, 0.1
"""Distance to obstacles [m], and how much more per speed [s]."""
SLOW = 0.15
"""Speed up to which a robot may stay as near to something as it is [m/s]."""
TOUCHES = 0.02
"""Nearer than this to anything nothing comes nearer at a goal either [m]."""
NEAR = 0.15
"""More than this beyond the distance to be kept is worth nothing [m]."""
HEADING, ROOM, CHANGE = 0.35, 1.0, 0.02
"""Worth of a heading along the way [m/rad], of room [m/m], of not changing the turn [m s/rad]."""
FASTEST_TURN, TURN_GENTLY = 1.5, 0.6
"""[rad/s]."""
TURN_FIRST = 1.0
"""Farther off its way it turns first, or goes slowly where there is no room for that [rad]."""
WORTH = 0.01
"""Beside people a robot stands rather than move for less than this [m in the open]."""
BACK = 0.1
"""Speed backwards, where nothing else goes on [m/s]."""
AHEAD = 0.3
"""The way's direction is that to a place so far along it [m]."""

ARRIVING = 0.35
"""Nearer than this it goes straight for the goal [m]."""
THERE, ALIGNED = 0.02, radians(1.0)
"""Near enough [m, rad]."""
LEFT, OFF = 0.05, 0.25
"""A robot that is so far off [m] once it turns to its heading drives back to its place; each time
it may be twice as far off, up to the other: by ranges that are 3 % wrong, places move with the
heading by 0.16 m."""
FACING = radians(25)
"""Farther off the goal it turns first [rad]."""
BRISK = 0.7
"""Share of the robot's deceleration that it brakes its last turn with."""
SETTLE = 0.3
"""Time constant of the end of a turn [s]: wheels follow late, and slip when they brake."""
SLOWING = 0.3
"""Deceleration towards the goal [m/s^2]."""
STANDING, TURNING = 0.01, radians(2)
SLOWEST, SLOWEST_TURN = 0.02, radians(3)
"""Wheels stick below these [m/s, rad/s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class WayStep:
    """The next moment of a way.

    Attributes:
        v: [m/s].
        w: [rad/s].
        reason: In a few words, for people.
        arrived: Whether the robot stands at the goal.
        blocked: Whether no motion leads on.
    """

    v: float
    w: float
    reason: str
    arrived: bool = False
    blocked: bool = False


NO_OBSTACLES: Float = np.empty((0, 5))


@dataclass(slots=True)
class Follower:
    """Drives one robot along ways.

    At each step it tries many velocities that the robot can reach, holds each for a second in
    thought, brakes it, and takes the one that ends where the rest of the way is the cheapest, its
    heading along the way, and room beside it; none that would come too near to an obstacle.

    Attributes:
        model: Its outline.
        limits: Bounds on its motion.
        goal: Point [m] in the map's frame, and heading to end with, or `None`.
        cost_to_go: To the goal; replaced whenever a better one is known.
    """

    model: RobotModel
    limits: Limits
    goal: tuple[float, float, float | None]
    cost_to_go: CostToGo
    _turn: float = field(default=0.0, init=False)
    _fastest_turn: float = field(default=FASTEST_TURN, init=False)
    _at_place: bool = field(default=False, init=False)
    _left: float = field(default=LEFT, init=False)

    def step(
        self,
        robot_in_map: Pose2,
        twist: Twist2,
        obstacles: Float = NO_OBSTACLES,
        top_speed: float = inf,
        *,
        gently: bool = False,
    ) -> WayStep:
        """Return the velocity for the next moment.

        Args:
            robot_in_map: Where the robot is [m, rad].
            twist: Its measured motion.
            obstacles: x, y [m], velocity [m/s] and radius [m] in the map's frame, shape (N, 5).
            top_speed: No faster than this [m/s].
            gently: Whether it turns slowly, and stands where nothing leads on: something is beside
                it that nothing sees whole.
        """
        x, y, _ = self.goal
        distance = hypot(x - robot_in_map.x, y - robot_in_map.y)
        fastest = TURN_GENTLY if gently else FASTEST_TURN
        self._fastest_turn = min(fastest, self.limits.max_turn_rate)
        if self._at_place or distance < ARRIVING:
            step = self._arrive(robot_in_map, twist, distance, obstacles)
            if step is not None:
                return step
        return self._drive(robot_in_map, twist, obstacles, top_speed, may_stand=gently)

    def _drive(
        self,
        robot_in_map: Pose2,
        twist: Twist2,
        obstacles: Float,
        top_speed: float,
        *,
        may_stand: bool,
    ) -> WayStep:
        top = min(top_speed, self.limits.max_speed)
        commands = self._commands(top)
        hold = self._hold(robot_in_map)
        judged = self._judge(robot_in_map, twist, commands, obstacles, hold=hold)
        to_go, off, gap, slow_gap = judged.T
        # nearer to something than it should be, a robot may go on slowly, but no nearer to that
        slow = (np.abs(commands[:, 0]) <= SLOW) & (slow_gap >= -ROUNDING)
        possible = np.isfinite(to_go) & ((gap >= 0.0) | slow)
        gap = np.minimum(gap, NEAR)
        standing = (commands == 0.0).all(axis=1)
        # wheels of a robot that stands stick at turns that are slower
        possible &= (commands[:, 0] != 0.0) | (np.abs(commands[:, 1]) >= SLOWEST_TURN)
        if not possible.any():
            self._turn = 0.0
            return WayStep(v=0.0, w=0.0, reason="something is in the way", blocked=True)
        cost = to_go + HEADING * off + ROOM * (NEAR - gap)
        worth = cost.copy()
        cost += CHANGE * np.abs(commands[:, 1] - self._turn)
        cost[commands[:, 0] < 0] += 1.0
        if self._off_way(robot_in_map) > TURN_FIRST:
            cost[np.abs(commands[:, 0]) > SLOW] += 1.0
        cost[~possible] = inf
        best = int(cost.argmin())
        here = judged[standing][0]
        stands = here[0] + HEADING * here[1]
        room = gaps_at(robot_in_map, self.model, obstacles).min(initial=inf) - KEEP
        if may_stand and worth[best] > stands + ROOM * (NEAR - min(float(room), NEAR)) - WORTH:
            self._turn = 0.0
            return WayStep(v=0.0, w=0.0, reason="something is beside its way", blocked=True)
        v, w = commands[best].tolist()
        self._turn = w
        stuck = bool(cost[best] >= stands + 2.0)
        left = self.cost_to_go.at(robot_in_map.x, robot_in_map.y)
        return WayStep(v=v, w=w, reason=f"{left:.1f} m to go", blocked=stuck)

    def _commands(self, top: float) -> Float:
        """Return the velocities to try, shape (C, 2)."""
        rate = self._fastest_turn
        shares = np.linspace(-1.0, 1.0, TURNS)
        turns = rate * shares * np.abs(shares)  # finer where small
        speeds = np.append(np.linspace(0.0, top, SPEEDS), -min(BACK, top))
        pairs = np.stack(np.meshgrid(speeds, turns, indexing="ij"), axis=-1)
        commands: Float = pairs.reshape(-1, 2)
        return commands

    def _judge(
        self,
        robot_in_map: Pose2,
        twist: Twist2,
        commands: Float,
        obstacles: Float,
        *,
        hold: float = HOLD,
        keep: float = KEEP,
        slow: float = SLOW,
    ) -> Float:
        """Return cost to go, heading off the way, and both gaps of each command, shape (C, 4).

        A robot that is no faster than `slow` [m/s] keeps `keep` [m] from each obstacle, or as much
        as it has.
        """
        at, limits = robot_in_map, self.limits
        kept = np.minimum(keep, gaps_at(at, self.model, obstacles))
        middle = at.theta + twist.w * DELAY / 2
        state = np.array(
            [
                at.x + twist.v * DELAY * cos(middle),
                at.y + twist.v * DELAY * sin(middle),
                at.theta + twist.w * DELAY,
                twist.v,
                twist.w,
            ]
        )
        motion = np.array(
            [
                limits.acceleration,
                limits.deceleration,
                limits.turn_acceleration,
                limits.turn_deceleration,
                hold,
                STEP,
            ]
        )
        raster = self.cost_to_go.raster
        frame = np.array([raster.x, raster.y, raster.cell])
        far = KEEP + KEEP_PER_SPEED * limits.max_speed + NEAR
        outline = np.array([*self._outline, KEEP, KEEP_PER_SPEED, far, slow])
        out = np.empty((len(commands), 4))
        values = self.cost_to_go.values
        side = np.hypot(obstacles[:, 0] - state[0], obstacles[:, 1] - state[1]) - obstacles[:, 4]
        side[(obstacles[:, 2:4] != 0.0).any(axis=1)] = -inf
        things = np.column_stack([obstacles, kept, side])[side.argsort()]
        fast(arcs, CACHE)(commands, state, motion, outline, things, values, frame, out)
        return out

    def _hold(self, at: Pose2) -> float:
        """Return for how long commands are judged [s]."""
        x, y, _ = self.goal
        return min(HOLD, max(SHORT_HOLD, HOLD_PER_METRE * hypot(x - at.x, y - at.y)))

    @property
    def _outline(self) -> tuple[float, float, float]:
        return self.model.length_front, self.model.length_rear, self.model.width / 2

    def _off_way(self, at: Pose2) -> float:
        """Return the angle between the robot's heading and its way [rad], 0 to pi."""
        raster = self.cost_to_go.raster
        begin, there = raster.in_cells(np.array([[at.x, at.y]]))[0], np.empty(2)
        steps = round(AHEAD / raster.cell / 0.5)
        fast(walk_down, CACHE)(self.cost_to_go.values, begin, 0.5, steps, there)
        dx, dy = (there - begin).tolist()
        return abs(wrap(atan2(dy, dx) - at.theta)) if hypot(dx, dy) > 0.5 else 0.0

    def _arrive(
        self, at: Pose2, twist: Twist2, distance: float, obstacles: Float
    ) -> WayStep | None:
        """Return the last moments: to the point, then to the heading; `None` if it may not."""
        x, y, heading = self.goal
        if distance < THERE:
            self._at_place = True
        elif self._at_place and distance > self._left:
            self._at_place, self._left = False, min(OFF, 2 * self._left)
        if self._at_place:
            off = 0.0 if heading is None else wrap(heading - at.theta)
            if abs(off) <= ALIGNED:
                still = abs(twist.v) < STANDING and abs(twist.w) < TURNING
                return WayStep(v=0.0, w=0.0, reason="there", arrived=still)
            turn = 0.0, self._rate(off)
            if self._touches(at, twist, turn, obstacles):
                return WayStep(v=0.0, w=0.0, reason="something is beside it", blocked=True)
            return WayStep(v=0.0, w=turn[1], reason="turns to its heading")
        bearing = wrap(atan2(y - at.y, x - at.x) - at.theta)
        back = abs(bearing) > pi - FACING and distance < 0.15
        off = wrap(bearing - pi) if back else bearing
        if abs(off) > FACING:
            command = (0.0, self._rate(off))
        else:
            v = min(sqrt(2 * SLOWING * distance), self.limits.max_speed)
            v = max(SLOWEST, v * (1 - abs(off) / FACING))
            command = (-v if back else v, 2.0 * off)
        if self._touches(at, twist, command, obstacles):
            return None
        return WayStep(v=command[0], w=command[1], reason=f"{distance:.2f} m to go")

    def _touches(
        self, at: Pose2, twist: Twist2, command: tuple[float, float], obstacles: Float
    ) -> bool:
        """Whether a motion would touch something, or come nearer to what it touches.

        For a robot that turns where it stands people stop, as for one that stands.
        """
        commands = np.array([command])
        if command[0] == 0.0:
            obstacles = obstacles * (1.0, 1.0, 0.0, 0.0, 1.0)
        judged = self._judge(at, twist, commands, obstacles, keep=TOUCHES, slow=inf)
        return bool(judged[0, 3] < -ROUNDING)

    def _rate(self, off: float) -> float:
        """Return the turn rate for the rest of a turn [rad/s]."""
        rate = sqrt(2 * BRISK * self.limits.turn_deceleration * abs(off))
        rate = max(SLOWEST_TURN, min(rate, abs(off) / SETTLE, self._fastest_turn))
        return rate if off > 0 else -rate
