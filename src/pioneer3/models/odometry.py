"""Errors of a robot's odometry as three ratios, and the numbers of its controller beside them."""

from dataclasses import dataclass
from typing import Annotated, Final, NamedTuple

from msgspec import Meta

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2, Twist2, arc_to, chord_of_arc

LEAST_RATIO: Final = 0.8
"""The smallest ratio that tires and loads explain; a smaller one is a slip of the pen."""
GREATEST_RATIO: Final = 1.25
"""The greatest one."""

Ratio = Annotated[float, Meta(ge=LEAST_RATIO, le=GREATEST_RATIO)]


class TwistMatrix(NamedTuple):
    """Linear map of twists, such as from the measured to the true one; `v_of_w` is in metres."""

    v_of_v: float
    v_of_w: float
    w_of_v: float
    w_of_w: float

    def of(self, twist: Twist2) -> Twist2:
        """Return `twist`, mapped."""
        return Twist2(
            self.v_of_v * twist.v + self.v_of_w * twist.w,
            self.w_of_v * twist.v + self.w_of_w * twist.w,
        )

    def of_step(self, step: Pose2) -> Pose2:
        """Return a short motion, mapped, in the frame of its start; slips stay."""
        arc, slip = arc_to(step)
        moved = self.of(arc)
        half = moved.w / 2
        return Pose2(theta=half) @ Pose2(moved.v * chord_of_arc(half), slip, half)

    def inverse(self) -> "TwistMatrix":
        """Return the map back."""
        size = self.v_of_v * self.w_of_w - self.v_of_w * self.w_of_v
        return TwistMatrix(
            self.w_of_w / size, -self.v_of_w / size, -self.w_of_v / size, self.v_of_v / size
        )


def true_of_measured(
    scale: float, base_ratio: float, wheel_ratio: float, width: float
) -> TwistMatrix:
    """Return the map from measured twists to true ones (Borenstein and Feng, UMBmark, 1995).

    `width` is what the controller takes for the distance of the wheels [m]; the ratios are those of
    :class:`OdometryCorrection`.
    """
    left, right = 2 * scale / (1 + wheel_ratio), 2 * scale * wheel_ratio / (1 + wheel_ratio)
    return TwistMatrix(
        (right + left) / 2,
        (right - left) * width / 4,
        (right - left) / width / base_ratio,
        (right + left) / 2 / base_ratio,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class EncoderNumbers:
    """Numbers by which a controller makes odometry of its encoders (protocol.md 3).

    Attributes:
        ticks_mm: Ticks for a millimetre of the way.
        rev_count: Ticks by which the sides differ after half a turn.
        drift_factor: Correction of the left side [1/8192 of its count].
    """

    ticks_mm: Annotated[int, Meta(ge=1, le=65535)]
    rev_count: Annotated[int, Meta(ge=1, le=65535)]
    drift_factor: Annotated[int, Meta(ge=-8191, le=32767)] = 0

    @property
    def half_turn(self) -> float:
        """Difference of both sides' ways on half a turn, to compare with that of others."""
        return self.rev_count / self.ticks_mm

    def since(self, before: "EncoderNumbers", width: float) -> TwistMatrix:
        """Return the map from twists by these numbers to those by the numbers `before`.

        `width` is what the controller took for the distance of the wheels by those before [m].
        """
        right = self.ticks_mm / before.ticks_mm
        left = right * (1 + before.drift_factor / 8192) / (1 + self.drift_factor / 8192)
        ratio = before.half_turn / self.half_turn
        return true_of_measured((left + right) / 2, ratio, right / left, width / ratio)


@dataclass(frozen=True, slots=True)
class OdometryCorrection:
    """Measured errors of one robot's odometry, which the driver corrects.

    Attributes:
        scale: True way over measured way.
        base_ratio: Distance of the wheels over what the controller takes it for.
        wheel_ratio: Diameter of the right wheel over that of the left.

    Raises:
        ConfigError: A ratio is out of its range.
    """

    scale: Ratio = 1.0
    base_ratio: Ratio = 1.0
    wheel_ratio: Ratio = 1.0

    def __post_init__(self) -> None:
        """Refuse ratios that no wheels have, with the name of the field."""
        for name in ("scale", "base_ratio", "wheel_ratio"):
            value = getattr(self, name)
            if not LEAST_RATIO <= value <= GREATEST_RATIO:
                expected = f"expected {LEAST_RATIO:g} to {GREATEST_RATIO:g}"
                raise ConfigError(f"odometry.{name}: {value:g} is out of range, {expected}")

    def matrix(self, width: float) -> TwistMatrix | None:
        """Return the map from measured to true twists; `None` where nothing is to be corrected.

        `width` is what the controller takes for the distance of the wheels [m].
        """
        if self == UNCORRECTED:
            return None
        return true_of_measured(self.scale, self.base_ratio, self.wheel_ratio, width)


UNCORRECTED: Final = OdometryCorrection()
"""Nothing is to be corrected."""
