"""The names that the lab's programs have built in."""

import pytest

from pioneer3.errors import ConfigError
from pioneer3.ros.node.names import CommandName, Profile, lab_commands, lab_node
from pioneer3.ros.node.parameter_reading import read_parameters
from pioneer3.ros.node.topics import command_topics
from pioneer3.ros.ros1.start import node_name

ALL = CommandName("/RosAria/cmd_vel", shared=True)


@pytest.mark.parametrize(
    ("name", "topic"),
    [
        ("p3at_0_119", "/RosAria/cmd_vel_p0_119"),
        ("p3at_1_113", "/RosAria/cmd_vel_p1_113"),
        ("p3dx_5_160", "/RosAria/cmd_vel_p5_160"),
        ("local", "/RosAria/cmd_vel_local"),
    ],
)
def test_a_robot_of_the_lab_has_a_topic_of_its_own(name: str, topic: str) -> None:
    assert lab_commands(name) == (ALL, CommandName(topic))


def test_its_node_is_named_after_it() -> None:
    assert lab_node("p3at_1_113") == "RosAria_p3at_1_113"
    assert node_name(["_lab_name:=p3at_1_113", "_port:=/dev/ttyS0"]) == "RosAria_p3at_1_113"
    assert node_name([]) == "RosAria"


def test_it_listens_to_rosarias_own_topic_too() -> None:
    assert command_topics(Profile.COMPATIBILITY) == (CommandName("~cmd_vel"),)
    own = (ALL, CommandName("/RosAria/cmd_vel_p1_113"), CommandName("~cmd_vel"))
    assert command_topics(Profile.COMPATIBILITY, "p3at_1_113") == own


@pytest.mark.parametrize("name", ["p3at 1", "1_113", "/p3at", 113, ["p3at"]])
def test_what_ros_cannot_have_in_a_name_is_refused(name: object) -> None:
    with pytest.raises(ConfigError, match="~lab_name"):
        read_parameters({"lab_name": name})


def test_no_name_is_the_usual() -> None:
    assert read_parameters({}).lab_name == ""
    assert read_parameters({"lab_name": ""}).lab_name == ""
    assert read_parameters({"lab_name": "local"}).lab_name == "local"
