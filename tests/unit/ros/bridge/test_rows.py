"""The table of a bridge, and rows of users."""

from pathlib import Path

import pytest

from pioneer3.errors import ConfigError
from pioneer3.models import load_model
from pioneer3.ros.bridge.conversion import Converter
from pioneer3.ros.bridge.rows import (
    BridgedRobot,
    BridgedTopic,
    BridgeWay,
    Side,
    chosen,
    rows_of,
    services_of,
)
from pioneer3.ros.bridge.start import BridgeOptions, table_of
from pioneer3.ros.bridge.topic_file import parse_topic, read_topics, refuse_circles
from pioneer3.ros.node.names import Profile
from pioneer3.ros.ros2.distros import distro_of
from pioneer3.ros.ros2.start import NodeOptions
from pioneer3.ros.ros2.types import MessageTypes
from pioneer3.ros.tcpros.types import Ros1Types

CONVERTER = Converter(Ros1Types(), MessageTypes(distro_of("jazzy")))


def robot(side: Side = Side.ROS2, distro: str = "jazzy", **parts: str) -> BridgedRobot:
    profile = Profile.BOTH if side is Side.ROS2 else Profile.COMPATIBILITY
    model = load_model("p3dx-sh")
    return BridgedRobot(side=side, model=model, distro=distro_of(distro), profile=profile, **parts)


def pairs(robot: BridgedRobot, ros2: str) -> list[tuple[str, BridgeWay]]:
    return [(row.ros1, row.way) for row in rows_of(robot) if row.ros2 == ros2]


def test_a_robot_in_ros2_has_both_names_in_ros1() -> None:
    assert pairs(robot(), "/odom") == [
        ("/RosAria/pose", BridgeWay.TO_ROS1),
        ("/odom", BridgeWay.TO_ROS1),
    ]
    assert pairs(robot(), "/cmd_vel") == [
        ("/RosAria/cmd_vel", BridgeWay.TO_ROS2),
        ("/cmd_vel", BridgeWay.TO_ROS2),
    ]
    assert pairs(robot(), "/goal_pose") == [("/move_base_simple/goal", BridgeWay.TO_ROS2)]
    assert pairs(robot(), "/cmd_vel_stamped") == []
    assert pairs(robot(distro="kilted"), "/cmd_vel") == []
    assert len(pairs(robot(distro="kilted"), "/cmd_vel_unstamped")) == 2
    assert ("/sonar/range_7", BridgeWay.TO_ROS1) in pairs(robot(), "/sonar/range_7")
    assert pairs(robot(), "/sonar/range_16") == []


def test_a_robot_in_ros1_takes_both_types_of_commands_and_has_all_that_rosaria_has() -> None:
    kilted = robot(Side.ROS1, "kilted")
    rows = {row.ros2: row for row in rows_of(kilted)}
    assert rows["/cmd_vel"].ros2_type == "geometry_msgs/TwistStamped"
    assert rows["/cmd_vel"].ros1_type == rows["/cmd_vel_unstamped"].ros2_type
    assert rows["/cmd_vel"].ros1 == rows["/cmd_vel_unstamped"].ros1 == "/RosAria/cmd_vel"
    assert rows["/odom"].ros1 == "/RosAria/pose"
    assert rows["/sonar"].ros1_type == "sensor_msgs/PointCloud"
    assert rows["/tf"].way is BridgeWay.TO_ROS2
    assert rows["/initialpose"].way is BridgeWay.TO_ROS1


def test_every_row_can_be_converted() -> None:
    for side in Side:
        for row in rows_of(robot(side)):
            for source in row.way.sources:
                convert = CONVERTER.to_ros2 if source is Side.ROS1 else CONVERTER.to_ros1
                assert callable(convert(row.ros1_type, row.ros2_type))


def test_names_are_below_their_namespaces() -> None:
    named = robot(namespace="/robot1", ros1_namespace="/lab", ros1_node="RosAria_1")
    assert pairs(named, "/robot1/odom") == [
        ("/lab/RosAria_1/pose", BridgeWay.TO_ROS1),
        ("/lab/odom", BridgeWay.TO_ROS1),
    ]
    assert pairs(named, "/robot1/tf") == [("/tf", BridgeWay.TO_ROS1)]
    assert ("/lab/RosAria_1/enable_motors", "/robot1/enable_motors") in {
        (row.ros1, row.ros2) for row in services_of(named)
    }


def test_latched_rows_say_what_holds_without_a_robot() -> None:
    rows = {row.ros1: row for row in rows_of(robot())}
    assert rows["/emergency_stop"].latched
    assert rows["/emergency_stop"].when_lost is True
    assert rows["/RosAria/motors_state"].when_lost is False
    assert rows["/tf_static"].when_lost is None


def test_services_keep_their_types_on_each_side() -> None:
    rows = {row.ros1: row for row in services_of(robot())}
    assert rows["/RosAria/enable_motors"].ros1_type == "std_srvs/Empty"
    assert rows["/RosAria/enable_motors"].ros2_type == "std_srvs/Trigger"
    assert rows["/sonar/enable"].topic_type == "std_msgs/Bool"
    assert "/static_map" not in rows


def test_rows_are_chosen_by_either_name() -> None:
    rows = rows_of(robot())
    assert {row.ros1 for row in chosen(rows, ["cmd_vel", "/tf"])} == {
        "/RosAria/cmd_vel",
        "/cmd_vel",
        "/tf",
    }
    assert chosen(rows, []) == rows
    with pytest.raises(ConfigError, match="no row is called 'odomm', did you mean odom"):
        chosen(rows, ["odomm"])


