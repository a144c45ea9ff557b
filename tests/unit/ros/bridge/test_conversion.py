"""Messages of every type in the table, there and back."""

from collections.abc import Callable
from math import nan
from typing import Any

import numpy as np
import pytest

from pioneer3.errors import ConfigError
from pioneer3.models import load_model
from pioneer3.ros.bridge.conversion import Converter, FrameNames
from pioneer3.ros.bridge.rows import BridgedRobot, Side, rows_of
from pioneer3.ros.node.names import Profile
from pioneer3.ros.ros2.distros import distro_of, distros
from pioneer3.ros.ros2.types import MessageTypes
from pioneer3.ros.tcpros.types import Ros1Types
from pioneer3.ros.typestore import ARRAY, BASE, NAME, MessageStore

ROS1 = Ros1Types()
CONVERTERS = {name: Converter(ROS1, MessageTypes(distro_of(name))) for name in distros()}
LACKING = {"variance"}
"""Fields that ROS 1 has no place for; 0 means that the value is not known."""


def types_of(distro: str) -> list[tuple[str, str]]:
    """Return the types of all rows, in ROS 1 and ROS 2."""
    pairs = set()
    for side, profile in ((Side.ROS2, Profile.BOTH), (Side.ROS1, Profile.COMPATIBILITY)):
        robot = BridgedRobot(
            side=side, model=load_model("p3at-sh"), distro=distro_of(distro), profile=profile
        )
        pairs |= {(row.ros1_type, row.ros2_type) for row in rows_of(robot)}
    return sorted(pairs)


EVERY = [(distro, *pair) for distro in distros() for pair in types_of(distro)]


class Filled:
    """Fills messages with values that all differ."""

    def __init__(self, store: MessageStore) -> None:
        self.store, self.number = store, 0

    def make(self, name: str) -> Any:
        message = self.store.make(name)
        for field, kind in self.store.fields[message.__msgtype__][1]:
            if field not in LACKING and not field.startswith("structure_needs"):
                setattr(message, field, self.value(kind))
        return message

    def value(self, kind: Any) -> Any:
        self.number = self.number % 100 + 1
        shape, inner = kind
        if shape == NAME:
            return self.make(str(inner))
        if shape == BASE:
            base = inner[0]
            if base == "string":
                return f"frame_{self.number}"
            return bool(self.number % 2) if base == "bool" else self.number
        (sub, base), length = inner
        count = length if shape == ARRAY else 3
        if sub == NAME:
            return [self.make(str(base)) for _ in range(count)]
        if base[0] == "string":
            return [f"text {self.value((BASE, ('int8', 0)))}" for _ in range(count)]
        dtype = {"byte": "uint8", "char": "uint8"}.get(base[0], base[0])
        return np.arange(self.number, self.number + count).astype(dtype)


@pytest.mark.parametrize(("distro", "ros1", "ros2"), EVERY)
def test_every_type_of_the_table_comes_back_as_it_was(distro: str, ros1: str, ros2: str) -> None:
    if ros1 != ros2:
        pytest.skip("a test of its own")
    converter = CONVERTERS[distro]
    types = converter.ros2
    cdr = types.encode(Filled(types).make(ros2))
    there = converter.to_ros1(ros1, ros2)(types.decode(cdr, ros2))
    data = converter.ros1.encode(there)
    back = converter.to_ros2(ros1, ros2)(converter.ros1.decode(data, ros1))
    assert types.encode(back) == cdr


def test_frames_of_ros1_lose_their_slash_and_their_prefix() -> None:
    converter = Converter(ROS1, MessageTypes(distro_of("jazzy")), FrameNames("robot1/"))
    message = ROS1.make("tf2_msgs/TFMessage")
    transform = ROS1.make("geometry_msgs/TransformStamped")
    transform.header.frame_id, transform.child_frame_id = "/robot1/odom", "/robot1/base_link"
    message.transforms = [transform]
    made = converter.to_ros2("tf2_msgs/TFMessage", "tf2_msgs/TFMessage")(message).transforms[0]
    assert (made.header.frame_id, made.child_frame_id) == ("odom", "base_link")
    message = converter.ros2.make("nav_msgs/Odometry")
    message.header.frame_id = "odom"
    back = converter.to_ros1("nav_msgs/Odometry", "nav_msgs/Odometry")(message)
    assert (back.header.frame_id, back.child_frame_id) == ("robot1/odom", "")


