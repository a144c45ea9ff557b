"""Where a robot and its twin part: how far, and the cause that fits best."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from math import pi, radians

from pioneer3.geometry import Pose2, wrap
from pioneer3.models import RobotModel
from pioneer3.state import Snapshot

LEAST = 0.03
"""Ways of wheels that differ by less agree [m]."""
STANDS = 0.15
"""Wheels that went less than this share of the way that they should have gone stand."""
ALIKE = 0.5
"""Both sides are slow if the better one lacks at least this share of what the other lacks."""
NEAR = 0.3
"""An echo so near ahead of a sonar is of something in the way [m]."""
AHEAD = radians(60)
"""Directions that count as ahead, to both sides [rad]."""


class Cause(StrEnum):
    """The reason that fits best where a robot does not do what its twin does."""

    IN_THE_WAY = "something is in the way"
    HELD = "its wheels do not turn: it is held, braked, or stands against something low"
    BATTERY = "it is slow, and its battery is low"
    SLOW = "both sides are slow: a load, a slope, or weak motors"
    LEFT_DRAGS = "its left side drags"
    RIGHT_DRAGS = "its right side drags"
    PUSHED = "it is pushed, or rolls"
    SLIPS = "its wheels slip"
    SPINS = "its wheels turn, and it does not move: it is held, lifted, or stuck"


@dataclass(frozen=True, slots=True)
class Parting:
    """The difference between a robot and its twin, and the reason for it that fits best.

    `lacks` is the share of the way that the robot did not go, negative for too much; `twin_in_odom`
    is where a twin is now that was beside the robot when the compared time began [m, rad].
    """

    cause: Cause
    lacks: float
    twin_in_odom: Pose2

    @property
    def text(self) -> str:
        """The sentence for people."""
        if not self.lacks or self.cause in {Cause.PUSHED, Cause.HELD, Cause.IN_THE_WAY}:
            return self.cause
        return f"{self.cause} ({100 * self.lacks:.0f} % of the way are missing)"


HOLDS = {Cause.HELD, Cause.IN_THE_WAY, Cause.LEFT_DRAGS, Cause.RIGHT_DRAGS}
"""Causes that keep a robot where it is."""


@dataclass(frozen=True, slots=True)
class SideLack:
    """The way that a side was told to go, what it lacks of it, and how much may be lacking [m]."""

    told: float
    missing: float
    allowed: float

    @property
    def share(self) -> float:
        """The missing share of the way; 0 where there was none to go."""
        return self.missing / self.told if abs(self.told) > LEAST else 0.0

    @property
    def excess(self) -> float:
        """How much more than allowed is missing, or too much [m]; positive if that is wrong."""
        return abs(self.missing) - self.allowed


def best_of(compared: Iterable[list[SideLack]]) -> list[SideLack]:
    """Return the comparison with the twin of the delay that fits best."""
    return min(compared, key=lambda both: max(each.excess for each in both))


def cause_of(lacks: Sequence[SideLack], snapshot: Snapshot, model: RobotModel) -> Cause:
    """Return the cause of wheels that differ from what they were told."""
    shares = [each.share for each in lacks]
    if min(shares) > 1 - STANDS:
        return held_by(snapshot, model, back=sum(each.told for each in lacks) < 0)
    if max(shares) <= 0:
        return Cause.PUSHED
    if min(shares) < ALIKE * max(shares):
        return Cause.LEFT_DRAGS if shares[0] > shares[1] else Cause.RIGHT_DRAGS
    return Cause.BATTERY if snapshot.battery.low else Cause.SLOW


def held_by(snapshot: Snapshot, model: RobotModel, *, back: bool) -> Cause:
    """Return the cause for which no wheel turns."""
    is_met = any((*snapshot.bumpers.front, *snapshot.bumpers.rear))
    return Cause.IN_THE_WAY if is_met or _is_near(snapshot, model, back=back) else Cause.HELD


def _is_near(snapshot: Snapshot, model: RobotModel, *, back: bool) -> bool:
    """Whether something echoes close ahead, or behind."""
    pairs = zip(model.sonars, snapshot.sonar.ranges, strict=False)
    return any(
        heard < NEAR and abs(wrap(mount.theta + (pi if back else 0.0))) < AHEAD
        for mount, heard in pairs
    )
