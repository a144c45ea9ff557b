"""The topics and services that today's ROS packages expect, seen by ROS's own tools."""

import asyncio
import json
import re
from collections.abc import Iterator, Mapping
from math import cos, hypot, sin
from pathlib import Path
from typing import Any

import pytest

from pioneer3.models import load_model
from tests.ros1.master import ended, ros, script
from tests.ros1.office import shared_office

pytestmark = pytest.mark.realtime

P3AT = load_model("p3at-sh")
ODOMETRY = "cd5e73d190d741a2f92e81eda573aca7"
RANGE = "c005c34273dc426c67a020a87bc24148"
CLOUD = "1158d486dd51d683ce2f1be655c3c181"
TREE = "94810edda583a504dfda3829e70d7eec"
BOOL = "8b94c1b53db61fb6aed406028ad6332a"
RANGES = {
    f"/sonar/range_{number}": ("sensor_msgs/Range", RANGE, "0", f"sonar_{number}")
    for number in range(16)
}
TOPICS: Mapping[str, tuple[str, str, str, str | None]] = {
    "/odom": ("nav_msgs/Odometry", ODOMETRY, "0", "odom"),
    "/joint_states": ("sensor_msgs/JointState", "3066dcd76a6cfaef579bd0f34173e9fd", "0", ""),
    "/sonar/points": ("sensor_msgs/PointCloud2", CLOUD, "0", "base_link"),
    "/bumpers/points": ("sensor_msgs/PointCloud2", CLOUD, "0", "base_link"),
    "/bumper_state": ("rosaria/BumperState", "f81947761ff7e166a3bbaf937b9869b5", "0", "base_link"),
    "/battery_state": (
        "sensor_msgs/BatteryState",
        "4ddae7f048e32fda22cac764685e3974",
        "0",
        "base_link",
    ),
    "/motors_state": ("std_msgs/Bool", BOOL, "1", None),
    "/emergency_stop": ("std_msgs/Bool", BOOL, "1", None),
    "/imu/data_raw": ("sensor_msgs/Imu", "6a62c6daae103f4ff57a132d6f95cec2", "0", "imu_link"),
    "/scan": ("sensor_msgs/LaserScan", "90c7ef2dc6895d81024acba2ac42f369", "0", "laser"),
    "/diagnostics": (
        "diagnostic_msgs/DiagnosticArray",
        "60810da900de1dd6ddd437c3503511da",
        "0",
        "",
    ),
    "/dio": ("std_msgs/UInt16", "1df79edf208b629fe6b81923a544552d", "0", None),
    "/aio": ("std_msgs/Float32MultiArray", "6a40e0ffa6a17a503ac3f8616991b1f6", "0", None),
    **RANGES,
}
"""Type, md5sum, latching and frame; facts.md 14.6."""
SLOW = {"/battery_state", "/diagnostics"}
"""Once a second."""
ON_CHANGE = {"/motors_state"}
SERVICES = {
    "/enable_motors": "std_srvs/Empty",
    "/disable_motors": "std_srvs/Empty",
    "/e_stop_trigger": "std_srvs/Trigger",
    "/e_stop_reset": "std_srvs/Trigger",
    "/reset_odometry": "std_srvs/Trigger",
    "/self_test": "std_srvs/Trigger",
    "/sonar/enable": "std_srvs/SetBool",
}
X = ("rostopic", "echo", "-n", "1", "/odom/pose/pose/position/x")
"""Where the robot says it is."""
JOINTS = ("rostopic", "echo", "-n", "1", "/joint_states/position")
DRIVE = ("rostopic", "pub", "-r", "10", "/cmd_vel", "geometry_msgs/Twist")


@pytest.fixture(scope="module")
def shared(master: dict[str, str]) -> Iterator[None]:
    """Run one robot and its node, with the standard names, for the tests that leave both well."""
    with shared_office(master, "_profile:=standard"):
        yield


@pytest.fixture
def standard(ros1: None, shared: None) -> None:
    """Let programs find that node."""


