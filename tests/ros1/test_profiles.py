"""Nodes with other names than the usual ones, nodes that lose their robot, and descriptions."""

import asyncio
import re
import signal
from math import atan2, cos
from pathlib import Path

import pytest

from pioneer3.models import load_model, shape_of
from tests.ros1.master import ended, ros, script
from tests.ros1.office import office

pytestmark = pytest.mark.realtime

P3AT = load_model("p3at-sh")
LAST_WORDS = ("/motors_state", "/emergency_stop", "/diagnostics")
"""What says that the robot is lost."""
SENSORS = (
    "/odom",
    "/tf",
    "/joint_states",
    "/scan",
    "/imu/data_raw",
    "/battery_state",
    "/bumper_state",
    "/sonar/points",
    "/sonar/range_0",
)
FILTER = ("rostopic", "pub", "-s", "-r", "20", "/tf", "tf2_msgs/TFMessage")
MOVES = (
    "{transforms: [{header: {stamp: now, frame_id: odom_combined}, child_frame_id: base_footprint,"
    " transform: {translation: {x: 2.0}, rotation: {w: 1.0}}}]}"
)
"""The transform of robot_pose_ekf."""
DRIVE = ("rostopic", "pub", "-r", "10", "/cmd_vel", "geometry_msgs/Twist")


async def test_the_tree_leads_from_odometry_to_every_sensor(ros1: None) -> None:
    sonars = [f"sonar_{number}" for number in range(16)]
    others = ("base_footprint", "base_link", "bumpers", "laser", "imu_link", "rear_left_wheel")
    async with office("_profile:=standard", "_frame_prefix:=r1/"):
        frames = [f"r1/{name}" for name in (*sonars, *others)]
        tree = await script("look_up.py", "2.0", "r1/odom", *frames)
    assert tree["roots"] == ["r1/odom"]
    assert all(len(above) == 1 for above in tree["parents"].values())
    for number, mount in enumerate(P3AT.sonars):
        x, y, z, _, _, qz, qw = tree["at"][f"r1/sonar_{number}"]
        assert (x, y, z) == pytest.approx((mount.x, mount.y, shape_of(P3AT).sonar_height))
        assert cos(2 * atan2(qz, qw) - mount.theta) == pytest.approx(1.0)
    assert tree["at"]["r1/base_link"] == pytest.approx([0, 0, 0, 0, 0, 0, 1])
    assert tree["parents"]["r1/base_footprint"] == ["r1/odom"]
    assert tree["parents"]["r1/base_link"] == ["r1/base_footprint"]


@pytest.mark.parametrize("profile", ["compatibility", "standard"])
async def test_a_filter_that_moves_the_footprint_moves_the_robot(ros1: None, profile: str) -> None:
    async with office(f"_profile:={profile}", "_publish_tf:=false"):
        robot_pose_ekf = asyncio.create_task(ended(*FILTER, MOVES, patience=6.0))
        tree = await script("look_up.py", "4.0", "odom_combined", "base_link", "sonar_3")
        await robot_pose_ekf
    assert tree["roots"] == ["odom_combined"]
    assert all(len(above) == 1 for above in tree["parents"].values())
    assert tree["at"]["base_link"] == pytest.approx([2, 0, 0, 0, 0, 0, 1])


async def test_the_tree_of_rosaria_has_no_footprint(ros1: None) -> None:
    async with office():
        tree = await script("look_up.py", "2.0", "odom", "base_link", "sonar_3")
    assert tree["parents"]["base_link"] == ["odom"]
    assert "base_footprint" not in tree["parents"]


async def test_tf_echo_says_where_the_robot_and_its_sensors_are(ros1: None) -> None:
    sonar = P3AT.sonars[3]
    async with office("_profile:=standard"):
        _, said = await ended("rosrun", "tf", "tf_echo", "base_link", "sonar_3", patience=4.0)
        x, y = re.findall(r"Translation: \[(.+), (.+), .+\]", said)[-1]
        assert (float(x), float(y)) == pytest.approx((sonar.x, sonar.y), abs=1e-3)
        await ended(*DRIVE, "{linear: {x: 0.3}}", patience=3.0)
        _, said = await ended("rosrun", "tf", "tf_echo", "odom", "base_footprint", patience=4.0)
        assert float(re.findall(r"Translation: \[([\d.]+),", said)[-1]) > 0.1


async def test_both_profiles_at_once_say_the_same_and_drive(ros1: None, tmp_path: Path) -> None:
    bag = tmp_path / "both.bag"
    async with office("_profile:=both"):
        topics = ("/odom", "/RosAria/pose", "/sonar/range_3", "/joint_states", "/tf", "/tf_static")
        recording = asyncio.create_task(
            ended("rosbag", "record", "-O", str(bag), *topics, patience=7.0)
        )
        await asyncio.sleep(2.0)
        await ended(*DRIVE, "{linear: {x: 0.2}}", patience=4.0)
        await recording
        info = await ros("rosbag", "info", str(bag))
        for topic in topics:
            assert topic in info
        poses = await script("bag.py", str(bag), "/odom", "/RosAria/pose")
    odom, pose = (dict(poses[topic]) for topic in ("/odom", "/RosAria/pose"))
    both = odom.keys() & pose.keys()  # the recording begins and ends with one before the other
    assert len(both) > 30
    assert all(odom[stamp] == pose[stamp] for stamp in both)
    assert max(odom.values()) > 0.1


async def test_of_a_lost_robot_only_that_it_is_lost_is_told(ros1: None) -> None:
    async with office("_profile:=standard", "_use_sonar:=false") as lab:
        assert "success: True" in await ros("rosservice", "call", "/self_test")
        assert await script("survey.py", "1.5", "/sonar/range_0", "/sonar/points") == {}
        await lab.simulator.end(signal.SIGINT)
        await asyncio.sleep(1.0)
        heard = await script("survey.py", "3.0", *LAST_WORDS, *SENSORS)
        assert set(heard) == set(LAST_WORDS)
        assert "True" in await ros("rostopic", "echo", "-n", "1", "/emergency_stop")
        said = await ros("rostopic", "echo", "-n", "1", "/diagnostics")
        assert 'name: "RosAria: Link"' in said
        assert "no robot is connected" in said
        assert "level: 3" in said


async def test_the_robot_is_described_until_the_node_ends(ros1: None, tmp_path: Path) -> None:
    async with office() as lab:
        described = tmp_path / "robot.urdf"
        described.write_text(await script("parameter.py", "/robot_description"))
        assert "Successfully Parsed XML" in await ros("check_urdf", str(described))
        await lab.node.end(signal.SIGINT)
        assert "/robot_description" not in await ros("rosparam", "list")


async def test_somebody_elses_description_stays(ros1: None) -> None:
    await ros("rosparam", "set", "/robot_description", "<robot name='mine'/>")
    try:
        async with office() as lab:
            await lab.node.end(signal.SIGINT)
        assert "mine" in await ros("rosparam", "get", "/robot_description")
    finally:
        await ros("rosparam", "delete", "/robot_description")
