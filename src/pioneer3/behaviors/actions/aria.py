"""Actions of ARIA that no mode here uses: for programs that are moved from ARIA."""

from dataclasses import dataclass, field
from math import radians

from pioneer3.behaviors.action import Action, Desire, Situation
from pioneer3.behaviors.actions.sensing import ahead, beside
from pioneer3.behaviors.surroundings import Buffer
from pioneer3.geometry import wrap

SIDE_BEGIN = radians(60)
"""Bearing from which on obstacles are beside the robot [rad]."""
SIDE_END = radians(120)
"""Bearing up to which obstacles are beside the robot [rad]."""


@dataclass(slots=True)
class AvoidSide(Action):
    """Stands and turns away from obstacles beside the robot (facts.md 7.6).

    When that is done it wants straight ahead once, as :class:`AvoidFront` does. ARIA's goes on
    wanting it for ever, and nothing of lower priority steers any more.

    Attributes:
        obstacle_distance: Nearer than this to the robot's circle is near [m].
    """

    obstacle_distance: float = 0.3
    turn_amount: float = radians(5)
    name: str = "avoid side"
    _turning: bool = field(default=False, init=False)

    def decide(self, situation: Situation) -> Desire | None:
        radius = situation.model.radius
        for side, start, end, sign in (
            ("left", SIDE_BEGIN, SIDE_END, -1),
            ("right", -SIDE_END, -SIDE_BEGIN, 1),
        ):
            distance = situation.around.nearest(start, end, Buffer.WINDOW).distance - radius
            if distance < self.obstacle_distance:
                self._turning = True
                return Desire(v=0.0, turn=sign * self.turn_amount, reason=beside(distance, side))
        if not self._turning:
            return None
        self._turning = False
        return Desire(turn=0.0, reason="the sides are free")


SIDE = radians(90)
"""Bearing up to which obstacles decide the side [rad]."""
SIDE_LOOK = 3.0
"""Distance beyond which nothing decides the side [m]."""


@dataclass(slots=True)
class TurnAway(Action):
    """Turns the more, the slower the robot has become (ARIA's Turn, facts.md 7.6).

    Below limiters of the speed it steers around what made them slow down. The side stays until the
    robot is fast again.

    Attributes:
        speed_start: Slower than this it turns [m/s].
        speed_full: Slower than this it turns in full [m/s].
        turn_amount: Full turn, ahead of the present heading [rad].
    """

    speed_start: float = 0.2
    speed_full: float = 0.1
    turn_amount: float = radians(15)
    name: str = "turn away"
    _side: int = field(default=0, init=False)

    def decide(self, situation: Situation) -> Desire | None:
        v = situation.twist.v
        if v > self.speed_start:
            self._side = 0
            return None
        amount = self.turn_amount
        if v >= self.speed_full:
            amount *= (self.speed_start - v) / (self.speed_start - self.speed_full)
        echo = situation.around.nearest(-SIDE, SIDE)
        near = echo.distance < SIDE_LOOK
        self._side = self._side or (-1 if near and echo.bearing > 0 else 1)
        reason = ahead(echo.distance - situation.model.radius, echo) if near else "slow"
        return Desire(turn=self._side * amount, reason=reason)


@dataclass(slots=True)
class Input(Action):
    """Passes on the command of a program until it sets another (facts.md 7.6).

    Unlike :class:`Hold` it does not expire by itself: a program that ends must end its stack.
    """

    name: str = "input"
    _v: float | None = field(default=None, init=False)
    _w: float | None = field(default=None, init=False)
    _turn: float | None = field(default=None, init=False)
    _heading: float | None = field(default=None, init=False)

    def drive_at(self, v: float) -> None:
        """Want the speed `v` [m/s]."""
        self._v = v

    def turn_at(self, w: float) -> None:
        """Want the turn rate `w` [rad/s]."""
        self._w, self._turn, self._heading = w, None, None

    def turn_by(self, angle: float) -> None:
        """Want to turn by `angle` [rad] from where the robot looks when next asked."""
        self._w, self._turn, self._heading = None, angle, None

    def face(self, heading: float) -> None:
        """Want the heading [rad] of odometry's frame."""
        self._w, self._turn, self._heading = None, None, heading

    def clear(self) -> None:
        """Want nothing."""
        self._v = self._w = self._turn = self._heading = None

    def decide(self, situation: Situation) -> Desire | None:
        if self._turn is not None:  # held as a heading: one snapshot is too short to turn in
            self._heading, self._turn = wrap(situation.pose.theta + self._turn), None
        if self._v is None and self._w is None and self._heading is None:
            return None
        return Desire(v=self._v, w=self._w, heading=self._heading, reason="by program")


@dataclass(slots=True)
class Stop(Action):
    """Wants to stand still, whatever lower priorities want (facts.md 7.6)."""

    name: str = "stop"

    def decide(self, situation: Situation) -> Desire:
        return Desire(v=0.0, turn=0.0, reason="standing still")
