"""What holds for every person, echo and report."""

from dataclasses import replace
from math import cos, inf, isfinite, radians, sin

from hypothesis import given
from hypothesis import strategies as st

from pioneer3.behaviors.actions.follow import FollowLab, FollowTracking
from pioneer3.behaviors.actions.limiters import BRAKE_DELAY, PLANNED_SHARE, stopping_speed
from pioneer3.behaviors.kalman import FASTEST_FOLLOWED, KalmanFilter
from pioneer3.geometry import Pose2
from pioneer3.state import Sonar
from tests.unit.behaviors.support import seen, value

ANGLES = st.floats(-3.2, 3.2)
MEASURED = st.lists(
    st.tuples(ANGLES, st.floats(-1, 1), st.floats(0.01, 1), st.floats(0, 1)), max_size=30
)
RANGES = st.lists(st.floats(0.1, 5.0) | st.just(inf), min_size=8, max_size=8)
FRESH = st.sets(st.integers(0, 7)).map(lambda numbers: tuple(sorted(numbers)))
REPORTS = st.lists(
    st.tuples(RANGES, FRESH, st.floats(-0.05, 0.05), st.floats(-0.1, 0.1)), max_size=60
)


def measured(corrections: list[tuple[float, float, float, float]]) -> KalmanFilter:
    estimate, now = KalmanFilter(1.0, -2.0, 0.0, 0.15), 0.0
    for angle, error, sigma, dt in corrections:
        now += dt
        estimate.advance(now)
        estimate.correct(cos(angle), sin(angle), error, sigma)
    return estimate


@given(MEASURED, ANGLES)
def test_doubt_is_symmetric_and_never_negative(
    corrections: list[tuple[float, float, float, float]], angle: float
) -> None:
    estimate = measured(corrections)
    assert estimate.variance(cos(angle), sin(angle)) > 0
    for i in range(4):
        for j in range(4):
            assert abs(estimate.spread[i][j] - estimate.spread[j][i]) < 1e-9
    assert estimate.state[2] ** 2 + estimate.state[3] ** 2 <= FASTEST_FOLLOWED**2 * (1 + 1e-9)


@given(MEASURED, ANGLES, st.floats(-1, 1), st.floats(0.01, 1))
def test_a_measurement_only_takes_doubt_away(
    corrections: list[tuple[float, float, float, float]],
    angle: float,
    error: float,
    sigma: float,
) -> None:
    estimate = measured(corrections)
    before = estimate.variance(cos(angle), sin(angle))
    estimate.correct(cos(angle), sin(angle), error, sigma)
    assert estimate.variance(cos(angle), sin(angle)) <= min(before, sigma**2) * (1 + 1e-9)


@given(REPORTS)
def test_whatever_is_heard_the_bounds_hold(
    reports: list[tuple[list[float], tuple[int, ...], float, float]],
) -> None:
    follow, pose = FollowTracking(), Pose2()
    for number, (ranges, fresh, way, turn) in enumerate(reports, 1):
        pose @= Pose2(way, 0.0, turn)
        place = seen(number / 10, pose=pose, sequence=number)
        sonar = Sonar(ranges=(*ranges, *[inf] * 8), fresh=fresh, enabled=True)
        desire = follow.decide(replace(place, snapshot=replace(place.snapshot, sonar=sonar)))
        v, w = value(desire, "v"), value(desire, "w")
        assert v is not None
        assert w is not None
        assert isfinite(v)
        assert -0.3 <= v <= 0.5
        assert abs(w) <= radians(60)
        if follow.target is None:
            assert (v, w) == (0.0, 0.0)


@given(RANGES)
def test_the_labs_rule_keeps_its_bounds_and_its_sides(ranges: list[float]) -> None:
    place = seen()
    sonar = Sonar(ranges=(*ranges, *[inf] * 8))
    snapshot = replace(place.snapshot, sonar=sonar)
    mirrored = replace(snapshot, sonar=Sonar(ranges=(*ranges[::-1], *[inf] * 8)))
    one = FollowLab().decide(replace(place, snapshot=snapshot))
    other = FollowLab().decide(replace(place, snapshot=mirrored))
    v, w = value(one, "v"), value(one, "w")
    assert v is not None
    assert w is not None
    assert -0.3 <= v <= 0.5
    assert abs(w) <= radians(45)
    assert v == value(other, "v")
    if len(set(ranges[1:7])) == 6:  # one is the nearest
        assert w == -(value(other, "w") or 0.0)


@given(st.floats(0, 10), st.floats(0.1, 3))
def test_a_robot_at_its_stopping_speed_stops_in_time(distance: float, deceleration: float) -> None:
    v = stopping_speed(distance, deceleration)
    assert v >= 0
    assert v * BRAKE_DELAY + v * v / (2 * PLANNED_SHARE * deceleration) <= distance + 1e-9
