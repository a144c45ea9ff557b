"""The limiter: whatever is asked for, what comes out is within bounds and pushes nothing."""

from math import atan2, isfinite

from hypothesis import given
from hypothesis import strategies as st

from pioneer3.arcos.reports import Config
from pioneer3.geometry import Twist2
from pioneer3.limits import Limits
from pioneer3.models import load_model
from pioneer3.robot.limits import limit, limits_for
from pioneer3.state import Bumpers

FINITE = st.floats(allow_nan=False, allow_infinity=False)
TWISTS = st.builds(Twist2, FINITE, FINITE)
POSITIVE = st.floats(1e-3, 10)
LIMITS = st.builds(Limits, max_speed=POSITIVE, max_turn_rate=POSITIVE)
SEGMENTS = st.lists(st.booleans(), max_size=7).map(tuple)
BUMPERS = st.builds(Bumpers, front=SEGMENTS, rear=SEGMENTS)
WORD = st.integers(0, 65535)
CONFIGS = st.builds(
    Config,
    family=st.just("Pioneer"),
    model=st.just("p3at-sh"),
    serial_number=st.just(""),
    speed_top_mm_s=WORD,
    speed_max_mm_s=WORD,
    rotation_top_deg_s=WORD,
    rotation_max_deg_s=WORD,
    accel_mm_s2=WORD,
    decel_mm_s2=WORD,
    accel_top_mm_s2=WORD,
    rotation_accel_deg_s2=WORD,
    rotation_decel_deg_s2=WORD,
    rotation_accel_top_deg_s2=WORD,
)
FREE = Bumpers()


@given(TWISTS, LIMITS, BUMPERS)
def test_nothing_exceeds_the_limits(twist: Twist2, limits: Limits, bumpers: Bumpers) -> None:
    out = limit(twist, limits, bumpers)
    assert out.is_finite
    assert abs(out.v) <= limits.max_speed
    assert abs(out.w) <= limits.max_turn_rate


@given(TWISTS, LIMITS)
def test_no_limit_turns_a_motion_round_or_makes_it_larger(twist: Twist2, limits: Limits) -> None:
    out = limit(twist, limits, FREE)
    assert out.v * twist.v >= 0
    assert out.w * twist.w >= 0
    assert abs(out.v) <= abs(twist.v)
    assert abs(out.w) <= abs(twist.w)


@given(st.floats(-5, 5), st.floats(-5, 5), LIMITS)
def test_the_curve_is_kept(v: float, w: float, limits: Limits) -> None:
    out = limit(Twist2(v, w), limits, FREE)
    if abs(out.v) > 1e-9 and abs(out.w) > 1e-9:
        assert abs(atan2(out.w, out.v) - atan2(w, v)) < 1e-6


@given(st.floats(-1, 1), st.floats(-1, 1))
def test_what_is_within_the_limits_passes_unchanged(v: float, w: float) -> None:
    assert limit(Twist2(v, w), Limits(max_speed=1, max_turn_rate=1), FREE) == Twist2(v, w)


@given(TWISTS, LIMITS, BUMPERS)
def test_a_touching_bumper_blocks_its_own_direction_only(
    twist: Twist2, limits: Limits, bumpers: Bumpers
) -> None:
    out, free = limit(twist, limits, bumpers), limit(twist, limits, FREE)
    assert out.w == free.w
    if (twist.v > 0 and any(bumpers.front)) or (twist.v < 0 and any(bumpers.rear)):
        assert out.v == 0
    else:
        assert out.v == free.v


@given(CONFIGS, st.sampled_from(["p3at-sh", "p3dx-sh", "amigo-sh"]))
def test_no_config_lifts_a_robot_above_its_models_maxima(config: Config, name: str) -> None:
    model = load_model(name)
    limits = limits_for(model, config)
    assert 0 < limits.max_speed <= model.max_speed
    assert 0 < limits.max_turn_rate <= model.max_turn_rate
    if config.speed_top_mm_s:
        assert limits.max_speed <= config.speed_top_mm_s / 1000 + 1e-12
    assert isfinite(limits.acceleration)


@given(LIMITS, st.one_of(st.none(), POSITIVE), st.one_of(st.none(), POSITIVE))
def test_options_only_ever_lower_a_limit(
    limits: Limits, speed: float | None, rate: float | None
) -> None:
    lowered = limits.lowered_to(speed, rate)
    assert lowered.max_speed == min(limits.max_speed, speed or 1e9)
    assert lowered.max_turn_rate == min(limits.max_turn_rate, rate or 1e9)
    assert lowered.deceleration == limits.deceleration
