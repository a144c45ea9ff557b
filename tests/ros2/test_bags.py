"""A bag that a log was converted to, as the codec of a real ROS 2 reads it."""

import json
import os
import subprocess
from math import isnan
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader

from pioneer3.log.reader import open_log
from pioneer3.ros.bag.convert import BagKind, write_bag
from pioneer3.ros.node.names import Profile
from pioneer3.state import Snapshot
from tests.logs import BEGAN, READINGS, SECOND, drive, snapshot, with_goal, write_log
from tests.ros2.foreign import foreign

NOT_THERE = {"tf2_msgs/msg/TFMessage"}
"""Types that the wheels lack."""
Read = dict[str, list[tuple[int, Any]]]


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("bag")
    log = open_log(write_log(folder / "a.mcap", with_goal(drive(20, lasers=["laser"]))))
    write_bag(log, folder / "bag", BagKind.ROS2, Profile.ROS2)
    return folder / "bag/bag.mcap"


@pytest.fixture(scope="module", params=["jazzy", "kilted"])
def read(bag: Path, request: pytest.FixtureRequest) -> Read:
    """Return what rclpy makes of each message, by topics."""
    ros = foreign(request.param)
    script = Path(__file__).with_name("read_bag.py")
    done = subprocess.run(
        [ros.python, str(script), str(bag)],
        env={**os.environ, **ros.variables},
        capture_output=True,
        text=True,
        check=True,
        timeout=100,
    )
    *lines, unknown = map(json.loads, done.stdout.splitlines())
    assert unknown.keys() == NOT_THERE
    found: Read = {}
    for topic, time, content in lines:
        found.setdefault(topic, []).append((time, content))
    return found


def test_the_mcap_library_finds_index_and_statistics(bag: Path) -> None:
    with bag.open("rb") as file:
        reader = make_reader(file)
        summary = reader.get_summary()
        assert reader.get_header().profile == "ros2"
        assert summary is not None
        assert summary.statistics is not None
        messages = list(reader.iter_messages())
    assert len(messages) == summary.statistics.message_count
    assert {schema.encoding for schema in summary.schemas.values()} == {"ros2msg"}
    assert {channel.message_encoding for channel in summary.channels.values()} == {"cdr"}
    times = [message.log_time for _, _, message in messages]
    assert times == sorted(times)


def test_rclpy_reads_the_numbers_of_the_log(read: Read) -> None:
    assert len(read["/odom"]) == 201
    for number, (time, message) in enumerate(read["/odom"]):
        at = 0.02 + number / 10
        known: Snapshot = snapshot(at)
        assert time == BEGAN + round(at * SECOND)
        stamp = message["header"]["stamp"]
        assert stamp["sec"] * SECOND + stamp["nanosec"] == pytest.approx(
            time - 0.002 * SECOND, abs=1000
        )
        pose = message["pose"]["pose"]["position"]
        assert (pose["x"], pose["y"]) == (
            known.odometry.robot_in_odom.x,
            known.odometry.robot_in_odom.y,
        )
        assert message["pose"]["covariance"][::7] == [1e-3, 1e-3, 1e6, 1e6, 1e6, 0.03]
    for _, message in read["/scan"]:
        ranges = [float(each) for each in message["ranges"]]
        assert str(ranges) == str([*READINGS])
        assert message["intensities"] == [1.0, 2.0, 3.0, 4.0, 5.0]
        assert message["angle_min"] == -0.5
    (_, battery), *_ = read["/battery_state"]
    assert battery["voltage"] == float(np.float32(12.3))
    assert isnan(float(battery["current"]))
    assert {message["linear"]["x"] for _, message in read["/cmd_vel"]} == {0.3}
    assert {message["data"] for _, message in read["/emergency_stop"]} == {False}
    (_, place), *_ = read["/amcl_pose"]
    assert place["header"]["frame_id"] == "map"
    diagnoses = [message["status"] for _, message in read["/diagnostics"]]
    assert len(diagnoses) == 21
    link, *_, navigation = diagnoses[1]
    assert (link["name"], link["level"], link["hardware_id"]) == ("RosAria: Link", [0], "bob")
    assert navigation["message"] == "on the way to dock"
    (_, goal), *_ = read["/goal_pose"]
    assert (goal["header"]["frame_id"], goal["pose"]["position"]["x"]) == ("map", 6.0)
    (_, urdf), *_ = read["/robot_description"]
    assert urdf["data"].startswith("<?xml")
