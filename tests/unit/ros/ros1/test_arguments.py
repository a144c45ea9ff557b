"""Names, remappings, parameters and addresses in the arguments of a program of ROS 1."""

import pytest

from pioneer3.errors import ConfigError
from pioneer3.ros.ros1.arguments import parse


@pytest.mark.parametrize(
    ("arguments", "environment", "node"),
    [
        ((), {}, "/RosAria"),
        (("__name:=front",), {}, "/front"),
        ((), {"ROS_NAMESPACE": "r1"}, "/r1/RosAria"),
        (("__ns:=/r1/", "__name:=front"), {"ROS_NAMESPACE": "r2"}, "/r1/front"),
        (("__ns:=lab/r1",), {}, "/lab/r1/RosAria"),
    ],
)
def test_a_node_has_its_name_and_namespace(
    arguments: tuple[str, ...], environment: dict[str, str], node: str
) -> None:
    assert parse(arguments, "RosAria", environment).node == node


@pytest.mark.parametrize(
    ("name", "full"),
    [
        ("~pose", "/r1/RosAria/pose"),
        ("odom", "/r1/odom"),
        ("/tf", "/tf"),
        ("sonar//range_0/", "/r1/sonar/range_0"),
        ("~cmd_vel", "/teleop/cmd_vel"),
        ("/r1/RosAria/cmd_vel", "/teleop/cmd_vel"),
        ("scan", "/r1/front/scan"),
        ("front/scan", "/r1/front/scan"),
        ("cmd_vel", "/r1/cmd_vel"),
    ],
)
def test_a_name_is_resolved_and_remapped_once(name: str, full: str) -> None:
    rules = ("~cmd_vel:=/teleop/cmd_vel", "scan:=front/scan", "front/scan:=twice")
    given = parse(("__ns:=r1", *rules[:2]), "RosAria", {})
    assert given.resolved(name) == full
    assert parse(("__ns:=r1", *rules), "RosAria", {}).resolved("scan") == "/r1/front/scan"


def test_private_parameters_have_values_of_yaml_and_empty_ones_do_not_count() -> None:
    words = ("_port:=/dev/ttyS0", "_baud:=9600", "_timeout:=.inf", "_use_sonar:=false")
    given = parse((*words, "_laser/angle_min:=-1.0", "_list:=[1, 2]", "_empty:="), "n", {})
    assert given.parameters == {
        "port": "/dev/ttyS0",
        "baud": 9600,
        "timeout": float("inf"),
        "use_sonar": False,
        "laser/angle_min": -1.0,
        "list": [1, 2],
    }
    assert not given.rules


@pytest.mark.parametrize(
    ("arguments", "environment"),
    [
        (("__master:=http://lab:1",), {"ROS_MASTER_URI": "http://lab:1"}),
        (("__ip:=10.0.0.2",), {"ROS_IP": "10.0.0.2"}),
        (("__hostname:=me",), {"ROS_HOSTNAME": "me", "ROS_IP": "10.0.0.1"}),
    ],
)
def test_arguments_come_before_variables(
    arguments: tuple[str, ...], environment: dict[str, str]
) -> None:
    variables = {"ROS_IP": "10.0.0.1"} | (
        {"ROS_HOSTNAME": "lab"} if "ROS_IP" in environment else {}
    )
    found = parse(arguments, "n", variables).environment
    wanted = variables | environment
    if arguments[0].startswith("__ip"):
        wanted.pop("ROS_HOSTNAME")  # which would hide it
    assert found == wanted


@pytest.mark.parametrize(
    ("argument", "words"),
    [
        ("/dev/ttyS0", "'/dev/ttyS0' is none of ROS's arguments"),
        ("__name:=a/b", "'a/b' is no name of a node"),
        ("__name:=a b", "'a b' is no name of a node"),
        ("_port:=[", "no YAML"),
    ],
)
def test_what_is_wrong_is_told(argument: str, words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        parse((argument,), "RosAria", {})
