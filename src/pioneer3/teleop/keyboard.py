"""From key presses to a velocity, for terminals, which know no key-up. Pure."""

from dataclasses import dataclass, field
from enum import Enum, auto
from math import inf
from typing import Final

from pioneer3.errors import CommandError, ConfigError
from pioneer3.geometry import Twist2
from pioneer3.limits import Limits
from pioneer3.robot.limits import checked

HOLD = 0.6
"""How long a key acts [s]: longer than the pause before a keyboard begins to repeat."""
STEP = 1.1
"""Factor of one press of + or -."""
PATIENCE = 10.0
"""Longest time that a speed set by a key lasts without a further key [s]: a frozen terminal, or a
driver who has walked away, cannot be seen."""


def patient(seconds: float) -> float:
    """Return `seconds`, the time that a speed set by a key lasts without a further key.

    Raises:
        ConfigError: it is not positive, or longer than :data:`PATIENCE`.
    """
    if not 0 < seconds <= PATIENCE:
        raise ConfigError(f"patience must be more than 0 s and at most 10 s, not {seconds:g} s")
    return seconds


class Key(Enum):
    """Keys that mean something; RESET releases the emergency stop."""

    FORWARD = auto()
    BACK = auto()
    LEFT = auto()
    RIGHT = auto()
    STOP = auto()
    FASTER = auto()
    SLOWER = auto()
    MOTORS = auto()
    EMERGENCY = auto()
    RESET = auto()
    QUIT = auto()


MOVES = {Key.FORWARD: (1, 0), Key.BACK: (-1, 0), Key.LEFT: (0, 1), Key.RIGHT: (0, -1)}


@dataclass(slots=True)
class Keyboard:
    """The keys that act, and the twist that they ask for.

    Each of the two axes follows its last key for :data:`HOLD`, so that alternating two keys drives
    a curve; with `latch`, a key acts until another one or a stop, as in the lab's `rob_key`, but
    only for `patience` after the last key of any kind [s]. Speeds are in [m/s, rad/s]; faster goes
    no further than the largest.
    """

    speed: float = 0.5
    turn_rate: float = 0.5
    latch: bool = False
    patience: float = PATIENCE
    max_speed: float = inf
    max_turn_rate: float = inf
    _forward: tuple[int, float] = field(default=(0, -inf), init=False)
    _turn: tuple[int, float] = field(default=(0, -inf), init=False)

    def __post_init__(self) -> None:
        patient(self.patience)

    def press(self, key: Key, now: float) -> None:
        """Take a key at `now` [s, monotonic]; keys that are not about motion only renew it."""
        until = now + (self.patience if self.latch else HOLD)
        match key:
            case Key.FORWARD | Key.BACK:
                self._forward = (MOVES[key][0], until)
                if self.latch:
                    self._turn = (0, -inf)
            case Key.LEFT | Key.RIGHT:
                self._turn = (MOVES[key][1], until)
                if self.latch:
                    self._forward = (0, -inf)
            case Key.STOP:
                self._forward = self._turn = (0, -inf)
            case Key.FASTER | Key.SLOWER:
                factor = STEP if key is Key.FASTER else 1 / STEP
                self.speed = min(self.speed * factor, self.max_speed)
                self.turn_rate = min(self.turn_rate * factor, self.max_turn_rate)
        if self.latch:
            self._forward, self._turn = (
                (sign, until if end > now else end) for sign, end in (self._forward, self._turn)
            )

    def has_run_out(self, now: float) -> bool:
        """Return whether a latched key has ended because no other one came."""
        return self.latch and -inf < max(self._forward[1], self._turn[1]) <= now

    def wanted(self, now: float) -> tuple[Twist2, float]:
        """Return the twist, and for how long it holds from `now` [s]; zero when nothing acts."""
        (forward, forward_until), (turn, turn_until) = self._forward, self._turn
        forward = forward if now < forward_until else 0
        turn = turn if now < turn_until else 0
        ends = [until for until in (forward_until, turn_until) if until > now]
        twist = Twist2(forward * self.speed, turn * self.turn_rate)
        return twist, min(ends, default=now) - now


FLICK_RATE: Final = 3.0
"""Slower turns mean nothing [rad/s]."""


def key_of_rotation(x: float, y: float, z: float) -> Key | None:
    """Return the key that a phone's turning stands for, if any.

    It turns about its right-hand side, `x`, for forward and back, about its upper side, `y`, for
    stop, and about its screen, `z`, for left and right [rad/s].
    """
    if abs(x) > FLICK_RATE:
        return Key.FORWARD if x > 0 else Key.BACK
    if abs(z) > FLICK_RATE:
        return Key.LEFT if z > 0 else Key.RIGHT
    return Key.STOP if abs(y) > FLICK_RATE else None


@dataclass(frozen=True, slots=True, kw_only=True)
class Manner:
    """How keys drive [m/s, rad/s], below `max_speed` or `None` for the robot's own bound.

    With `latch` one press keeps moving until another key, or for the `patience` without any [s].
    """

    speed: float = 0.1
    turn_rate: float = 0.1
    max_speed: float | None = None
    latch: bool = False
    patience: float = PATIENCE

    def keyboard(self, limits: Limits) -> Keyboard:
        """Return a keyboard that asks for no more than a robot can do.

        Raises:
            CommandError: a speed is not a positive number.
            ConfigError: as :func:`patient`.
        """
        wanted, most = checked(self.speed, self.turn_rate), limits.lowered_to(self.max_speed, None)
        if wanted.v <= 0 or wanted.w <= 0:
            raise CommandError("speed and turn rate must be positive")
        return Keyboard(
            speed=min(wanted.v, most.max_speed),
            turn_rate=min(wanted.w, most.max_turn_rate),
            latch=self.latch,
            patience=self.patience,
            max_speed=most.max_speed,
            max_turn_rate=most.max_turn_rate,
        )
