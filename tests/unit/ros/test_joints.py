from math import pi

import pytest

from pioneer3.geometry import ORIGIN, Pose2, Twist2, arc
from pioneer3.models import load_model, shape_of
from pioneer3.ros.messages.motion import WheelAngles, joint_states
from tests.unit.ros.support import P3AT, Blank, seen, update

P3DX = load_model("p3dx-sh")


def after(angles: WheelAngles, *poses: Pose2) -> tuple[float, float]:
    """Return how far the wheels have turned when odometry has said this."""
    for pose in poses:
        turned = angles.update(seen(pose).odometry, P3DX)
    return turned


def test_wheels_turn_once_for_their_circumference() -> None:
    way = 2 * pi * shape_of(P3DX).wheel_radius
    for heading in (0.0, 2.0, -pi / 2):
        start = Pose2(3.0, -1.0, heading)
        assert after(WheelAngles(), start, start @ Pose2(way)) == pytest.approx((2 * pi, 2 * pi))
        assert after(WheelAngles(), start, start @ Pose2(-way)) == pytest.approx((-2 * pi, -2 * pi))


def test_turning_on_the_spot_turns_them_against_each_other() -> None:
    left, right = after(WheelAngles(), ORIGIN, Pose2(theta=0.5))
    assert right == pytest.approx(0.25 * P3DX.wheel_base / shape_of(P3DX).wheel_radius)
    assert left == pytest.approx(-right)


@pytest.mark.parametrize(("v", "w"), [(0.4, 1.0), (-0.4, 1.0), (0.4, -2.5)])
def test_along_an_arc_each_wheel_rolls_its_own_way(v: float, w: float) -> None:
    radius, half = shape_of(P3DX).wheel_radius, P3DX.wheel_base / 2
    poses = [arc(v, w, step * 0.1) for step in range(60)]
    seconds = 5.9
    assert after(WheelAngles(), *poses) == pytest.approx(
        ((v - w * half) * seconds / radius, (v + w * half) * seconds / radius)
    )


def test_a_heading_that_wraps_is_no_turn() -> None:
    left, right = after(WheelAngles(), Pose2(theta=pi - 0.01), Pose2(theta=-pi + 0.01))
    assert abs(left) == pytest.approx(0.01 * P3DX.wheel_base / shape_of(P3DX).wheel_radius)
    assert right > 0


def test_odometry_that_is_set_turns_no_wheel() -> None:
    angles = WheelAngles()
    before = after(angles, ORIGIN, Pose2(1.0))
    angles.jumped()
    assert after(angles, ORIGIN) == before


def test_every_driven_wheel_has_an_angle_and_a_speed() -> None:
    message = Blank()
    now = seen(twist=Twist2(0.1, 0.0), left=0.111, right=0.222)
    joint_states(message, update(now, turned=(1.0, 2.0)))
    assert message.name == [
        "front_left_wheel_joint",
        "front_right_wheel_joint",
        "rear_left_wheel_joint",
        "rear_right_wheel_joint",
    ]
    assert message.position == [1.0, 2.0, 1.0, 2.0]
    assert message.velocity == pytest.approx([1.0, 2.0, 1.0, 2.0])
    assert shape_of(P3AT).wheel_radius == 0.111
