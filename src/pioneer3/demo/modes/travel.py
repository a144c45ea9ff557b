"""A way to drive and a heading to turn to, one, the other or both at a time."""

from dataclasses import dataclass, field
from math import cos, radians, sin

from pioneer3.behaviors.action import Desire, Situation
from pioneer3.behaviors.engine import approach
from pioneer3.geometry import Pose2, wrap
from pioneer3.units import DEGREE

NEAR, ALIGNED = 0.005, radians(1)
"""Near enough [m], [rad]."""
STANDING, TURNING = 0.01, radians(2)
"""Slower than this is standing [m/s], [rad/s]."""


@dataclass(slots=True)
class Travel:
    """Does what MOVE and HEAD do, bounded by the robot's limits.

    Attributes:
        name: Shown to people.
        done: Whether it is where it should be, and stands.
    """

    name: str = "travel"
    done: bool = False
    _left: float = field(default=0.0, init=False)
    _heading: float | None = field(default=None, init=False)
    _last: Pose2 | None = field(default=None, init=False)

    def go(self, distance: float) -> None:
        """Drive `distance` [m] along the way, wherever that bends; negative is backwards."""
        self._left, self.done = distance, False

    def face(self, heading: float) -> None:
        """Turn to `heading` in odometry's frame [rad], or keep it."""
        self._heading, self.done = wrap(heading), False

    def decide(self, situation: Situation) -> Desire:
        """Return speed and heading for what is left."""
        here, twist, limits = situation.pose, situation.twist, situation.limits
        if self._last is not None:
            dx, dy = here.x - self._last.x, here.y - self._last.y
            self._left -= dx * cos(here.theta) + dy * sin(here.theta)
        self._last = here
        there = abs(self._left) <= NEAR
        off = 0.0 if self._heading is None else wrap(self._heading - here.theta)
        aligned = abs(off) <= ALIGNED
        still = abs(twist.v) < STANDING and abs(twist.w) < TURNING
        self.done = there and aligned and still
        return Desire(
            v=0.0 if there else approach(self._left, limits.max_speed, limits.deceleration),
            heading=None if aligned else self._heading,
            w=0.0 if aligned else None,
            reason="there" if there and aligned else self._to_go(off),
        )

    def _to_go(self, off: float) -> str:
        return f"{self._left:z.2f} m and {off / DEGREE:z.0f} deg to go"
