"""Snapshots of a robot's topics and keys of a phone, over a middleware without ROS."""

import asyncio
from types import SimpleNamespace

import pytest

from pioneer3.models import load_model
from pioneer3.ros.client.graph import RobotTopics
from pioneer3.ros.client.phone import SILENT, flicks
from pioneer3.ros.client.snapshots import TOGETHER, SnapshotSubscriber
from pioneer3.state import Snapshot
from pioneer3.teleop.keyboard import Key
from tests.unit.ros.fakes import SOMEBODY, FakeMiddleware
from tests.unit.ros.support import Blank

TOPICS = RobotTopics(
    node="/RosAria",
    pose="/RosAria/pose",
    commands="/RosAria/cmd_vel",
    published={
        "/RosAria/pose": "nav_msgs/Odometry",
        "/RosAria/motors_state": "std_msgs/Bool",
        "/RosAria/battery_voltage": "std_msgs/Float64",
        "/sonar/range_3": "sensor_msgs/Range",
    },
)


def a_pose(x: float) -> Blank:
    """Return a nav_msgs/Odometry."""
    message = Blank()
    message.pose.pose.position.x, message.pose.pose.position.y = x, 0.0
    message.pose.pose.orientation.z, message.pose.pose.orientation.w = 0.0, 1.0
    message.twist.twist.linear.x = message.twist.twist.angular.z = 0.0
    return message


async def test_messages_that_come_together_make_one_snapshot() -> None:
    middleware, taken = FakeMiddleware(), list[Snapshot]()
    subscriber = SnapshotSubscriber(TOPICS, load_model("p3at-sh"), taken.append, middleware)
    subscriber.open()
    receive = middleware.receivers
    receive["/RosAria/pose"](a_pose(1.0), SOMEBODY)
    receive["/RosAria/motors_state"](SimpleNamespace(data=True), SOMEBODY)
    receive["/RosAria/battery_voltage"](SimpleNamespace(data=12.4), SOMEBODY)
    receive["/sonar/range_3"](SimpleNamespace(range=1.5, max_range=5.0), SOMEBODY)
    await asyncio.sleep(2 * TOGETHER)
    (snapshot,) = taken
    assert snapshot.odometry.robot_in_odom.x == 1.0
    assert snapshot.motors.enabled
    assert snapshot.battery.voltage == 12.4
    assert (snapshot.sonar.fresh, snapshot.sonar.ranges[3]) == ((3,), 1.5)
    receive["/RosAria/pose"](a_pose(2.0), SOMEBODY)
    subscriber.close()
    await asyncio.sleep(2 * TOGETHER)
    assert len(taken) == 1


async def test_a_phone_that_falls_silent_stops_the_robot(monkeypatch: pytest.MonkeyPatch) -> None:
    middleware = FakeMiddleware()
    monkeypatch.setattr(asyncio, "to_thread", middleware.at_once)
    keys = flicks("/imu", middleware)
    loop = asyncio.get_running_loop()

    def flick(x: float) -> None:
        turns = SimpleNamespace(x=x, y=0.0, z=0.0)
        middleware.receivers["/imu"](SimpleNamespace(angular_velocity=turns), SOMEBODY)

    loop.call_later(1.0, flick, 5.0)
    first = await anext(keys)
    assert first is not Key.STOP
    began = loop.time()
    assert await anext(keys) is Key.STOP
    assert loop.time() - began == pytest.approx(SILENT)
    await keys.aclose()  # type: ignore[attr-defined]
