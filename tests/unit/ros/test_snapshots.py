"""Readings from messages: what `convert` makes of a snapshot comes back."""

from math import inf, isnan, nan, pi
from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pioneer3.geometry import Pose2, Twist2
from pioneer3.models import load_model
from pioneer3.ros.client.snapshots import RING, SnapshotBuilder
from pioneer3.ros.messages import motion, sensors
from pioneer3.state import Bumpers, Motors, Snapshot, Sonar
from tests.unit.ros.support import Blank, seen, update

MODEL = load_model("p3at-sh")
METRES = st.floats(-100, 100)
RANGES = st.lists(st.floats(0.1, 4.99) | st.just(inf), min_size=16, max_size=16)


def gathered(snapshot: Snapshot) -> Snapshot:
    """Return what arrives at the other end."""
    builder = SnapshotBuilder(MODEL)
    pose, cloud, bumpers, motors = Blank(), Blank(), Blank(), Blank()
    told = update(snapshot)
    motion.odometry(pose, told)
    sensors.sonar_cloud(cloud, told)
    sensors.bumpers(bumpers, told)
    sensors.motors(motors, told)
    pose.pose.pose.position.z = 0.0
    builder.pose(pose)
    builder.sonar_cloud(cloud, 1.0)
    builder.bumpers(bumpers)
    builder.motors(motors)
    arrived = builder.snapshot(1.0)
    assert arrived is not None
    return arrived


@given(
    st.builds(Pose2, METRES, METRES, st.floats(-3.14, pi)),
    st.builds(Twist2, st.floats(-1, 1), st.floats(-2, 2)),
    RANGES,
)
def test_pose_speeds_and_ranges_arrive(pose: Pose2, twist: Twist2, ranges: list[float]) -> None:
    arrived = gathered(seen(pose, twist, sonar=Sonar(ranges=tuple(ranges))))
    there = arrived.odometry.robot_in_odom
    assert (there.x, there.y, there.theta) == pytest.approx((pose.x, pose.y, pose.theta))
    assert arrived.odometry.twist == twist
    assert arrived.sonar.ranges == pytest.approx(ranges)
    assert arrived.sonar.enabled


def test_bumpers_and_motors_arrive() -> None:
    pressed = Bumpers(front=(True, False, False), rear=(False, False, True))
    arrived = gathered(seen(bumpers=pressed, motors=Motors(enabled=True)))
    assert arrived.bumpers == pressed
    assert arrived.motors.enabled
    assert not gathered(seen()).motors.enabled


def cloud(*metres: float) -> Any:
    """Return the points at which transducers 0, 1, ... hear something."""
    points = sensors.sonar_points(Sonar(ranges=metres), MODEL)[: len(metres)]
    return SimpleNamespace(points=[SimpleNamespace(x=x, y=y) for x, y in points])


def fresh(builder: SnapshotBuilder, now: float) -> tuple[int, ...]:
    """Return which transducers were read anew."""
    snapshot = builder.snapshot(now)
    assert snapshot is not None
    return snapshot.sonar.fresh


def test_a_distance_is_new_when_it_changes_or_a_ring_has_gone_round() -> None:
    builder = SnapshotBuilder(MODEL)
    builder.pose(standing())
    builder.sonar_cloud(cloud(1.0, 2.0), 0.0)
    assert fresh(builder, 0.0) == (0, 1)
    builder.sonar_cloud(cloud(1.0, 2.1), 0.1)
    assert fresh(builder, 0.1) == (1,)
    builder.sonar_cloud(cloud(1.0, 2.1), 0.2)
    assert fresh(builder, 0.2) == ()
    builder.sonar_cloud(cloud(1.0, 2.1), RING)
    assert fresh(builder, RING) == (0,)


def test_a_robot_with_more_sonars_than_the_model_does_no_harm() -> None:
    builder = SnapshotBuilder(MODEL)
    builder.pose(standing())
    builder.sonar_range(99, 1.0, 0.0)
    assert fresh(builder, 0.0) == ()


def test_before_the_first_pose_there_is_nothing() -> None:
    assert SnapshotBuilder(MODEL).snapshot(0.0) is None


def test_a_pose_without_numbers_is_left_out() -> None:
    builder = SnapshotBuilder(MODEL)
    builder.pose(standing(x=nan))
    assert builder.snapshot(0.0) is None
    builder.pose(standing(x=1.0))
    builder.pose(standing(x=inf))
    snapshot = builder.snapshot(0.0)
    assert snapshot is not None
    assert snapshot.odometry.robot_in_odom.x == 1.0


def test_the_voltage_is_what_somebody_told() -> None:
    builder = SnapshotBuilder(MODEL)
    builder.pose(standing())
    before = builder.snapshot(0.0)
    builder.voltage(12.3)
    after = builder.snapshot(0.1)
    assert before is not None
    assert after is not None
    assert isnan(before.battery.voltage)
    assert after.battery.voltage == 12.3


def standing(x: float = 0.0) -> Any:
    """Return a nav_msgs/Odometry of a robot that stands."""
    message = Blank()
    motion.odometry(message, update(seen(Pose2(x))))
    return message
