"""`pioneer3 ros2 check` as a process of its own, on real networks of both kinds."""

import asyncio
import json
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from math import nan
from typing import Any

import pytest

from pioneer3.ros.ros2.backend import Qos
from pioneer3.tasks import running as together
from tests.e2e.processes import p3
from tests.ros2.conftest import robot_on
from tests.ros2.networks import Peer, Ros2

pytestmark = [pytest.mark.realtime]
NANO = 1_000_000_000


@dataclass
class Outcome:
    """The outcome of a check: its exit code, and its rows by the name of a topic or service."""

    code: int
    rows: dict[str, Any]
    said: str

    def reasons(self, name: str) -> list[str]:
        """Return the reasons of the faults of a row."""
        return [fault["reason"] for fault in self.rows[name]["faults"]]


async def checked(network: Ros2, *arguments: str) -> Outcome:
    """Run the command to its end."""
    words = ("ros2", "check", "--json", "--seconds", "2", *network.options, *arguments)
    done = await asyncio.to_thread(p3, *words)
    rows = json.loads(done.stdout)["rows"] if done.stdout else []
    return Outcome(done.returncode, {row["name"]: row for row in rows}, done.stderr)


@asynccontextmanager
async def faulty(peer: Peer) -> AsyncIterator[None]:
    """Let a node send odometry without numbers and with the stamp of an hour ago, and so on."""
    odometry = peer.publisher("/odom", "nav_msgs/Odometry")
    sonar = peer.publisher("/sonar/range_0", "sensor_msgs/Range")
    motors = peer.publisher("/motors_state", "std_msgs/Bool")
    peer.publisher("/battery_state", "std_msgs/Float64")
    peer.publisher("/joint_states", "sensor_msgs/JointState", Qos(reliable=False))
    peer.hear("/cmd_vel", "geometry_msgs/Twist")

    async def send() -> None:
        while True:
            message = peer.types.make("nav_msgs/Odometry")
            message.header.frame_id, message.child_frame_id = "odom", "base_link"
            message.pose.pose.position.x = nan
            message.header.stamp.sec = time.time_ns() // NANO - 3600
            odometry.write(peer.types.encode(message))
            near = peer.types.make("sensor_msgs/Range")
            near.header.frame_id, near.range = "sonar_0", nan
            sonar.write(peer.types.encode(near))
            motors.write(peer.types.encode(peer.types.make("std_msgs/Bool")))
            await asyncio.sleep(0.1)

    async with together(send()):
        yield


async def test_our_node_passes(ros2: Ros2) -> None:
    async with robot_on(ros2, "--namespace", "robot1"):
        found = await checked(ros2, "--robot", "robot1", "--model", "p3at-sh")
    wrong = [row for row in found.rows.values() if row["verdict"] == "fail"]
    assert wrong == []
    assert found.code == 0
    assert found.rows["/robot1/odom"]["verdict"] == "ok"
    assert found.rows["/robot1/sonar/range_15"]["verdict"] == "ok"
    assert found.rows["/robot1/robot_description"]["found"].startswith("1 message")
    assert found.rows["/robot1/e_stop_trigger"]["verdict"] == "ok"


async def test_a_publisher_of_commands_of_another_type_is_named(ros2: Ros2) -> None:
    async with robot_on(ros2), ros2.peer("joystick") as peer:
        peer.publisher("/cmd_vel", "geometry_msgs/TwistStamped")
        found = await checked(ros2)
    assert found.code == 1
    (reason,) = found.reasons("/cmd_vel")
    assert reason.startswith("publisher /joystick sends geometry_msgs/msg/TwistStamped")


async def test_the_faults_of_a_foreign_node_are_named(ros2: Ros2) -> None:
    async with ros2.peer("base") as peer, faulty(peer):
        found = await checked(ros2)
    assert found.code == 1
    odometry = found.reasons("/odom")
    assert "pose.pose.position.x is NaN" in odometry
    assert "pose.pose.orientation is no unit quaternion" in odometry
    assert "stamps are old" in odometry
    assert "stamps repeat" in odometry
    assert "range is NaN" in found.reasons("/sonar/range_0")
    assert found.reasons("/motors_state") == ["durability: volatile, not transient local"]
    assert found.reasons("/battery_state") == [
        "the type is std_msgs/msg/Float64, not sensor_msgs/msg/BatteryState"
    ]
    assert "reliability: best effort, not reliable" in found.reasons("/joint_states")
    assert found.reasons("/tf") == ["nobody publishes it"]
    assert found.reasons("/e_stop_trigger") == ["nobody offers it"]


async def test_several_robots_are_listed_and_none_is_told_so(ros2: Ros2) -> None:
    nobody = await checked(ros2)
    assert nobody.code == 3
    assert "no robot is on" in nobody.said
    async with ros2.peer("one") as one, ros2.peer("two") as two, faulty(one), faulty(two):
        both = await checked(ros2)
        assert both.code == 2
        assert "say which with --robot; /one, /two" in both.said
        named = await checked(ros2, "--robot", "one")
    assert named.code == 1
    assert "it has 2 publishers: /one and /two" in named.reasons("/odom")
