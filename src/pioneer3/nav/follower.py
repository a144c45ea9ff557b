"""The velocity that takes a robot along its way, around the things that its sensors see."""

from dataclasses import astuple, dataclass, field
from math import atan2, hypot, inf, pi, radians, sqrt

import numpy as np

from pioneer3.arrays import Float
from pioneer3.geometry import Pose2, Twist2, arc, wrap
from pioneer3.jit import fast
from pioneer3.limits import Limits
from pioneer3.models import RobotModel
from pioneer3.nav.clearance import REACTION
from pioneer3.nav.kernels import CACHE
from pioneer3.nav.kernels.arcs import ROUNDING, arcs
from pioneer3.nav.manoeuvre import ALIGNED, SLOWEST_TURN, THERE, TURN_RATE, gaps_at, turn_rate
from pioneer3.nav.planner import CostToGo

TIME_HELD = 1.0
"""Time for which a command is judged as if it were held, then braked [s]."""
TIME_STEP = 0.1
"""Step of these [s]."""
SPEEDS = 8
"""Number of speeds ahead that are tried, and of turn rates to either side with each."""
FASTEST_TURN = 1.5
"""Turn rate at most [rad/s]: slow lasers see walls beside their places in faster turns."""
MARGIN = 0.04
"""Distance that a robot keeps from things [m]."""
MARGIN_PER_SPEED = 0.1
"""Distance that it keeps besides, by its speed [s]."""
SLOW_SPEED = 0.15
"""Speed up to which it may stay as near to something as it is, and speed backwards [m/s]."""
GOAL_MARGIN = 0.02
"""Distance within which it comes nearer to nothing at its goal either [m]."""
ROOM = 0.15
"""Distance beyond the margin whose lack costs as much as a way [m]."""
HEADING_COST = 0.35
"""Cost of a heading off the way [m in the open per rad]."""
CHANGE_COST = 0.02
"""Cost of another turn rate than before [m in the open per rad/s]."""
STRAIGHT_WAY = 0.35
"""Distance from which it goes straight for the goal [m]."""
LEFT_PLACE = 0.05
"""Distance from the goal at which a robot that turns there drives back to it [m]. The next time it
is twice that: by ranges that are 3 % wrong, places move with the heading by 0.16 m."""
FACING = radians(25)
"""Angle off the goal beyond which it turns first [rad]."""
SLOWEST_SPEED = 0.02
"""Speed below which wheels stick, and all points of a robot stand [m/s]."""


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
    _fastest_turn: float = field(default=inf, init=False)
    _at_place: bool = field(default=False, init=False)
    _left: float = field(default=LEFT_PLACE, init=False)

    def step(
        self,
        robot_in_map: Pose2,
        twist: Twist2,
        obstacles: Float,
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
        fastest = TURN_RATE if gently else FASTEST_TURN
        self._fastest_turn = min(fastest, self.limits.max_turn_rate)
        if self._at_place or distance < STRAIGHT_WAY:
            step = self._arrive(robot_in_map, twist, distance, obstacles)
            if step is not None:
                return step
        return self._drive(robot_in_map, twist, obstacles, top_speed, may_stand=gently)

    def _drive(
        self, at: Pose2, twist: Twist2, obstacles: Float, top_speed: float, *, may_stand: bool
    ) -> WayStep:
        top = min(top_speed, self.limits.max_speed)
        speeds = np.append(np.linspace(0.0, top, SPEEDS), -min(SLOW_SPEED, top))
        shares = np.linspace(-1.0, 1.0, 2 * SPEEDS + 1)
        turns = self._fastest_turn * shares * np.abs(shares)  # finer where small
        pairs = np.stack(np.meshgrid(speeds, turns, indexing="ij"), axis=-1)
        commands: Float = pairs.reshape(-1, 2)
        v, w = commands.T
        # near the goal it looks less far ahead, else it never gets all the way to it
        held = min(TIME_HELD, max(STRAIGHT_WAY, hypot(self.goal[0] - at.x, self.goal[1] - at.y)))
        to_go, off, gap, slow_gap = self._judge(at, twist, commands, obstacles, held).T
        # nearer to something than it should be, a robot may go on slowly, but no nearer to that
        possible = (gap >= 0.0) | (np.abs(v) <= SLOW_SPEED) & (slow_gap >= -ROUNDING)
        # wheels of a robot that stands stick at turns that are slower
        possible &= np.isfinite(to_go) & ((v != 0.0) | (np.abs(w) >= SLOWEST_TURN))
        left = to_go + HEADING_COST * off
        stands = float(left[(v == 0.0) & (w == 0.0)][0])
        worth = left + ROOM - np.minimum(gap, ROOM)
        cost = worth + CHANGE_COST * np.abs(w - self._turn) + (v < 0.0)
        best, why = int(np.where(possible, cost, inf).argmin()), ""
        room = float(gaps_at(at, self.model, obstacles).min(initial=ROOM + MARGIN)) - MARGIN
        if not possible[best]:
            why = "something is in the way"
        elif may_stand and worth[best] > stands + ROOM - room:
            why = "something is beside its way"
        self._turn = 0.0 if why else float(w[best])
        if why:
            return WayStep(v=0.0, w=0.0, reason=why, blocked=True)
        reason = f"{self.cost_to_go.at(at.x, at.y):.1f} m to go"
        stuck = bool(cost[best] >= stands + 2.0)
        return WayStep(v=float(v[best]), w=self._turn, reason=reason, blocked=stuck)

    def _judge(
        self,
        at: Pose2,
        twist: Twist2,
        commands: Float,
        obstacles: Float,
        held: float,
        *,
        keep: float = MARGIN,
        slow: float = SLOW_SPEED,
    ) -> Float:
        """Return cost to go, heading off the way, and both gaps of each command, shape (C, 4).

        Each is `held` for so long [s]. A robot that is no faster than `slow` [m/s] keeps `keep` [m]
        from each obstacle, or as much as it has.
        """
        limits, model, to_go = self.limits, self.model, self.cost_to_go
        kept = np.minimum(keep, gaps_at(at, model, obstacles))
        begin = at @ arc(twist.v, twist.w, REACTION)
        state = np.array([begin.x, begin.y, begin.theta, twist.v, twist.w])
        motion = np.array([*astuple(limits.accelerations), held, TIME_STEP])
        frame = np.array([to_go.raster.x, to_go.raster.y, to_go.raster.cell])
        sides = model.length_front, model.length_rear, model.width / 2
        far = MARGIN + MARGIN_PER_SPEED * limits.max_speed + ROOM
        outline = np.array([*sides, MARGIN, MARGIN_PER_SPEED, far, slow])
        side = np.hypot(obstacles[:, 0] - begin.x, obstacles[:, 1] - begin.y) - obstacles[:, 4]
        side[(obstacles[:, 2:4] != 0.0).any(axis=1)] = -inf
        things = np.column_stack([obstacles, kept, side])[side.argsort()]
        out = np.empty((len(commands), 4))
        fast(arcs, CACHE)(commands, state, motion, outline, things, to_go.values, frame, out)
        return out

    def _arrive(
        self, at: Pose2, twist: Twist2, distance: float, obstacles: Float
    ) -> WayStep | None:
        """Return the last moments: to the point, then to the heading; `None` if it may not."""
        x, y, heading = self.goal
        if distance < THERE:
            self._at_place = True
        elif self._at_place and distance > self._left:
            self._at_place, self._left = False, 2 * self._left
        if self._at_place:
            off = 0.0 if heading is None else wrap(heading - at.theta)
            if abs(off) <= ALIGNED:
                still = abs(twist.v) + abs(twist.w) * self.model.corner < SLOWEST_SPEED
                return WayStep(v=0.0, w=0.0, reason="there", arrived=still)
            turn = 0.0, turn_rate(off, self._fastest_turn, self.limits)
            if self._touches(at, twist, turn, obstacles):
                return WayStep(v=0.0, w=0.0, reason="something is beside it", blocked=True)
            return WayStep(v=0.0, w=turn[1], reason="turns to its heading")
        bearing = wrap(atan2(y - at.y, x - at.x) - at.theta)
        back = abs(bearing) > pi - FACING and distance < 0.15
        off = wrap(bearing - pi) if back else bearing
        if abs(off) > FACING:
            command = (0.0, turn_rate(off, self._fastest_turn, self.limits))
        else:
            v = min(sqrt(self.limits.deceleration * distance), self.limits.max_speed)
            v = max(SLOWEST_SPEED, v * (1 - abs(off) / FACING))
            command = (-v if back else v, 2.0 * off)
        held = min(TIME_HELD, distance / abs(command[0])) if command[0] else TIME_HELD
        if self._touches(at, twist, command, obstacles, held):
            self._at_place = distance < LEFT_PLACE
            return None
        return WayStep(v=command[0], w=command[1], reason=f"{distance:.2f} m to go")

    def _touches(
        self,
        at: Pose2,
        twist: Twist2,
        command: tuple[float, float],
        obstacles: Float,
        held: float = TIME_HELD,
    ) -> bool:
        """Whether a motion that is `held` so long [s] would touch something, or come nearer to it.

        For a robot that turns where it stands people stop, as for one that stands.
        """
        commands = np.array([command])
        if command[0] == 0.0:
            obstacles = obstacles * (1.0, 1.0, 0.0, 0.0, 1.0)
        judged = self._judge(at, twist, commands, obstacles, held, keep=GOAL_MARGIN, slow=inf)
        return bool(judged[0, 3] < -ROUNDING)
