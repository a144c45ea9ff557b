"""Actions that drive: on, a distance, an angle, to a place."""

from dataclasses import dataclass, field
from math import atan2, cos, degrees, hypot, inf, radians, sin, sqrt

from pioneer3.behaviors.action import Action, Desire, Goal, Situation
from pioneer3.behaviors.engine import approach
from pioneer3.geometry import Pose2, wrap


@dataclass(slots=True)
class ConstantVelocity(Action):
    """Wants straight ahead at `velocity` [m/s], negative is backwards (facts.md 7.6)."""

    velocity: float = 0.4
    name: str = "constant velocity"

    def decide(self, situation: Situation) -> Desire:
        return Desire(v=self.velocity, turn=0.0, reason="onwards")


KEEP_HEADING = 1.5
"""Turn rate per heading error [1/s]."""


@dataclass(slots=True, kw_only=True)
class Move(Action):
    """Drive `distance` [m] along the heading at the start; negative is backwards."""

    distance: float
    speed: float
    deceleration: float
    tolerance: float = 0.005
    name: str = "move"
    done: bool = False
    _start: Pose2 | None = field(default=None, init=False)

    def decide(self, situation: Situation) -> Desire | None:
        """Return the speed for the rest of the way; stands still when done."""
        here = situation.pose
        start = self._start = self._start or here
        along = (here.x - start.x) * cos(start.theta) + (here.y - start.y) * sin(start.theta)
        remaining = self.distance - along
        if abs(remaining) <= self.tolerance:
            self.done = abs(situation.twist.v) < 0.01
            return Desire(v=0.0, w=0.0, reason="there")
        self.done = False
        return Desire(
            v=approach(remaining, self.speed, self.deceleration),
            w=KEEP_HEADING * wrap(start.theta - here.theta),
            reason=f"{remaining:z.2f} m to go",
        )


SLOWEST_TURN = radians(2)
"""Turn rate below which wheels of a standing robot stick [rad/s]; commands are whole degrees."""


@dataclass(slots=True, kw_only=True)
class Turn(Action):
    """Turn by `angle` [rad], counter-clockwise positive; more than a full turn is possible."""

    angle: float
    rate: float
    deceleration: float
    tolerance: float = radians(0.7)
    name: str = "turn"
    done: bool = False
    _turned: float = field(default=0.0, init=False)
    _last: float | None = field(default=None, init=False)

    def decide(self, situation: Situation) -> Desire | None:
        """Return the turn rate for the rest of the angle; stands still when done."""
        theta = situation.pose.theta
        if self._last is not None:
            self._turned += wrap(theta - self._last)
        self._last = theta
        remaining = self.angle - self._turned
        if abs(remaining) <= self.tolerance:
            self.done = abs(situation.twist.w) < SLOWEST_TURN
            return Desire(v=0.0, w=0.0, reason="there")
        self.done = False
        rate = approach(remaining, self.rate, self.deceleration)
        if abs(rate) < SLOWEST_TURN:
            rate = SLOWEST_TURN if rate > 0 else -SLOWEST_TURN
        return Desire(v=0.0, w=rate, reason=f"{degrees(remaining):z.0f} deg to go")


SLOWING = 0.2
"""Deceleration towards the goal [m/s^2]: ARIA's speed is the root of 400 mm/s^2 times the way."""
GOAL_BEHIND = radians(120)
"""Bearing of a goal from which on it is behind the robot [rad]."""
STEEP_GOAL = radians(30)
"""Bearing of a goal from which on it turns where it stands [rad]: limiters see what is ahead, not
along a curve."""
MOVED = 0.005
"""A goal that moved farther [m] is a new one."""
STOPPED = 0.005
"""Speed below which a robot has stopped [m/s]."""
ALIGNED = radians(3)
"""Angle to the heading within which a turn is done [rad]."""
STOPPED_TURN = radians(2)
"""Turn rate below which a robot has stopped turning [rad/s]."""


@dataclass(slots=True)
class Goto(Action):
    """Drives straight to a point of odometry's frame, around what slows it (facts.md 7.6).

    While a higher priority limits the speed below `speed_to_turn_at`, it turns away from the goal;
    then it passes by, `turn_amount` off. Differences from ARIA's, whose figures these are: it can
    end at a heading; it slows down where it turns; it has not arrived while it rolls backwards
    through the goal; the side to pass on changes once when the goal comes to lie behind, not at
    every snapshot.

    Attributes:
        heading: To turn to in the end [rad], or `None`.
        done: Whether it has arrived and stands; then it wants nothing.
    """

    x: float
    y: float
    heading: float | None = None
    close_distance: float = 0.1
    speed: float = 0.4
    speed_to_turn_at: float = 0.15
    turn_amount: float = radians(7)
    name: str = "goto"
    done: bool = field(default=False, init=False)
    _there: bool = field(default=False, init=False)
    _side: int = field(default=1, init=False)
    _behind: bool = field(default=False, init=False)

    @property
    def goal(self) -> Goal:
        """Point and heading to drive to."""
        return Goal(x=self.x, y=self.y, heading=self.heading)

    def aim(self, x: float, y: float, heading: float | None = None) -> None:
        """Set another goal; one that has hardly moved changes nothing."""
        if hypot(x - self.x, y - self.y) > MOVED or heading != self.heading:
            self.done = self._there = False
        self.x, self.y, self.heading = x, y, heading

    def decide(self, situation: Situation) -> Desire | None:
        """Return speed and heading, or `None` when arrived."""
        if self.done:
            return None
        here = situation.pose
        dx, dy = self.x - here.x, self.y - here.y
        distance = hypot(dx, dy)
        if distance < self.close_distance and abs(situation.twist.v) < STOPPED:
            self._there = True
        if self._there:
            return self._arrive(situation)
        speed = 0.0
        if distance >= self.close_distance:
            speed = min(sqrt(2 * SLOWING * distance), self.speed)
        return self._steer(speed, wrap(atan2(dy, dx)), situation, f"{distance:.2f} m to go")

    def _steer(self, speed: float, goal: float, situation: Situation, reason: str) -> Desire:
        theta, amount = situation.pose.theta, self.turn_amount
        behind = abs(wrap(goal - theta)) > GOAL_BEHIND
        if behind and not self._behind:
            self._side = -self._side
        self._behind = behind
        if situation.higher.limits.get("v_max", inf) < self.speed_to_turn_at:
            return Desire(v=speed, turn=amount * self._side, reason=f"{reason}, blocked")
        if abs(wrap(goal - (theta - amount * self._side))) > amount / 2:
            facing = max(0.0, 1 - abs(wrap(goal - theta)) / STEEP_GOAL)
            return Desire(v=speed * facing, heading=goal, reason=reason)
        return Desire(v=speed, turn=-amount * self._side, reason=f"{reason}, passing by")

    def _arrive(self, situation: Situation) -> Desire:
        left = 0.0
        if self.heading is not None:
            left = wrap(self.heading - situation.pose.theta)
        if abs(left) > ALIGNED:
            return Desire(v=0.0, turn=left, reason=f"{round(degrees(left))} deg to turn")
        self.done = abs(situation.twist.w) < STOPPED_TURN
        return Desire(v=0.0, turn=0.0, reason="there")
