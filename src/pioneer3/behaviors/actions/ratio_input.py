"""Drives by shares of full speed: keys, sticks, programs."""

from dataclasses import dataclass, field
from math import inf, radians

from pioneer3.behaviors.action import Action, Desire, Situation

DEAD_DRIVE = 0.1
"""Drive ratio below which there is none."""
DEAD_TURN = 0.05
"""Turn ratio below which there is none."""
AGAINST = 0.5
"""More than this against the motion means: brake."""
HARD = 3
"""So many times the robot's own deceleration."""


@dataclass(frozen=True, slots=True)
class Ratios:
    """Shares of full speed: `drive` forwards, `turn` counter-clockwise, each -1 to 1."""

    drive: float = 0.0
    turn: float = 0.0
    throttle: float = 1.0

    def __post_init__(self) -> None:
        for name, low in (("drive", -1), ("turn", -1), ("throttle", 0)):
            value = getattr(self, name)
            if not low <= value <= 1:
                raise ValueError(f"{name} must be {low} to 1, not {value}")


@dataclass(slots=True)
class RatioInput(Action):
    """Drives by shares of full speed (facts.md 7.6, 8.3). A pushed stick comes before keys.

    Keys: :meth:`up` and :meth:`down` change the speed by a twentieth, :meth:`left` and
    :meth:`right` turn in full for one period, :meth:`space` stops. A gamepad or a program
    :meth:`push` es and :meth:`release` s.

    Attributes:
        full_forwards: Speed at full forwards [m/s]; `None` is the robot's limit.
        full_backwards: [m/s]; `None` is a quarter of the robot's limit.
        turn_at_full_forwards: Turn rate when driving so fast [rad/s].
        turn_at_rest: Turn rate when standing [rad/s].
        key_step: Contribution of full speed per key.
    """

    full_forwards: float | None = None
    full_backwards: float | None = None
    turn_at_full_forwards: float = radians(25)
    turn_at_full_backwards: float = radians(25)
    turn_at_rest: float = radians(50)
    key_step: float = 0.05
    name: str = "ratio input"
    _keyed: float = field(default=0.0, init=False)
    _key_turn: int = field(default=0, init=False)
    _pressed: int = field(default=0, init=False)
    _sequence: int | None = field(default=None, init=False)
    _pushed: Ratios | None = field(default=None, init=False)
    _until: float = field(default=inf, init=False)

    @property
    def keyed(self) -> float:
        """Contribution of full speed set by keys, -1 to 1."""
        return round(self._keyed, 6)

    @property
    def too_little(self) -> bool:
        """Whether keys have set a share that moves nothing."""
        return 0 < abs(self.keyed) <= DEAD_DRIVE

    def up(self) -> None:
        """Faster forwards."""
        self._keyed = min(1.0, self._keyed + self.key_step)

    def down(self) -> None:
        """Slower, and backwards."""
        self._keyed = max(-1.0, self._keyed - self.key_step)

    def left(self) -> None:
        """Turn left, at once and until the snapshot after the next."""
        self._pressed = 1

    def right(self) -> None:
        """Turn right, at once and until the snapshot after the next."""
        self._pressed = -1

    def space(self) -> None:
        """Stand still."""
        self._keyed, self._key_turn, self._pressed, self._pushed = 0.0, 0, 0, None

    def push(self, drive: float, turn: float, throttle: float = 1.0, *, until: float = inf) -> None:
        """Push a stick: shares -1 to 1 forwards and counter-clockwise, until released.

        `until` [s, monotonic] it counts as released at the latest. Keys are forgotten, so that the
        robot does not set off again when the stick is let go.

        Raises:
            ValueError: a share is out of range.
        """
        self._pushed, self._until = Ratios(drive, turn, throttle), until
        self._keyed, self._key_turn, self._pressed = 0.0, 0, 0

    def release(self) -> None:
        """Let go of the stick."""
        self._pushed = None

    def decide(self, situation: Situation) -> Desire:
        if self._pushed is not None and situation.now >= self._until:
            self._pushed = None
        stick = self._pushed
        keys = Ratios(self.keyed, self._turn_once(situation))
        given = stick or keys
        model, twist = situation.model, situation.twist
        v, w = self._velocity(given, situation)
        return Desire(
            v=v,
            w=w,
            deceleration=HARD * model.deceleration if _against(given.drive, twist.v) else None,
            turn_deceleration=(
                HARD * model.turn_deceleration if _against(given.turn, twist.w) else None
            ),
            until=self._until if stick else inf,
            reason=("by stick" if stick else "by keys") if v or w else "no speed is set",
        )

    def _velocity(self, given: Ratios, situation: Situation) -> tuple[float, float]:
        top = situation.limits.max_speed
        drive = given.drive if abs(given.drive) > DEAD_DRIVE else 0.0
        turn = given.turn if abs(given.turn) > DEAD_TURN else 0.0
        if drive >= 0:
            full = top if self.full_forwards is None else self.full_forwards
            at_full = self.turn_at_full_forwards
        else:
            full = top / 4 if self.full_backwards is None else self.full_backwards
            at_full = self.turn_at_full_backwards
        rate = self.turn_at_rest
        if drive and full:
            rate += (at_full - rate) * min(1.0, abs(situation.twist.v) / full)
        return drive * full * given.throttle, turn * rate * given.throttle

    def _turn_once(self, situation: Situation) -> int:
        """Return the turn of a key: at once, and until the snapshot after the next.

        A held key repeats faster than snapshots come, so that it turns without a gap.
        """
        sequence = situation.snapshot.sequence
        if sequence != self._sequence:
            self._sequence, self._key_turn, self._pressed = sequence, self._pressed, 0
        return self._pressed or self._key_turn


def _against(ratio: float, speed: float) -> bool:
    return abs(ratio) > AGAINST and ratio * speed < 0
