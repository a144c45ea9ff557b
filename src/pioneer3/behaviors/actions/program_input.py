"""What a program sets, beside limiters and other actions."""

from dataclasses import dataclass, field

from pioneer3.behaviors.desire import Desire
from pioneer3.behaviors.situation import Situation
from pioneer3.geometry import wrap


@dataclass(slots=True)
class Input:
    """Passes on what a program has set until it sets something else (arcos.md 7.6).

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
        """Return what was set last."""
        if self._turn is not None:  # held as a heading: one reading is too short to turn in
            self._heading, self._turn = wrap(situation.pose.theta + self._turn), None
        if self._v is None and self._w is None and self._heading is None:
            return None
        return Desire(v=self._v, w=self._w, heading=self._heading, reason="by program")
