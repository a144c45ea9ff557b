"""Odometry that is corrected: what is told to the controller, and what is made of its reports."""

from dataclasses import replace
from math import pi

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pioneer3.arcos.reports import Sip
from pioneer3.geometry import ORIGIN, STILL, Pose2, Twist2, arc, wrap
from pioneer3.limits import Limits
from pioneer3.models import OdometryCorrection, load_model
from pioneer3.models.odometry import UNCORRECTED, TwistMatrix
from pioneer3.robot.assemble import Odometer
from pioneer3.robot.correction import TwistCorrection
from pioneer3.units import DEGREE, HEADING_UNITS, MM

MODEL = load_model("p3dx-sh")
RATIO = st.floats(0.8, 1.25)
CORRECTIONS = st.builds(OdometryCorrection, RATIO, RATIO, RATIO).filter(
    lambda errors: errors != UNCORRECTED
)
SPEED, RATE = st.floats(-0.5, 0.5), st.floats(-1.0, 1.0)
MOTIONS = st.lists(st.tuples(SPEED, RATE), min_size=1, max_size=40)
LIMITS = Limits(max_speed=0.6, max_turn_rate=1.2)


def matrix_of(errors: OdometryCorrection) -> TwistMatrix:
    matrix = errors.matrix(MODEL.wheel_base)
    assert matrix is not None
    return matrix


@given(CORRECTIONS, SPEED, RATE)
def test_the_inverse_leads_back(errors: OdometryCorrection, v: float, w: float) -> None:
    matrix = matrix_of(errors)
    back = matrix.inverse().of(matrix.of(Twist2(v, w)))
    assert (back.v, back.w) == pytest.approx((v, w), abs=1e-9)


@given(CORRECTIONS, MOTIONS)
def test_the_pose_is_the_true_one_but_for_rounded_counters(
    errors: OdometryCorrection, motions: list[tuple[float, float]]
) -> None:
    model, matrix, odometer = replace(MODEL, odometry=errors), matrix_of(errors), Odometer()
    counted = truth = ORIGIN
    odometer.update(Sip(), model)
    for v, w in motions:
        counted @= arc(v, w, 0.1)
        moved = matrix.of(Twist2(v, w))
        truth @= arc(moved.v, moved.w, 0.1)
        x_raw, y_raw = round(counted.x / MM) % 32768, round(counted.y / MM) % 32768
        heading_raw = round(counted.theta / (2 * pi) * HEADING_UNITS)
        odometer.update(Sip(x_raw=x_raw, y_raw=y_raw, heading_raw=heading_raw), model)
    found = odometer.robot_in_odom
    assert (found.x, found.y) == pytest.approx((truth.x, truth.y), abs=0.012)
    assert abs(wrap(found.theta - truth.theta)) < 0.02


@given(st.floats(-2, 2), st.floats(-0.1, 0.1), st.floats(-3, 3))
def test_a_step_that_nothing_corrects_stays(x: float, y: float, theta: float) -> None:
    step = TwistMatrix(1.0, 0.0, 0.0, 1.0).of_step(Pose2(x, y, theta))
    assert (step.x, step.y, step.theta) == pytest.approx((x, y, theta), abs=1e-9)


@given(CORRECTIONS, st.lists(st.tuples(SPEED, RATE, st.floats(0.05, 0.3)), max_size=30))
def test_no_frame_is_beyond_the_limits_or_goes_where_nobody_asked(
    errors: OdometryCorrection, frames: list[tuple[float, float, float]]
) -> None:
    correction, now = TwistCorrection(matrix_of(errors), LIMITS), 0.0
    for v, w, pause in frames:
        told = correction.told(Twist2(v, w), now)
        assert abs(told.v) <= LIMITS.max_speed
        assert abs(told.w) <= LIMITS.max_turn_rate
        assert told.v * v >= 0
        assert told.v == 0 or v != 0
        now += pause
    assert correction.told(STILL, now) == STILL


@given(CORRECTIONS, st.floats(0.1, 0.4), st.floats(-0.5, 0.5), st.sampled_from([0.05, 0.1, 0.2]))
def test_over_time_the_robot_turns_as_much_as_asked(
    errors: OdometryCorrection, v: float, w: float, pause: float
) -> None:
    matrix = matrix_of(errors)
    correction, turned, pauses = TwistCorrection(matrix, LIMITS), 0.0, round(20 / pause)
    wanted = matrix.inverse().of(Twist2(v, w))
    if abs(wanted.v) > LIMITS.max_speed or abs(wanted.w) > LIMITS.max_turn_rate - DEGREE:
        return
    for step in range(pauses):
        told = correction.told(Twist2(v, w), step * pause)
        assert told.w / DEGREE == pytest.approx(round(told.w / DEGREE))
        turned += told.w * pause
    assert turned == pytest.approx(wanted.w * 20, abs=0.5 * DEGREE)
