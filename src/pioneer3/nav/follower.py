"""The velocity that takes a robot along its way, around the things that its sensors see."""

from dataclasses import astuple, dataclass, field
from math import atan2, cos, hypot, inf, pi, radians, sin, sqrt

import numpy as np

from pioneer3.arrays import Float
from pioneer3.geometry import Pose2, Twist2, wrap
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
SHORT_TIME = 0.4
"""That time near the goal [s]: else a robot creeps up to it."""
TIME_STEP = 0.1
"""Step of these [s]."""
SPEEDS = 8
"""Number of speeds ahead that are tried."""
TURN_RATES = 17
"""Number of turn rates that are tried with each."""
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
SHARP_TURN = 1.0
"""Angle off its way beyond which it turns first, or goes slowly [rad]."""
REST_COST = 0.01
"""Gain below which a robot beside people stands [m in the open]."""
HEADWAY = 0.03
"""Gain below which there is none [m in the open]."""
HESITATION = 30
"""Steps without headway after which it does not turn where it stands, for half as many."""
STRAIGHT_WAY = 0.35
"""Distance from which it goes straight for the goal [m]."""
LEFT_PLACE = 0.05
"""Distance from the goal at which a robot that turns there drives back to it [m]. The next time it
is twice that: by ranges that are 3 % wrong, places move with the heading by 0.16 m."""
FACING = radians(25)
"""Angle off the goal beyond which it turns first [rad]."""
STILLNESS = 0.01
"""Speed below which all points of a robot stand [m/s]."""
SLOWEST_SPEED = 0.02
"""Speed below which wheels stick [m/s]."""
NO_OBSTACLES: Float = np.empty((0, 5))
"""Nothing around a robot."""


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
    _best: float = field(default=inf, init=False)
    _without: int = field(default=0, init=False)

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
        fastest = TURN_RATE if gently else FASTEST_TURN
        self._fastest_turn = min(fastest, self.limits.max_turn_rate)
        if self._at_place or distance < STRAIGHT_WAY:
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
        x, y, _ = self.goal
        held = min(TIME_HELD, max(SHORT_TIME, hypot(x - robot_in_map.x, y - robot_in_map.y)))
        judged = self._judge(robot_in_map, twist, commands, obstacles, held)
        to_go, off, gap, slow_gap = judged.T
        # nearer to something than it should be, a robot may go on slowly, but no nearer to that
        slow = (np.abs(commands[:, 0]) <= SLOW_SPEED) & (slow_gap >= -ROUNDING)
        possible = np.isfinite(to_go) & ((gap >= 0.0) | slow)
        gap = np.minimum(gap, ROOM)
        standing = (commands == 0.0).all(axis=1)
        # wheels of a robot that stands stick at turns that are slower
        possible &= (commands[:, 0] != 0.0) | (np.abs(commands[:, 1]) >= SLOWEST_TURN)
        here = judged[standing][0]
        stands = here[0] + HEADING_COST * here[1]
        if self._hesitates(stands) and (moves := possible & (commands[:, 0] != 0)).any():
            possible = moves
        if not possible.any():
            self._turn = 0.0
            return WayStep(v=0.0, w=0.0, reason="something is in the way", blocked=True)
        cost = to_go + HEADING_COST * off + ROOM - gap
        worth = cost.copy()
        cost += CHANGE_COST * np.abs(commands[:, 1] - self._turn)
        cost[commands[:, 0] < 0] += 1.0
        if here[1] > SHARP_TURN:
            cost[np.abs(commands[:, 0]) > SLOW_SPEED] += 1.0
        cost[~possible] = inf
        best = int(cost.argmin())
        if may_stand:
            room = float(gaps_at(robot_in_map, self.model, obstacles).min(initial=inf)) - MARGIN
            if worth[best] > stands + ROOM - min(room, ROOM) - REST_COST:
                self._turn = 0.0
                return WayStep(v=0.0, w=0.0, reason="something is beside its way", blocked=True)
        v, w = commands[best].tolist()
        self._turn = w
        stuck = bool(cost[best] >= stands + 2.0)
        left = self.cost_to_go.at(robot_in_map.x, robot_in_map.y)
        return WayStep(v=v, w=w, reason=f"{left:.1f} m to go", blocked=stuck)

    def _hesitates(self, left: float) -> bool:
        """Whether the robot has made no headway for a while; `left` is its way and its turn.

        Where it has no room to turn, turning to and fro may look best for ever.
        """
        if left < self._best - HEADWAY or left > self._best + 1.0:  # the way is another one
            self._best, self._without = left, 0
        self._without = (self._without + 1) % (HESITATION + HESITATION // 2)
        return self._without > HESITATION

    def _commands(self, top: float) -> Float:
        """Return the velocities to try, shape (C, 2)."""
        rate = self._fastest_turn
        shares = np.linspace(-1.0, 1.0, TURN_RATES)
        turns = rate * shares * np.abs(shares)  # finer where small
        speeds = np.append(np.linspace(0.0, top, SPEEDS), -min(SLOW_SPEED, top))
        pairs = np.stack(np.meshgrid(speeds, turns, indexing="ij"), axis=-1)
        commands: Float = pairs.reshape(-1, 2)
        return commands

    def _judge(
        self,
        robot_in_map: Pose2,
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
        at, limits = robot_in_map, self.limits
        kept = np.minimum(keep, gaps_at(at, self.model, obstacles))
        middle = at.theta + twist.w * REACTION / 2
        state = np.array(
            [
                at.x + twist.v * REACTION * cos(middle),
                at.y + twist.v * REACTION * sin(middle),
                at.theta + twist.w * REACTION,
                twist.v,
                twist.w,
            ]
        )
        motion = np.array([*astuple(limits.accelerations), held, TIME_STEP])
        raster = self.cost_to_go.raster
        frame = np.array([raster.x, raster.y, raster.cell])
        model = self.model
        sides = model.length_front, model.length_rear, model.width / 2
        far = MARGIN + MARGIN_PER_SPEED * limits.max_speed + ROOM
        outline = np.array([*sides, MARGIN, MARGIN_PER_SPEED, far, slow])
        out = np.empty((len(commands), 4))
        values = self.cost_to_go.values
        side = np.hypot(obstacles[:, 0] - state[0], obstacles[:, 1] - state[1]) - obstacles[:, 4]
        side[(obstacles[:, 2:4] != 0.0).any(axis=1)] = -inf
        things = np.column_stack([obstacles, kept, side])[side.argsort()]
        fast(arcs, CACHE)(commands, state, motion, outline, things, values, frame, out)
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
                still = abs(twist.v) + abs(twist.w) * self.model.corner < STILLNESS
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
        if self._touches(at, twist, command, obstacles):
            self._at_place = distance < LEFT_PLACE
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
        judged = self._judge(at, twist, commands, obstacles, TIME_HELD, keep=GOAL_MARGIN, slow=inf)
        return bool(judged[0, 3] < -ROUNDING)
