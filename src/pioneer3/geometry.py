"""Plane geometry on plain floats: [m], [rad], counter-clockwise positive (REP 103)."""

from dataclasses import dataclass
from math import cos, isfinite, pi, remainder, sin
from typing import NamedTuple

TURN = 2 * pi


def wrap(angle: float) -> float:
    """Return `angle` [rad] wrapped to (-pi, pi]."""
    wrapped = remainder(angle, TURN)
    return pi if wrapped == -pi else wrapped


class Extent(NamedTuple):
    """An axis-aligned box [m]."""

    x_min: float
    y_min: float
    x_max: float
    y_max: float


@dataclass(frozen=True, slots=True)
class Twist2:
    """Body velocity: `v` forward [m/s], `w` counter-clockwise [rad/s]."""

    v: float = 0.0
    w: float = 0.0

    @property
    def is_finite(self) -> bool:
        """Whether neither part is NaN or infinite."""
        return isfinite(self.v) and isfinite(self.w)

    @property
    def is_zero(self) -> bool:
        """Whether both parts are zero."""
        return self.v == 0.0 and self.w == 0.0


STILL = Twist2()


@dataclass(frozen=True, slots=True)
class Pose2:
    """Position [m] and heading [rad] in some frame."""

    x: float = 0.0
    y: float = 0.0
    theta: float = 0.0

    def __matmul__(self, other: "Pose2") -> "Pose2":
        """Compose: `other` is expressed in this pose's frame."""
        c, s = cos(self.theta), sin(self.theta)
        return Pose2(
            self.x + c * other.x - s * other.y,
            self.y + s * other.x + c * other.y,
            wrap(self.theta + other.theta),
        )

    def inverse(self) -> "Pose2":
        """Return the pose that composes with this one to the identity."""
        c, s = cos(self.theta), sin(self.theta)
        return Pose2(-c * self.x - s * self.y, s * self.x - c * self.y, wrap(-self.theta))


ORIGIN = Pose2()


def arc(v: float, w: float, dt: float) -> Pose2:
    """Return the motion of a body that holds twist (`v` [m/s], `w` [rad/s]) for `dt` [s].

    The exact circular arc, expressed in the frame of the start pose.
    """
    turned = w * dt
    half = turned / 2
    chord = v * dt * chord_of_arc(half)
    return Pose2(chord * cos(half), chord * sin(half), wrap(turned))


def chord_of_arc(half: float) -> float:
    """Return the chord of an arc over its length; `half` is half of its angle [rad]."""
    # the series keeps a straight line exact
    return sin(half) / half if abs(half) > 1e-6 else 1 - half * half / 6


def arc_to(step: Pose2) -> tuple[Twist2, float]:
    """Return the way and the turn of the arc that leads to `step`, and the slip across it [m].

    The reverse of :func:`arc` within 1 s; a turn is less than a whole one.
    """
    half = step.theta / 2
    chord = Pose2(theta=-half) @ step
    return Twist2(chord.x / chord_of_arc(half), step.theta), chord.y
