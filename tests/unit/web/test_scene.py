"""Where the robot is drawn."""

from math import pi

import pytest

from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.web.scene import RobotScene


def test_without_a_map_the_robot_is_drawn_where_its_wheels_say() -> None:
    assert RobotScene().robot_in_map(Pose2(1.0, 2.0, 0.5)) == Pose2(1.0, 2.0, 0.5)


def test_the_odometry_starts_where_the_scene_says() -> None:
    drawn = RobotScene(odom_in_map=Pose2(3.0, 4.0, pi / 2)).robot_in_map(Pose2(1.0, 0.0, 0.0))
    assert (drawn.x, drawn.y, drawn.theta) == pytest.approx((3.0, 5.0, pi / 2))


def test_the_truth_is_preferred_where_it_is_known() -> None:
    scene = RobotScene(odom_in_map=Pose2(9.0, 9.0, 0.0), truth=lambda: Pose2(1.0, 1.0, 1.0))
    assert scene.robot_in_map(ORIGIN) == Pose2(1.0, 1.0, 1.0)
