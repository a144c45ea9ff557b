"""The robot to check is found by its node's name, its namespace, or as the only one."""

import pytest

from pioneer3.errors import ConfigError, NoRobotError
from pioneer3.ros.checks.robots import robot_called, robots_in
from pioneer3.ros.ros2.backend import Endpoint, EndpointKind, Graph

ODOMETRY = "nav_msgs/msg/Odometry"


def graph(*nodes: str, type_name: str = ODOMETRY, commands: str = "Twist") -> Graph:
    """Return a graph in which each of `nodes` is a robot, and one that is none."""
    endpoints = [
        Endpoint(kind=EndpointKind.SUBSCRIBER, node="/rviz", name="/odom", type_name=ODOMETRY)
    ]
    for node in nodes:
        space = node.rpartition("/")[0]
        endpoints += [
            Endpoint(
                kind=EndpointKind.PUBLISHER, node=node, name=f"{space}/odom", type_name=type_name
            ),
            Endpoint(
                kind=EndpointKind.SUBSCRIBER,
                node=node,
                name=f"{space}/cmd_vel",
                type_name=f"geometry_msgs/msg/{commands}",
            ),
        ]
    return Graph(tuple(sorted({"/rviz", *nodes})), tuple(endpoints))


@pytest.mark.parametrize("commands", ["Twist", "TwistStamped"])
def test_the_only_robot_is_taken(commands: str) -> None:
    assert robot_called(graph("/pioneer3", commands=commands), None, "DDS").full == "/pioneer3"


def test_a_robot_whose_odometry_has_another_type_is_one_too() -> None:
    assert robots_in(graph("/a/base", type_name="std_msgs/msg/String")) == ["/a/base"]


@pytest.mark.parametrize("name", ["/a/base", "a/base", "a", "/a", "base"])
def test_a_robot_has_several_names(name: str) -> None:
    found = robot_called(graph("/a/base", "/b/pioneer3"), name, "DDS")
    assert (found.namespace, found.name) == ("/a", "base")


def test_a_node_that_is_no_robot_is_checked_if_it_is_named() -> None:
    assert robot_called(graph("/a/base"), "rviz", "DDS").full == "/rviz"


def test_several_robots_are_listed() -> None:
    with pytest.raises(ConfigError, match="say which with --robot; /a/base, /b/base"):
        robot_called(graph("/a/base", "/b/base"), None, "DDS")
    with pytest.raises(ConfigError, match="/a/base, /b/base"):
        robot_called(graph("/a/base", "/b/base"), "base", "DDS")


def test_an_unknown_name_is_told_with_those_that_there_are() -> None:
    with pytest.raises(NoRobotError, match="'c' on DDS; there are: /a/base"):
        robot_called(graph("/a/base"), "c", "DDS")


def test_without_a_robot_the_nodes_and_the_options_are_named() -> None:
    with pytest.raises(NoRobotError, match=r"the nodes there: /rviz; start one, .*--domain"):
        robot_called(graph(), None, "DDS")
    with pytest.raises(NoRobotError, match="no robot is on DDS: no node publishes"):
        robot_called(Graph(), None, "DDS")
