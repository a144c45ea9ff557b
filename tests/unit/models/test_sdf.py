import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
import yaml

from pioneer3.models import RobotModel, load_model, physics_of, shape_of, total_mass
from pioneer3.models.description import gazebo
from pioneer3.models.description.gazebo import bridge_of, exchanges_of
from pioneer3.models.description.sdf import SONAR_FAR, SONAR_NEAR, sdf_of
from pioneer3.models.description.tree import Frames, body_tree
from pioneer3.ros.messages.update import Beam
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.topics import topics_of
from tests.support import DISTINCT

EVERY = [load_model(name) for name in DISTINCT]
P3AT, P3DX, PEOPLEBOT = (load_model(name) for name in ("p3at-sh", "p3dx-sh", "peoplebot-sh"))
KNOWN = {
    ("gz-sim-diff-drive-system", "gz::sim::systems::DiffDrive"): {
        *("left_joint", "right_joint", "wheel_separation", "wheel_radius"),
        *("odom_publish_frequency", "topic", "odom_topic", "tf_topic", "frame_id"),
        *("child_frame_id", "min_linear_velocity", "max_linear_velocity"),
        *("min_linear_acceleration", "max_linear_acceleration", "min_angular_velocity"),
        *("max_angular_velocity", "min_angular_acceleration", "max_angular_acceleration"),
    },
    ("gz-sim-joint-state-publisher-system", "gz::sim::systems::JointStatePublisher"): {
        *("topic", "joint_name", "update_rate")
    },
}
"""Plug-ins and their parameters in the documentation of gz-sim."""
SENSORS = {"imu", "gpu_lidar", "contact"}
MESSAGES = {
    "geometry_msgs/msg/Twist": "gz.msgs.Twist",
    "nav_msgs/msg/Odometry": "gz.msgs.Odometry",
    "tf2_msgs/msg/TFMessage": "gz.msgs.Pose_V",
    "sensor_msgs/msg/JointState": "gz.msgs.Model",
    "sensor_msgs/msg/Imu": "gz.msgs.IMU",
    "sensor_msgs/msg/LaserScan": "gz.msgs.LaserScan",
    "ros_gz_interfaces/msg/Contacts": "gz.msgs.Contacts",
    "rosgraph_msgs/msg/Clock": "gz.msgs.Clock",
}
"""Pairs in the documentation of ros_gz_bridge."""

every = pytest.mark.parametrize("model", EVERY, ids=lambda model: model.name)


def parsed(model: RobotModel) -> ET.Element:
    """Return the element of the model."""
    (found,) = ET.fromstring(sdf_of(model)).findall("model")
    return found


def with_bumpers(model: RobotModel, segments: int) -> RobotModel:
    """Return the model with so many segments in front, and behind."""
    return replace(model, front_bumpers=segments, rear_bumpers=segments)


def number(element: ET.Element, path: str) -> float:
    """Return the number in the element at this path."""
    text = element.findtext(path)
    assert text is not None, path
    return float(text)


