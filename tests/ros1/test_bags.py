"""Bags that a log was converted to, as ROS 1's own tools read them."""

import json
import os
import subprocess
from math import inf, isnan
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pioneer3.log.reader import open_log
from pioneer3.ros.bag.convert import BagKind, write_bag
from pioneer3.ros.node.names import Profile
from pioneer3.ros.tcpros.types import Ros1Types
from tests.logs import BEGAN, READINGS, SECOND, drive, snapshot, with_goal, write_log
from tests.ros1.master import HERE, PYTHON, has_ros

PROFILES = (Profile.BOTH, Profile.P2OS)


@pytest.fixture(scope="module")
def bags(tmp_path_factory: pytest.TempPathFactory) -> list[dict[str, Any]]:
    """Return the bags of a log, with the names of two profiles."""
    if not has_ros():
        if os.environ.get("CI") == "true":
            pytest.fail("ROS 1 is not installed; scripts/test installs it")
        pytest.skip("ROS 1 is not installed; scripts/test installs it")
    folder = tmp_path_factory.mktemp("bags")
    log = open_log(write_log(folder / "a.mcap", with_goal(drive(60, lasers=["laser"]))))
    paths = [folder / f"{profile}.bag" for profile in PROFILES]
    for path, profile in zip(paths, PROFILES, strict=True):
        write_bag(log, path, BagKind.ROS1, profile)
    command = [PYTHON, str(HERE / "read_bag.py"), *map(str, paths)]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=100)
    return json.loads(done.stdout)  # type: ignore[no-any-return]


def test_all_messages_are_read_with_the_checksums_of_ros(bags: list[dict[str, Any]]) -> None:
    types = Ros1Types()
    for bag in bags:
        for topic in bag.values():
            assert topic["checksum"] == types.definition(topic["type"]).md5sum
            assert topic["messages"]
    assert len(bags[0]["/RosAria/pose"]["messages"]) == 601
    assert bags[0]["/tf_static"]["latched"]
    assert not bags[0]["/tf"]["latched"]
    assert bags[1]["/sonar"]["type"] == "p2os_msgs/SonarArray"


def test_the_numbers_are_those_of_the_log(bags: list[dict[str, Any]]) -> None:
    bag = bags[0]
    for number, (time, content) in enumerate(bag["/odom"]["messages"]):
        at = 0.02 + number / 10
        pose = snapshot(at).odometry.robot_in_odom
        _, stamp, frame, child, x, y, *_ = content
        assert time == BEGAN + round(at * SECOND)
        assert stamp == pytest.approx(time - 0.002 * SECOND, abs=1000)
        assert (frame, child, x, y) == ("odom", "base_footprint", pose.x, pose.y)
    for _, content in bag["/scan"]["messages"]:
        *_, farthest = content[:10]
        ranges = [float(each) for each in content[10:15]]
        assert farthest == 8.0
        assert [each for each in ranges if not isnan(each)] == [1.25, inf, -inf, 7.5]
        assert isnan(ranges[READINGS.index(-inf) + 1])
        assert content[15:] == [1.0, 2.0, 3.0, 4.0, 5.0]
    diagnoses = bag["/diagnostics"]["messages"]
    assert [time for time, _ in diagnoses[:2]] == [BEGAN + each * SECOND // 50 for each in (1, 51)]
    assert diagnoses[0][1][3:6] == [0, "RosAria: Link", "connected"]
    ((_, sent),) = bag["/move_base/goal"]["messages"]
    assert sent[-7:-4] == [6.0, 7.0, 0.0]
    ((_, ended),) = bag["/move_base/result"]["messages"]
    assert ended[-2:] == [3, "arrived"]
    assert ended[-3] == sent[4]
    *_, (_, fed) = bag["/move_base/feedback"]["messages"]
    assert (fed[3:7], fed[9]) == ([*sent[3:5], 1, "on its way"], "map")
    voltages = {content[0] for _, content in bag["/RosAria/battery_voltage"]["messages"]}
    assert voltages == {12.3}
    assert {content[2] for _, content in bag["/battery_state"]["messages"]} == {"base_link"}
    assert bag["/battery_state"]["messages"][0][1][3] == float(np.float32(12.3))


def test_the_programs_of_ros_list_and_filter_it(bags: list[dict[str, Any]], tmp_path: Path) -> None:
    path = tmp_path / "a.bag"
    log = write_log(tmp_path / "a.mcap", drive(2))
    write_bag(open_log(log), path, BagKind.ROS1, Profile.COMPATIBILITY)
    listed = _rosbag("info", "--yaml", str(path))
    assert "compression: lz4" in listed
    assert "topic: /RosAria/pose" in listed
    _rosbag("filter", str(path), str(tmp_path / "b.bag"), "topic == '/tf'")
    assert "messages: 21\n" in _rosbag("info", "--yaml", str(tmp_path / "b.bag"))


def _rosbag(*arguments: str) -> str:
    command = [PYTHON, "/usr/bin/rosbag", *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=60)
    return done.stdout
