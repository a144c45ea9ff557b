"""Keys that set a speed."""

from dataclasses import dataclass, field
from math import inf, radians

from pioneer3.behaviors.desire import Desire
from pioneer3.behaviors.situation import Situation


@dataclass(slots=True)
class KeyDrive:
    """Drives at the speed that keys have set; each key that turns does so for one reading.

    ARIA's Keydrive (arcos.md 7.6): :meth:`up`, :meth:`down`, :meth:`left`, :meth:`right`,
    :meth:`space` are its keys.

    Attributes:
        max_velocity: Either way [m/s].
        max_turn: Ahead of the present heading [rad].
        velocity_step: Per key [m/s].
        turn_step: Per key [rad].
    """

    max_velocity: float = 0.4
    max_turn: float = radians(24)
    velocity_step: float = 0.025
    turn_step: float = radians(8)
    name: str = "key drive"
    _velocity: float = field(default=0.0, init=False)
    _change: float = field(default=0.0, init=False)
    _turn: float = field(default=0.0, init=False)
    _reading: int | None = field(default=None, init=False)

    def up(self) -> None:
        """Faster forwards."""
        self._change += self.velocity_step

    def down(self) -> None:
        """Slower, and backwards."""
        self._change -= self.velocity_step

    def left(self) -> None:
        """Turn left."""
        self._steer(self.turn_step)

    def right(self) -> None:
        """Turn right."""
        self._steer(-self.turn_step)

    def space(self) -> None:
        """Stand still."""
        self._velocity = self._change = self._turn = 0.0

    def decide(self, situation: Situation) -> Desire:
        """Return the speed, and the turn once."""
        higher = situation.higher
        if higher.strength("v") >= 1:
            self._velocity = situation.twist.v
        top = min(self.max_velocity, higher.limits.get("v_max", inf))
        bottom = min(self.max_velocity, higher.limits.get("back_max", inf))
        self._velocity = max(-bottom, min(top, self._velocity + self._change))
        self._change = 0.0
        return Desire(v=self._velocity, turn=self._turn_once(situation), reason="by keys")

    def _steer(self, step: float) -> None:
        if self._reading is not None:
            self._turn, self._reading = 0.0, None
        self._turn = max(-self.max_turn, min(self.max_turn, self._turn + step))

    def _turn_once(self, situation: Situation) -> float:
        """Return the turn for the whole of one reading, however often asked during it."""
        reading = situation.snapshot.sequence
        if self._reading is None and self._turn:
            self._reading = reading
        elif self._reading != reading:
            self._turn, self._reading = 0.0, None
        return self._turn