async def test_every_topic_has_its_type_frame_latch_and_rate(standard: None) -> None:
    heard = await script("survey.py", "5.5", *TOPICS)
    own = re.findall(r" \* (/RosAria\S*) \[", await ros("rosnode", "info", "/RosAria"))
    found = {
        name: (row["type"], row["md5sum"], row["latching"], next(iter(row["frames"]), None))
        for name, row in heard.items()
    }
    assert found == dict(TOPICS)
    assert set(own) == {"/RosAria/parameter_descriptions", "/RosAria/parameter_updates"}
    for name, row in heard.items():
        assert row["ordered"], name
        assert len(row["frames"]) <= 1, name
        assert row["age"] < 2.0, name
        if name in ON_CHANGE:
            assert row["count"] == 1
            continue
        rate = (row["count"] - 1) / (row["last"] - row["first"])
        usual, more = (1.0, 0.6) if name in SLOW else (10.0, 0.15)  # and when a level changes
        assert 0.85 * usual < rate < (1 + more) * usual, name


async def test_a_turning_robot_turns_its_wheels_in_joints_and_tree(standard: None) -> None:
    await ended(*DRIVE, "{angular: {z: 0.5}}", patience=2.5)
    said = await standing()
    tree = await script("look_up.py", "1.5", "base_link", "front_left_wheel")
    left, right, rear_left, rear_right = said
    assert left == rear_left < -0.2
    assert right == rear_right > 0.2
    _, _, _, qx, qy, qz, qw = tree["at"]["front_left_wheel"]
    assert hypot(qx, qz) == pytest.approx(0.0, abs=1e-9)
    assert abs(qy) == pytest.approx(abs(sin(left / 2)), abs=0.1)
    assert abs(qw) == pytest.approx(abs(cos(left / 2)), abs=0.1)


async def standing() -> list[float]:
    """Wait until the robot stands; return the angles of its wheels [rad]."""
    before: list[float] = []
    while (now := json.loads((await ros(*JOINTS)).split("\n")[0])) != before:
        before = now
    return before


async def test_a_recording_plays_as_it_was(standard: None, tmp_path: Path) -> None:
    bag = tmp_path / "standard.bag"
    topics = ("/odom", "/tf", "/tf_static", "/sonar/range_0", "/scan", "/joint_states")
    await ended("rosbag", "record", "-O", str(bag), *topics, patience=4.0)
    again = tuple(f"/again{topic}" for topic in topics)
    survey = asyncio.create_task(script("survey.py", "6.0", *again))
    renamed = [f"{topic}:=/again{topic}" for topic in topics]
    await ended("rosbag", "play", "-q", "-d", "2", str(bag), *renamed, patience=8.0)
    heard: dict[str, Any] = await survey
    assert set(heard) == set(again)
    assert heard["/again/sonar/range_0"]["frames"] == ["sonar_0"]
    assert heard["/again/tf_static"]["latching"] == "1"


async def test_every_service_has_its_type(standard: None) -> None:
    found: dict[str, str] = await script("services.py")
    own = {name: kind for name, kind in found.items() if not name.startswith("/RosAria")}
    assert own == SERVICES


async def test_the_emergency_stop_latches_until_it_is_reset(standard: None) -> None:
    assert "False" in await ros("rostopic", "echo", "-n", "1", "/emergency_stop")
    assert "success: True" in await ros("rosservice", "call", "/e_stop_trigger")
    assert "True" in await ros("rostopic", "echo", "-n", "2", "/emergency_stop")
    await ended(*DRIVE, "{linear: {x: 0.2}}", patience=2.0)
    assert float((await ros(*X)).split()[0]) == 0.0
    said = await ros("rosservice", "call", "/self_test")
    assert "success: False" in said
    assert "the emergency stop is latched" in said
    assert "success: True" in await ros("rosservice", "call", "/e_stop_reset")
    assert "False" in await ros("rostopic", "echo", "-n", "1", "/motors_state")
    await ended(*DRIVE, "{linear: {x: 0.2}}", patience=3.0)
    assert float((await ros(*X)).split()[0]) > 0.05
    await ros("rosservice", "call", "/reset_odometry")
    assert float((await ros(*X)).split()[0]) == pytest.approx(0.0, abs=0.02)


async def test_sonars_that_are_switched_off_say_nothing(standard: None) -> None:
    assert "success: True" in await ros("rosservice", "call", "/sonar/enable", "false")
    assert await script("survey.py", "1.5", *RANGES, "/sonar/points") == {}
    assert "success: True" in await ros("rosservice", "call", "/sonar/enable", "true")
    assert set(await script("survey.py", "2.0", *RANGES)) == set(RANGES)
