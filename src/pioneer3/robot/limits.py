"""Limits that every velocity command passes last; `send_unsafe` goes past them."""

from math import isfinite

from pioneer3.arcos.reports import Config
from pioneer3.errors import CommandError
from pioneer3.geometry import Twist2
from pioneer3.limits import Limits
from pioneer3.models import RobotModel
from pioneer3.state import Bumpers
from pioneer3.units import DEGREE, MM


def limits_for(model: RobotModel, config: Config | None) -> Limits:
    """Return the model's limits, cut to what the robot's own CONFIG allows (protocol.md 5.1).

    Decelerations are the model's `braking`, which is harder than the firmware's default, on robots
    that let a host set it; accelerations are those of CONFIG. A field of CONFIG that is 0 or
    missing is ignored.
    """
    c = config or Config(family="", model="", serial_number="")
    deceleration = _given(c.decel_mm_s2, MM, model.deceleration)
    turn_deceleration = _given(c.rotation_decel_deg_s2, DEGREE, model.turn_deceleration)
    if model.settable_acceleration:
        deceleration = max(model.braking, _given(c.decel_mm_s2, MM, 0.0))
        turn_deceleration = max(model.turn_braking, _given(c.rotation_decel_deg_s2, DEGREE, 0.0))
    return Limits(
        max_speed=_cut(model.max_speed, MM, c.speed_top_mm_s, c.speed_max_mm_s),
        max_turn_rate=_cut(model.max_turn_rate, DEGREE, c.rotation_top_deg_s, c.rotation_max_deg_s),
        acceleration=_cut(_given(c.accel_mm_s2, MM, model.acceleration), MM, c.accel_top_mm_s2),
        deceleration=_cut(deceleration, MM, c.accel_top_mm_s2),
        turn_acceleration=_cut(
            _given(c.rotation_accel_deg_s2, DEGREE, model.turn_acceleration),
            DEGREE,
            c.rotation_accel_top_deg_s2,
        ),
        turn_deceleration=_cut(turn_deceleration, DEGREE, c.rotation_accel_top_deg_s2),
    )


def _given(value: int | None, unit: float, otherwise: float) -> float:
    return value * unit if value else otherwise


def _cut(value: float, unit: float, *tops: int | None) -> float:
    return min([value, *(top * unit for top in tops if top)])


def checked(speed: float, turn_rate: float) -> Twist2:
    """Return the twist (`speed` [m/s], `turn_rate` [rad/s]); CommandError as of :func:`finite`."""
    return Twist2(finite("speed", speed), finite("turn rate", turn_rate))


def wheels_as_twist(left: float, right: float, model: RobotModel) -> Twist2:
    """Return the twist of wheels with these speeds [m/s]; CommandError as of :func:`finite`."""
    left, right = finite("left", left), finite("right", right)
    return Twist2((left + right) / 2, (right - left) / model.true_base)


def finite(name: str, value: float) -> float:
    """Return `value` as a float.

    Raises:
        CommandError: not a number, or not finite. Such a command must not renew motion.
    """
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise CommandError(f"{name} must be a number, not {value!r}")
    try:
        number = float(value)
    except OverflowError:
        raise CommandError(f"{name} is too large") from None
    if not isfinite(number):
        raise CommandError(f"{name} must be finite, not {value!r}")
    return number


def limit(twist: Twist2, limits: Limits, bumpers: Bumpers) -> Twist2:
    """Return the nearest twist within `limits` that does not push against a pressed bumper.

    Speed and turn rate are scaled together, which keeps the curvature.
    """
    scale = min(
        1.0,
        limits.max_speed / abs(twist.v) if twist.v else 1.0,
        limits.max_turn_rate / abs(twist.w) if twist.w else 1.0,
    )
    v, w = _clip(twist.v * scale, limits.max_speed), _clip(twist.w * scale, limits.max_turn_rate)
    if v > 0 and any(bumpers.front):
        v = 0.0
    if v < 0 and any(bumpers.rear):
        v = 0.0
    return Twist2(v, w)


def _clip(value: float, top: float) -> float:
    """Cut a rounding error above `top`."""
    return max(-top, min(top, value))