def test_a_stamped_command_is_a_twist_in_ros1() -> None:
    converter = CONVERTERS["kilted"]
    message = converter.ros2.make("geometry_msgs/TwistStamped")
    message.twist.linear.x, message.twist.angular.z = 0.3, -0.2
    made = converter.to_ros1("geometry_msgs/Twist", "geometry_msgs/TwistStamped")(message)
    assert (made.linear.x, made.angular.z) == (0.3, -0.2)
    assert ROS1.encode(made)


def test_bumpers_have_another_type_in_ros2() -> None:
    converter = CONVERTERS["jazzy"]
    pair = ("rosaria/BumperState", "std_msgs/UInt8MultiArray")
    message = ROS1.make(pair[0])
    message.front_bumpers = np.array([True, False, True, False, False])
    message.rear_bumpers = np.array([False, True])
    there = converter.to_ros2(*pair)(ROS1.decode(ROS1.encode(message), pair[0]))
    assert list(there.data) == [1, 0, 1, 0, 0, 0, 1, 0, 0, 0]
    assert [(each.label, each.size) for each in there.layout.dim] == [
        ("front, rear", 2),
        ("segment", 5),
    ]
    cdr = converter.ros2.encode(there)
    back = converter.to_ros1(*pair)(converter.ros2.decode(cdr, pair[1]))
    assert list(back.front_bumpers) == [True, False, True, False, False]
    assert list(back.rear_bumpers) == [False, True, False, False, False]
    assert ROS1.encode(back)


def test_numbers_that_are_none_stay_so() -> None:
    converter = CONVERTERS["humble"]
    message = converter.ros2.make("sensor_msgs/BatteryState")
    message.current, message.voltage = nan, 12.5
    made = converter.to_ros1("sensor_msgs/BatteryState", "sensor_msgs/BatteryState")(message)
    assert np.isnan(made.current)
    assert made.voltage == 12.5


@pytest.mark.parametrize("name", ["nonsense/Type", "move_base_msgs/MoveBaseActionGoal"])
@pytest.mark.parametrize("way", ["to_ros1", "to_ros2"])
def test_a_type_that_nobody_knows_is_named(name: str, way: str) -> None:
    convert: Callable[[str, str], object] = getattr(CONVERTERS["jazzy"], way)
    with pytest.raises(ConfigError, match=name.partition("/")[2]):
        convert(name, name)


def test_types_that_differ_are_refused() -> None:
    with pytest.raises(ConfigError, match="no field in common"):
        CONVERTERS["jazzy"].to_ros2("geometry_msgs/Twist", "std_msgs/Bool")
    with pytest.raises(ConfigError, match="float32 on one side and float64 on the other"):
        CONVERTERS["jazzy"].to_ros2("std_msgs/Float32", "std_msgs/Float64")


@pytest.mark.parametrize(
    ("name", "md5sum"),
    [
        ("nav_msgs/Odometry", "cd5e73d190d741a2f92e81eda573aca7"),
        ("tf2_msgs/TFMessage", "94810edda583a504dfda3829e70d7eec"),
        ("rosaria/BumperState", "f81947761ff7e166a3bbaf937b9869b5"),
        ("sensor_msgs/PointCloud", "d8e9c3f5afbdd8a130fd1d2763945fca"),
        ("sensor_msgs/PointCloud2", "1158d486dd51d683ce2f1be655c3c181"),
        ("std_msgs/Bool", "8b94c1b53db61fb6aed406028ad6332a"),
    ],
)
def test_types_have_the_md5sums_of_ros1(name: str, md5sum: str) -> None:
    assert ROS1.definition(name).md5sum == md5sum


def test_an_empty_message_of_ros1_has_no_bytes() -> None:
    assert ROS1.encode(ROS1.make("std_msgs/Empty")) == b""


@pytest.mark.parametrize(
    ("name", "md5sum"),
    [
        ("std_srvs/Empty", "d41d8cd98f00b204e9800998ecf8427e"),
        ("std_srvs/Trigger", "937c9679a518e3a18d831e57125ea522"),
        ("std_srvs/SetBool", "09fb03525b03e7ea1fd3992bafd87e16"),
    ],
)
def test_services_have_the_md5sums_of_ros1(name: str, md5sum: str) -> None:
    assert ROS1.service_definition(name).md5sum == md5sum
