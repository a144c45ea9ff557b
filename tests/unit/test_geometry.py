"""Plane geometry, each number derived by hand."""

from math import cos, inf, nan, pi, sin

import pytest

from pioneer3.geometry import ORIGIN, Pose2, Twist2, arc, wrap


@pytest.mark.parametrize(
    ("angle", "wrapped"),
    [(0, 0), (pi, pi), (-pi, pi), (3 * pi, pi), (2 * pi, 0), (1.5 * pi, -pi / 2), (-7, 2 * pi - 7)],
)
def test_angles_wrap_to_half_a_turn_either_way(angle: float, wrapped: float) -> None:
    assert wrap(angle) == pytest.approx(wrapped)


def test_composing_is_walking_in_the_frame_of_the_first() -> None:
    there = Pose2(1, 2, pi / 2) @ Pose2(3, 1, pi)
    assert (there.x, there.y) == pytest.approx((1 - 1, 2 + 3))
    assert there.theta == pytest.approx(-pi / 2)


def test_an_inverse_leads_back() -> None:
    pose = Pose2(1.5, -2.0, 2.5)
    for back in (pose @ pose.inverse(), pose.inverse() @ pose):
        assert (back.x, back.y, back.theta) == pytest.approx((0, 0, 0))


def test_a_straight_arc_is_a_line() -> None:
    assert arc(0.5, 0.0, 2.0) == Pose2(1.0, 0.0, 0.0)
    assert arc(0.0, 0.0, 2.0) == ORIGIN


@pytest.mark.parametrize("w", [0.5, -0.5, 1e-3, 1e-7, 3.0])
def test_an_arc_is_a_piece_of_a_circle(w: float) -> None:
    radius = 0.4 / w
    end = arc(0.4, w, 1.0)
    assert end.x == pytest.approx(radius * sin(w), rel=1e-9)
    assert end.y == pytest.approx(radius * (1 - cos(w)), rel=1e-6, abs=1e-9)
    assert end.theta == pytest.approx(w)


def test_a_twist_knows_whether_it_is_one() -> None:
    assert Twist2(1.0, 2.0).is_finite
    assert not any(t.is_finite for t in (Twist2(nan, 0), Twist2(0, inf), Twist2(-inf, nan)))
    assert Twist2().is_zero
    assert not Twist2(0.0, 1e-9).is_zero
