"""A stick that drives while its button is held."""

from dataclasses import dataclass, field
from math import radians

from pioneer3.behaviors.desire import Desire
from pioneer3.behaviors.situation import Situation


@dataclass(frozen=True, slots=True, kw_only=True)
class Stick:
    """Where a joystick is.

    Attributes:
        x: -1 left to 1 right.
        y: -1 back to 1 forward.
        button: Whether it is held.
        throttle: 0 to 1.
    """

    x: float = 0.0
    y: float = 0.0
    button: bool = False
    throttle: float = 1.0


@dataclass(slots=True)
class JoyDrive:
    """Drives by :attr:`stick` while its button is held (ARIA's Joydrive, arcos.md 7.6).

    Attributes:
        speed_max: At full forward [m/s].
        turn_max: At full left, ahead of the present heading [rad].
        stop_if_no_button: Whether to stand still without the button, or to want nothing.
        throttle_low: Top speed with the throttle at 0 [m/s]; `None` leaves the throttle out.
        throttle_high: With the throttle at 1 [m/s].
        stick: Set by whoever reads it; `None` without one.
    """

    speed_max: float = 0.4
    turn_max: float = radians(15)
    stop_if_no_button: bool = True
    throttle_low: float | None = None
    throttle_high: float | None = None
    stick: Stick | None = field(default=None)
    name: str = "joy drive"

    def decide(self, situation: Situation) -> Desire | None:
        """Return what the stick says."""
        stick = self.stick
        if stick is None or not (stick.button or self.stop_if_no_button):
            return None
        if not stick.button:
            return Desire(v=0.0, turn=0.0, reason="the button is not held")
        return Desire(
            v=stick.y * self._top(stick), turn=-stick.x * self.turn_max, reason="by stick"
        )

    def _top(self, stick: Stick) -> float:
        low, high = self.throttle_low, self.throttle_high
        if low is None or high is None:
            return self.speed_max
        return low + stick.throttle * (high - low)
