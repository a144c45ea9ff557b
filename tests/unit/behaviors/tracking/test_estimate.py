"""The filter against what can be worked out by hand."""

from math import hypot, sqrt

import pytest

from pioneer3.behaviors.kalman import FASTEST_FOLLOWED, UNSURE_SPEED, WANDERS, KalmanFilter


def test_expected_is_where_the_velocity_leads() -> None:
    estimate = KalmanFilter(1.0, 2.0, stamp=10.0, sigma=0.1)
    estimate.state[2:] = [0.4, -0.2]
    assert estimate.at(10.5) == pytest.approx((1.2, 1.9))
    estimate.advance(10.5)
    assert estimate.position == pytest.approx((1.2, 1.9))


def test_doubt_grows_with_time() -> None:
    estimate = KalmanFilter(0.0, 0.0, stamp=0.0, sigma=0.1)
    estimate.advance(2.0)
    # p + t^2 v + q t^3 / 3 with t = 2
    expected = 0.1**2 + 4 * UNSURE_SPEED**2 + WANDERS**2 * 8 / 3
    assert estimate.variance(1, 0) == pytest.approx(expected)
    assert estimate.variance(0.6, 0.8) == pytest.approx(expected)


def test_time_in_pieces_is_the_same_time() -> None:
    whole, pieces = (KalmanFilter(0.0, 0.0, stamp=0.0, sigma=0.1) for _ in range(2))
    whole.advance(1.0)
    for tenth in range(1, 11):
        pieces.advance(tenth / 10)
    for row, other in zip(whole.spread, pieces.spread, strict=True):
        assert row == pytest.approx(other)


def test_time_does_not_run_backwards() -> None:
    estimate = KalmanFilter(0.0, 0.0, stamp=5.0, sigma=0.1)
    estimate.state[2] = 1.0
    estimate.advance(4.0)
    assert estimate.position == (0.0, 0.0)
    assert estimate.stamp == 5.0


def test_two_equal_doubts_meet_in_the_middle() -> None:
    estimate = KalmanFilter(0.0, 0.0, stamp=0.0, sigma=0.1)
    estimate.correct(1.0, 0.0, error=0.3, sigma=0.1)
    # gain 0.01 / (0.01 + 0.01); the variance halves, across nothing happens
    assert estimate.position == pytest.approx((0.15, 0.0))
    assert sqrt(estimate.variance(1, 0)) == pytest.approx(0.1 / sqrt(2))
    assert estimate.variance(0, 1) == pytest.approx(0.01)


def test_who_is_farther_on_each_time_is_walking() -> None:
    estimate = KalmanFilter(1.0, 0.0, stamp=0.0, sigma=0.1)
    for tick in range(1, 31):
        stamp = tick / 10
        estimate.advance(stamp)
        estimate.correct(1.0, 0.0, 1.0 + 0.4 * stamp - estimate.position[0], 0.04)
    assert estimate.velocity == pytest.approx((0.4, 0.0), abs=0.02)
    assert estimate.position == pytest.approx((2.2, 0.0), abs=0.01)


def test_nobody_is_believed_to_run() -> None:
    estimate = KalmanFilter(0.0, 0.0, stamp=0.0, sigma=0.1)
    estimate.advance(0.5)
    estimate.correct(0.6, 0.8, error=5.0, sigma=0.01)
    assert hypot(*estimate.velocity) == pytest.approx(FASTEST_FOLLOWED)
