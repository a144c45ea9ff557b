"""Bounds on motion: where they come from, and what cannot be one."""

from dataclasses import replace
from math import inf, nan, radians
from typing import Any

import pytest
from msgspec import structs

from pioneer3.arcos.reports import Config
from pioneer3.errors import CommandError, ConfigError
from pioneer3.geometry import Twist2
from pioneer3.limits import Limits
from pioneer3.models import load_model
from pioneer3.robot.limits import checked, finite, limit, limits_for
from pioneer3.state import Bumpers

MODEL = load_model("p3at-sh")
LIMITS = Limits(max_speed=1.0, max_turn_rate=2.0)
CONFIG = Config(family="Pioneer", model="p3at-sh", serial_number="1")


@pytest.mark.parametrize("name", Limits.__dataclass_fields__)
@pytest.mark.parametrize("value", [0, -1, nan, inf, "1", None])
def test_a_limit_is_a_positive_number(name: str, value: Any) -> None:
    with pytest.raises(ConfigError, match=f"limits: {name} must be a positive number"):
        replace(LIMITS, **{name: value})


@pytest.mark.parametrize("expiry", [0.05, 2.5])
def test_an_expiry_is_neither_a_blink_nor_longer_than_the_watchdog(expiry: float) -> None:
    with pytest.raises(ConfigError, match=r"expiry must be 0\.1 to 2 s"):
        replace(LIMITS, expiry=expiry)


def test_without_config_the_models_maxima_hold() -> None:
    limits = limits_for(MODEL, None)
    assert (limits.max_speed, limits.max_turn_rate) == (MODEL.max_speed, MODEL.max_turn_rate)
    assert limits.acceleration == MODEL.acceleration


@pytest.mark.parametrize(
    ("top", "current", "speed"),
    [
        (0, 0, 1.2),
        (800, 0, 0.8),
        (0, 700, 0.7),
        (800, 700, 0.7),
        (700, 800, 0.7),
        (9999, 9999, 1.2),
    ],
)
def test_config_lowers_the_maxima_and_zero_says_nothing(
    top: int, current: int, speed: float
) -> None:
    config = structs.replace(CONFIG, speed_top_mm_s=top, speed_max_mm_s=current)
    model = replace(MODEL, max_speed=1.2)
    assert limits_for(model, config).max_speed == pytest.approx(speed)


def test_acceleration_is_the_robots_own_up_to_its_top() -> None:
    config = structs.replace(CONFIG, accel_mm_s2=500, accel_top_mm_s2=400, rotation_accel_deg_s2=50)
    limits = limits_for(MODEL, config)
    assert limits.acceleration == pytest.approx(0.4)
    assert limits.turn_acceleration == pytest.approx(radians(50))
    assert limits.deceleration <= 0.4 + 1e-9


@pytest.mark.parametrize("value", [True, False, "1", None, [1], 1j])
def test_what_is_no_number_is_named(value: Any) -> None:
    with pytest.raises(CommandError, match="length must be a number, not "):
        finite("length", value)


@pytest.mark.parametrize("value", [nan, inf, -inf])
def test_what_is_not_finite_is_named(value: float) -> None:
    with pytest.raises(CommandError, match="length must be finite, not "):
        finite("length", value)


def test_a_number_beyond_all_floats_is_refused_too() -> None:
    with pytest.raises(CommandError, match="length is too large"):
        finite("length", 10**400)


def test_a_twist_names_its_part() -> None:
    assert checked(1, 0.5) == Twist2(1.0, 0.5)
    with pytest.raises(CommandError, match="speed must be finite"):
        checked(nan, 0.0)
    with pytest.raises(CommandError, match="turn rate must be finite"):
        checked(0.0, nan)


def test_speed_and_turn_rate_shrink_together() -> None:
    assert limit(Twist2(4.0, 2.0), LIMITS, Bumpers()) == Twist2(1.0, 0.5)
    assert limit(Twist2(-0.5, 4.0), LIMITS, Bumpers()) == Twist2(-0.25, 2.0)
