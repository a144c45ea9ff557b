"""Actions that get a robot free: from a stall, and from places that avoiders do not leave."""

from dataclasses import dataclass, field
from math import hypot, inf, radians
from typing import NamedTuple

from pioneer3.behaviors.action import Action, Desire, Situation
from pioneer3.behaviors.actions.explore import Explore
from pioneer3.behaviors.actions.limiters import CREEP
from pioneer3.behaviors.surroundings import Buffer
from pioneer3.geometry import ORIGIN, Pose2, wrap

SAME_TROUBLE = 5.0
"""A stall so soon after the last attempt [s] calls for the next one on the list."""
ARRIVED = radians(3)
"""Angle to its heading within which a turn is done [rad]."""
AHEAD = radians(120)
"""Bearing up to which obstacles are ahead of a stalled robot [rad]."""
SIDE_FROM = radians(60)
"""Bearing from which on obstacles are beside it [rad]."""
SIDE_TO = radians(120)
"""Bearing up to which obstacles are beside it [rad]."""


class RecoveryAttempt(NamedTuple):
    """One attempt: which way to drive (1 forwards, -1 back), which way to turn (1 left)."""

    words: str
    drive: int = 0
    turn: int | None = 0


SUGGESTED = None
"""Turn to the side that a stalled wheel or an obstacle suggests."""
WAYS = (
    RecoveryAttempt("back and turn", -1, SUGGESTED),
    RecoveryAttempt("forward and turn", 1, SUGGESTED),
    RecoveryAttempt("back", -1),
    RecoveryAttempt("forward", 1),
    RecoveryAttempt("turn left", 0, 1),
    RecoveryAttempt("turn right", 0, -1),
    RecoveryAttempt("back and left", -1, 1),
    RecoveryAttempt("back and right", -1, -1),
    RecoveryAttempt("forward and left", 1, 1),
    RecoveryAttempt("forward and right", 1, -1),
)
"""In this order (facts.md 7.6)."""


@dataclass(slots=True)
class StallRecover(Action):
    """Tries ten ways out of a stall, one after the other (facts.md 7.6).

    Its desire is the answer to the stall, which ends every other motion. It leaves the robot
    alone as soon as a higher priority has taken a channel of motion. It turns more slowly than
    ARIA's, as fast as the robot can: a corner of a robot that stands at a wall swings into it.
    A stall tells that something is near that no sensor saw: for the first `clear` it creeps, and
    does not turn as it drives.

    Attributes:
        obstacle_distance: Nearer than this to the robot's circle is too near to go on after half of
            the time [m].
        seconds: Of one attempt; ARIA's 50 cycles [s].
        creep: Speed at which any point of the robot may touch something [m/s].
        clear: So far from where it stalled nothing unseen touches it [m].
    """

    obstacle_distance: float = 0.225
    seconds: float = 5.0
    speed: float = 0.15
    turn_amount: float = radians(45)
    turn_rate: float = radians(10)
    creep: float = CREEP
    clear: float = 0.1
    enabled: bool = True
    name: str = "stall recover"
    _way: RecoveryAttempt | None = field(default=None, init=False)
    _next: int = field(default=0, init=False)
    _end: float = field(default=-inf, init=False)
    _last: float = field(default=-inf, init=False)
    _target: float | None = field(default=None, init=False)
    _stalled_at: Pose2 = field(default=ORIGIN, init=False)

    def decide(self, situation: Situation) -> Desire | None:
        """Return the next moment of an attempt, if one is needed."""
        if not self.enabled or situation.higher.owned:
            self._way = None
            return None
        if self._way is None:
            if not situation.snapshot.motors.stalled:
                return None
            self._begin(situation)
        return self._go_on(situation)

    def _begin(self, situation: Situation) -> None:
        now = situation.now
        self._next = (self._next + 1) % len(WAYS) if now - self._last <= SAME_TROUBLE else 0
        self._way = way = WAYS[self._next]
        self._end = now + self.seconds
        self._stalled_at = situation.pose
        turn = _away(situation) if way.turn is SUGGESTED else way.turn
        theta = situation.pose.theta
        self._target = wrap(theta + turn * self.turn_amount) if turn else None

    def _go_on(self, situation: Situation) -> Desire | None:
        way, theta = self._way, situation.pose.theta
        assert way is not None
        self._last = situation.now
        v = self._speed(way.drive, situation) if way.drive else 0.0
        if self._target is not None and abs(wrap(self._target - theta)) <= ARRIVED:
            self._target = None
        if situation.now >= self._end or (v == 0.0 and self._target is None):
            self._way = None
            return Desire(v=0.0, w=0.0, reason="tried", answers_stall=True)
        reason = f"stalled: {way.words}"
        near, rate = self._is_near(situation.pose), self.turn_rate
        if near:
            v = max(-self.creep, min(v, self.creep))
            rate = min(rate, self.creep / situation.model.corner)
        if self._target is None or (near and v):
            return Desire(v=v, w=0.0, reason=reason, answers_stall=True)
        return Desire(
            v=v,
            heading=self._target,
            left_max=rate,
            right_max=rate,
            reason=reason,
            answers_stall=True,
        )

    def _is_near(self, here: Pose2) -> bool:
        """Whether the robot has hardly left the place where it stalled."""
        return hypot(here.x - self._stalled_at.x, here.y - self._stalled_at.y) < self.clear

    def _speed(self, drive: int, situation: Situation) -> float:
        around, left = situation.around, self._end - situation.now
        start, end = (-AHEAD, AHEAD) if drive > 0 else (AHEAD, -AHEAD)
        echo = around.nearest(start, end, Buffer.WINDOW)
        room = echo.distance - situation.model.radius
        if left <= self.seconds / 2 and 0 < room < self.obstacle_distance:
            return 0.0
        return drive * self.speed


def _away(situation: Situation) -> int:
    """Return 1 to turn left, -1 to turn right."""
    motors = situation.snapshot.motors
    if motors.left_stalled != motors.right_stalled:
        return -1 if motors.left_stalled else 1
    right = situation.around.nearest(-SIDE_TO, -SIDE_FROM).distance
    left = situation.around.nearest(SIDE_FROM, SIDE_TO).distance
    return 1 if right < left else -1


@dataclass(slots=True)
class Unstick(Action):
    """Takes the way with most room when the robot has hardly moved for a while.

    Not one of ARIA's: its avoiders turn for ever where something is near all around, though there
    is room enough to drive out.

    Attributes:
        patience: So long it waits [s].
        distance: Moving less is hardly moving [m].
        seconds: So long it drives at most [s].
        way: So far it drives at most [m].
    """

    patience: float = 12.0
    distance: float = 0.3
    seconds: float = 15.0
    way: float = 1.2
    speed: float = 0.15
    name: str = "unstick"
    _explore: Explore = field(default_factory=Explore, init=False)
    _anchor: Pose2 = field(default=ORIGIN, init=False)
    _since: float | None = field(default=None, init=False)
    _until: float = field(default=-inf, init=False)

    def decide(self, situation: Situation) -> Desire | None:
        """Return the way out while it is needed."""
        here, now = situation.pose, situation.now
        moved = hypot(here.x - self._anchor.x, here.y - self._anchor.y)
        if now < self._until and moved < self.way:
            self._explore.speed = self.speed
            desire = self._explore.decide(situation)
            return Desire(v=desire.v, heading=desire.heading, reason=f"way out, {desire.reason}")
        if self._since is None or self._until > -inf or moved > self.distance:
            self._anchor, self._since, self._until = here, now, -inf
        elif now - self._since > self.patience:
            self._until = now + self.seconds
            self._anchor = here
        return None