def test_an_option_is_a_row() -> None:
    row = parse_topic("/joy:sensor_msgs/Joy", BridgeWay.TO_ROS2, CONVERTER)
    assert (row.ros1, row.ros2, row.ros1_type) == ("/joy", "/joy", "sensor_msgs/Joy")
    assert parse_topic("/joy:sensor_msgs/msg/Joy", BridgeWay.TO_ROS2, CONVERTER) == row


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("/joy", "a topic to bridge is such as"),
        ("joy:sensor_msgs/Joy", "a topic to bridge is such as"),
        ("/1joy:sensor_msgs/Joy", "no name of a topic"),
        ("/joy:sensor_msgs/Joystick", "no definition of ROS 1's message type"),
        ("/goal:actionlib_msgs/Nothing", "no definition"),
    ],
)
def test_an_option_that_is_no_row_is_explained(text: str, words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        parse_topic(text, BridgeWay.TO_ROS2, CONVERTER)


def test_a_file_has_rows(tmp_path: Path) -> None:
    path = tmp_path / "topics.toml"
    path.write_text(
        '[[topic]]\nros1 = "/joy"\ntype = "sensor_msgs/Joy"\nway = "both"\nreliable = false\n'
        '[[topic]]\nros1 = "/a"\nros2 = "/b/c"\ntype = "std_msgs/Bool"\nway = "to_ros1"\n'
        "latched = true\n"
    )
    joy, other = read_topics(path, CONVERTER)
    assert (joy.ros2, joy.way, joy.reliable, joy.latched) == ("/joy", BridgeWay.BOTH, False, False)
    assert (other.ros1, other.ros2, other.way, other.latched) == (
        "/a",
        "/b/c",
        BridgeWay.TO_ROS1,
        True,
    )


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ('type = "sensor_msgs/Jo"', r"topics.toml:4: topic\[0\].type: no definition of ROS 1"),
        ('type = "Joy"', r"topics.toml:4: topic\[0\].type: a type is such as sensor_msgs/Joy"),
        (
            'typ = "sensor_msgs/Joy"',
            r"topics.toml:4: topic\[0\].typ: unknown key, did you mean type",
        ),
        (
            'ros2 = "joy stick"\ntype = "sensor_msgs/Joy"',
            r"topics.toml:4: topic\[0\].ros2: 'joy st",
        ),
        ("", r"topic\[0\].type: missing"),
        (
            'type = "sensor_msgs/Joy"\nlatched = 1',
            r"topics.toml:5: topic\[0\].latched: expected tr",
        ),
    ],
)
def test_a_wrong_file_is_told_by_line_and_key(tmp_path: Path, line: str, words: str) -> None:
    path = tmp_path / "topics.toml"
    path.write_text(f'[[topic]]\nros1 = "/joy"\nway = "to_ros2"\n{line}\n')
    with pytest.raises(ConfigError, match=words):
        read_topics(path, CONVERTER)


def test_an_unknown_way_is_told(tmp_path: Path) -> None:
    path = tmp_path / "topics.toml"
    path.write_text('[[topic]]\nros1 = "/joy"\ntype = "sensor_msgs/Joy"\nway = "there"\n')
    with pytest.raises(ConfigError, match="'there' is not one of to_ros1, to_ros2, both"):
        read_topics(path, CONVERTER)


def row(ros1: str, ros2: str, way: BridgeWay) -> BridgedTopic:
    return BridgedTopic(
        ros1=ros1, ros2=ros2, ros1_type="std_msgs/Bool", ros2_type="std_msgs/Bool", way=way
    )


def test_circles_are_refused() -> None:
    refuse_circles((row("/a", "/a", BridgeWay.BOTH), row("/b", "/b", BridgeWay.TO_ROS1)))
    with pytest.raises(ConfigError, match="in a circle"):
        refuse_circles((row("/a", "/b", BridgeWay.TO_ROS2), row("/c", "/b", BridgeWay.TO_ROS1)))
    with pytest.raises(ConfigError, match="in a circle"):
        refuse_circles((row("/a", "/a", BridgeWay.BOTH), row("/a", "/b", BridgeWay.TO_ROS2)))
    with pytest.raises(ConfigError, match="two rows"):
        refuse_circles((row("/a", "/a", BridgeWay.TO_ROS1), row("/a", "/a", BridgeWay.TO_ROS1)))


def test_a_row_of_a_user_takes_the_place_of_one_of_the_table() -> None:
    options = BridgeOptions(
        node=NodeOptions(), to_ros2=["/diagnostics:diagnostic_msgs/DiagnosticArray"]
    )
    (found,) = (row for row in table_of(options).rows if row.ros1 == "/diagnostics")
    assert found.way is BridgeWay.TO_ROS2


def test_options_that_make_no_sense_are_refused() -> None:
    with pytest.raises(ConfigError, match="each message would come twice"):
        table_of(BridgeOptions(node=NodeOptions(), robot=Side.ROS1, profile=Profile.BOTH))
    with pytest.raises(ConfigError, match=r"at least 0\.1 s, not 0\.01"):
        assert BridgeOptions(node=NodeOptions(), timeout=0.01).lasting
    with pytest.raises(ConfigError, match="not -1"):
        assert BridgeOptions(node=NodeOptions(), timeout=-1).lasting