@pytest.fixture(scope="session")
def sdf_check(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Compile the program that reads an SDF by Gazebo's own library."""
    if not (shutil.which("g++") and shutil.which("pkg-config")):
        pytest.skip("needs g++ and pkg-config")
    flags = subprocess.run(
        ["pkg-config", "--cflags", "--libs", "sdformat12"],
        capture_output=True,
        text=True,
        check=False,
    )
    if flags.returncode:
        pytest.skip("needs libsdformat-dev")
    program = tmp_path_factory.mktemp("sdf") / "sdf_check"
    source = Path(__file__).with_name("sdf_check.cc")
    subprocess.run(["g++", source, "-o", program, *flags.stdout.split()], check=True)
    return program


@pytest.mark.thorough  # a program is compiled for it
def test_gazebos_library_accepts_each_robot_without_a_word(sdf_check: Path, tmp_path: Path) -> None:
    robots = [each for model in EVERY for each in (model, with_bumpers(model, 5))]
    files = [tmp_path / f"{number}.sdf" for number in range(len(robots))]
    for file, model in zip(files, robots, strict=True):
        file.write_text(sdf_of(model))
    done = subprocess.run([sdf_check, *files], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    for line, model in zip(done.stdout.splitlines(), robots, strict=True):
        links, joints, sensors = map(int, line.split())
        moving = len(body_tree(model, Frames()).moving)
        assert (links, joints) == (1 + moving, moving), model.name
        assert sensors == len(parsed(model).findall("link/sensor")), model.name
        assert sensors >= 1 + len(model.sonars) + (model.laser is not None), model.name


@every
def test_plugins_and_sensors_are_those_that_gazebo_has(model: RobotModel) -> None:
    robot = parsed(with_bumpers(model, 5))
    plugins = robot.findall("plugin")
    assert {(each.get("filename"), each.get("name")) for each in plugins} == set(KNOWN)
    for each in plugins:
        known = KNOWN[each.get("filename", ""), each.get("name", "")]
        assert {parameter.tag for parameter in each} == known
    assert {each.get("type") for each in robot.iter("sensor")} == SENSORS
    collisions = {each.get("name") for each in robot.iter("collision")}
    touching = [each.text for each in robot.iterfind("link/sensor/contact/collision")]
    assert len(set(touching)) == len(touching) == 10
    assert set(touching) <= collisions


@every
def test_the_drive_turns_as_the_robot_does(model: RobotModel) -> None:
    robot, shape = parsed(model), shape_of(model)
    drive = robot.findall("plugin")[0]
    assert number(drive, "wheel_separation") == pytest.approx(shape.effective_track, abs=1e-6)
    assert number(drive, "wheel_radius") == shape.wheel_radius
    wheels = body_tree(model, Frames()).wheels
    for side, joints in (("left", wheels[::2]), ("right", wheels[1::2])):
        assert [each.text for each in drive.findall(f"{side}_joint")] == [
            joint.name for joint in joints
        ]
    masses = [float(mass.text or "") for mass in robot.iter("mass")]
    assert sum(masses) == pytest.approx(total_mass(model))
    efforts = [float(each.text or "") for each in robot.iterfind("joint/axis/limit/effort")]
    assert sum(efforts) == pytest.approx(2 * physics_of(model).side_torque)


def test_topics_are_those_of_the_node_in_its_standard_profile() -> None:
    node = {
        name: topic.type_name.replace("/", "/msg/")
        for topic in topics_of(PEOPLEBOT)
        for name in topic.names(Profile.STANDARD)
    }
    ours = {each.topic: each.ros_type for each in exchanges_of(PEOPLEBOT)}
    shared = {
        *("cmd_vel", "odom", "/tf", "joint_states", "imu/data_raw", "scan"),
    }
    assert shared == {topic for topic in ours if topic in node}
    assert all(node[topic] == ours[topic] for topic in shared)
    assert (Beam().nearest, Beam().farthest) == (SONAR_NEAR, SONAR_FAR)


@every
@pytest.mark.parametrize("segments", [0, 5])
def test_the_bridge_has_all_topics_of_the_robot(model: RobotModel, segments: int) -> None:
    model = with_bumpers(model, segments)
    entries = yaml.safe_load(bridge_of(model))
    assert all(MESSAGES[each["ros_type_name"]] == each["gz_type_name"] for each in entries)
    assert [each["direction"] for each in entries].count("ROS_TO_GZ") == 1
    assert entries[0]["ros_topic_name"] == gazebo.COMMAND.topic
    assert entries[0]["direction"] == "ROS_TO_GZ"
    bridged = {each["gz_topic_name"] for each in entries}
    robot = parsed(model)
    topics = {each.text for each in robot.iter() if re.fullmatch(r"(odom_|tf_)?topic", each.tag)}
    assert bridged == topics | {"/clock"}


def test_a_robot_without_laser_has_no_scan() -> None:
    blind = replace(P3DX, laser=None)
    assert "<topic>scan</topic>" in sdf_of(P3DX)
    assert "<topic>scan</topic>" not in sdf_of(blind)
    assert "topic_name: scan\n" in bridge_of(P3DX)
    assert "topic_name: scan\n" not in bridge_of(blind)


@every
def test_odometry_moves_the_footprint_which_is_where_the_base_is(model: RobotModel) -> None:
    robot = parsed(model)
    (frame,) = robot.findall("frame[@name='base_footprint']")
    assert frame.get("attached_to") == "base_link"
    assert frame.find("pose") is None
    assert robot.find("frame[@name='base_link']") is None
    assert robot.findtext("plugin/child_frame_id") == "base_footprint"


@every
def test_rays_begin_outside_the_sensors(model: RobotModel) -> None:
    robot = parsed(model)
    places = body_tree(model, Frames()).fixed_in_base()
    for sensor in robot.findall("link/sensor[lidar]"):
        assert number(sensor, "lidar/range/min") >= 0.1
        assert number(sensor, "lidar/range/max") > number(sensor, "lidar/range/min")
        (pose,) = sensor.findall("pose")
        assert pose.get("relative_to") == sensor.findtext("gz_frame_id")
        assert sensor.findtext("gz_frame_id") in places
