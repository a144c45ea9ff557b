"""What one action wants of the robot (arcos.md 7.3)."""

from dataclasses import dataclass
from math import inf, isfinite


@dataclass(frozen=True, slots=True)
class Wish:
    """A value wanted, and how much: 1 leaves nothing to lower priorities, 0 is no wish at all."""

    value: float
    strength: float = 1.0

    def __post_init__(self) -> None:
        if not 0 <= self.strength <= 1:
            raise ValueError(f"strength must be 0 to 1, not {self.strength}")


Channel = float | Wish | None
"""A wish, a number wanted with strength 1, or nothing."""

MOTION = ("v", "turn", "w")
"""Channels that are mixed by strength."""
LOWEST = (
    "v_max",
    "back_max",
    "left_max",
    "right_max",
    "acceleration",
    "turn_acceleration",
)
"""Limits of which the lowest holds."""
HIGHEST = ("deceleration", "turn_deceleration")
"""Limits of which the highest holds: braking harder is the safer side."""
LIMITS = frozenset((*LOWEST, *HIGHEST))
CHANNELS = ("v", "turn", "heading", "w", *LOWEST, *HIGHEST)


@dataclass(frozen=True, slots=True, kw_only=True)
class Desire:
    """What one action wants; `None` leaves that channel to lower priorities.

    Limits hold whatever their strength, unless that is 0; the safest value wins.

    Attributes:
        v: Speed [m/s].
        turn: Turn from the present heading [rad], counter-clockwise positive.
        heading: Heading in odometry's frame to turn to [rad]; in place of `turn`.
        w: Turn rate [rad/s].
        v_max: Limit of the speed forwards [m/s].
        back_max: Limit of the speed backwards [m/s], positive.
        left_max: Limit of the turn rate counter-clockwise [rad/s].
        right_max: Limit of the turn rate clockwise [rad/s], positive.
        acceleration: Limit of speeding up [m/s^2].
        deceleration: Least deceleration to brake with [m/s^2].
        turn_acceleration: Limit of turning faster [rad/s^2].
        turn_deceleration: Least deceleration of turns [rad/s^2].
        until: When this stops being wanted [s, monotonic].
        despite_stall: Whether this is the answer to a stall, which ends every other motion.
        reason: Shown to people, in a few words: what was seen.
    """

    v: Channel = None
    turn: Channel = None
    heading: Channel = None
    w: Channel = None
    v_max: Channel = None
    back_max: Channel = None
    left_max: Channel = None
    right_max: Channel = None
    acceleration: Channel = None
    deceleration: Channel = None
    turn_acceleration: Channel = None
    turn_deceleration: Channel = None
    until: float = inf
    despite_stall: bool = False
    reason: str = ""

    def __post_init__(self) -> None:
        if self.turn is not None and self.heading is not None:
            raise ValueError("wants a turn and a heading at once")
        for channel in CHANNELS:
            wish = getattr(self, channel)
            if wish is None:
                continue
            value = wish.value if isinstance(wish, Wish) else wish
            if not isfinite(value):
                raise ValueError(f"{channel} is {value}, which is no number to drive by")
            if value < 0 and channel in LIMITS:
                raise ValueError(f"{channel} must not be negative, as {value} is")


def as_wish(channel: Channel) -> Wish | None:
    """Return what a channel holds, or `None` if it is nothing."""
    if channel is None:
        return None
    wish = channel if isinstance(channel, Wish) else Wish(channel)
    return wish if wish.strength > NO_STRENGTH else None


NO_STRENGTH = 1e-6
"""Weaker wishes are none (arcos.md 7.3)."""
