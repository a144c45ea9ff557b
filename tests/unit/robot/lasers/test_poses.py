"""The robot's pose at any time: between reports, after the last, over gaps and resets."""

from math import pi

import pytest

from pioneer3.geometry import ORIGIN, Pose2, Twist2, arc
from pioneer3.robot.poses import AHEAD, KEPT, Poses
from pioneer3.state import Battery, Motors, Odometry, Snapshot


def snapshot(stamp: float, pose: Pose2, twist: Twist2 | None = None) -> Snapshot:
    """Return a snapshot of a robot at `pose`."""
    return Snapshot(
        stamp=stamp,
        sequence=1,
        odometry=Odometry(
            robot_in_odom=pose, twist=twist or Twist2(), left_speed=0.0, right_speed=0.0
        ),
        battery=Battery(voltage=12.0),
        motors=Motors(),
    )


def seen(*reports: Snapshot) -> Poses:
    """Return the poses of a robot that has sent these reports."""
    poses = Poses()
    for report in reports:
        poses.add(report)
    return poses


def near(pose: Pose2, other: Pose2, within: float = 1e-9) -> bool:
    return (pose.x, pose.y, pose.theta) == pytest.approx(
        (other.x, other.y, other.theta), abs=within
    )


def test_without_a_report_it_is_the_origin() -> None:
    assert Poses().at(5.0) == ORIGIN


def test_between_two_reports_it_goes_evenly() -> None:
    poses = seen(snapshot(1.0, Pose2(0.0, 0.0, 0.0)), snapshot(1.1, Pose2(0.1, 0.2, 0.4)))
    assert near(poses.at(1.025), Pose2(0.025, 0.05, 0.1))
    assert near(poses.at(1.0), Pose2())
    assert near(poses.at(1.1), Pose2(0.1, 0.2, 0.4))


def test_headings_take_the_short_way_over_the_half_turn() -> None:
    poses = seen(snapshot(1.0, Pose2(0, 0, pi - 0.1)), snapshot(1.1, Pose2(0, 0, -pi + 0.1)))
    assert abs(poses.at(1.05).theta) == pytest.approx(pi)
    assert near(poses.at(1.025), Pose2(0, 0, pi - 0.05))
    assert near(poses.at(1.075), Pose2(0, 0, -pi + 0.05))


def test_reports_of_a_robot_on_an_arc_give_that_arc() -> None:
    reports = [snapshot(n / 10, arc(0.4, 1.0, n / 10), Twist2(0.4, 1.0)) for n in range(11)]
    poses = seen(*reports)
    for time in (0.05, 0.333, 0.97, 1.0):
        assert near(poses.at(time), arc(0.4, 1.0, time), within=2e-3)
    for time in (1.1, 1.25):
        assert near(poses.at(time), arc(0.4, 1.0, time))


def test_after_the_last_report_it_goes_on_only_for_a_while() -> None:
    poses = seen(snapshot(1.0, Pose2(1.0, 2.0, pi / 2), Twist2(0.5, 0.0)))
    assert near(poses.at(1.2), Pose2(1.0, 2.1, pi / 2))
    assert near(poses.at(1.0 + AHEAD), poses.at(60.0))


def test_before_the_first_report_it_is_the_pose_of_that() -> None:
    assert seen(snapshot(9.0, Pose2(1.0, 2.0, 3.0))).at(3.0) == Pose2(1.0, 2.0, 3.0)


def test_old_reports_are_forgotten() -> None:
    poses = seen(*(snapshot(n / 10, Pose2(n / 10)) for n in range(200)))
    assert near(poses.at(0.0), Pose2(19.9 - KEPT), within=0.11)
    assert near(poses.at(19.9 - KEPT + 0.2), Pose2(19.9 - KEPT + 0.2))


def test_two_reports_at_the_same_time_count_as_the_later() -> None:
    poses = seen(snapshot(1.0, Pose2(0.0)), snapshot(1.1, Pose2(0.1)), snapshot(1.1, Pose2(0.3)))
    assert near(poses.at(1.05), Pose2(0.15))
    assert near(poses.at(1.1), Pose2(0.3))


def test_a_gap_in_the_reports_is_crossed_evenly() -> None:
    poses = seen(
        snapshot(1.0, Pose2(1.0), Twist2(0.5)), snapshot(3.0, Pose2(2.0)), snapshot(3.1, Pose2(2.0))
    )
    assert near(poses.at(2.0), Pose2(1.5))
    assert near(poses.at(3.05), Pose2(2.0))
    assert near(poses.at(3.2), Pose2(2.0))
