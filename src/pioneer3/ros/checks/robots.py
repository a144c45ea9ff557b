"""Finds the robot to check in a graph: by its name, its namespace, or as the only one. Pure."""

from typing import Final

from pioneer3.errors import ConfigError, NoNodeError
from pioneer3.names import printable
from pioneer3.ros.ros2.backend import EndpointKind, Graph, NodeName
from pioneer3.ros.ros2.mismatches import TWISTS

ODOMETRY: Final = "nav_msgs/msg/Odometry"
ODOM: Final = "odom"
HOW: Final = (
    "start one, as with pioneer3 ros2 --port URL; or is it elsewhere: --backend, --domain,"
    " --interface, --connect, --distro?"
)


def robots_in(graph: Graph) -> list[str]:
    """Return the nodes that take velocity commands and publish odometry, of whatever type."""
    drives, tells = set(), set()
    for each in graph.endpoints:
        if each.kind is EndpointKind.SUBSCRIBER and each.type_name in TWISTS:
            drives.add(each.node)
        if each.kind is EndpointKind.PUBLISHER and (
            each.type_name == ODOMETRY or each.name.rpartition("/")[2] == ODOM
        ):
            tells.add(each.node)
    return sorted((drives & tells) - {""})


def robot_called(graph: Graph, name: str | None, where: str) -> NodeName:
    """Return the node of the robot on a network called `where`, or of the only one.

    `name` is the full or last name of its node, or its namespace.

    Raises:
        NoNodeError: there is none; the message says which there are.
        ConfigError: there are several.
    """
    robots = robots_in(graph)
    nodes = sorted({*graph.nodes, *(each.node for each in graph.endpoints)} - {""})
    if name is None:
        if not robots:
            there = f"; the nodes there: {_listed(nodes)}" if nodes else ""
            raise NoNodeError(
                f"no robot is on {where}: no node publishes odometry and takes velocity"
                f" commands{there}; {HOW}"
            )
        found = robots
    else:
        full = f"/{name.strip('/')}"
        below = [each for each in nodes if each.rpartition("/")[0] == full]
        last = [each for each in nodes if each.rpartition("/")[2] == name.strip("/")]
        named = [each for each in nodes if each == full] or below or last
        found = [each for each in named if each in robots] or named
        if not found:
            there_are = _listed(robots or nodes) or "none"
            raise NoNodeError(
                f"no node or namespace is called {name!r} on {where}; there are: {there_are}"
            )
    if len(found) > 1:
        raise ConfigError(f"there are several robots: say which with --robot; {_listed(found)}")
    space, _, last_name = found[0].rpartition("/")
    return NodeName(last_name, space or "/")


def _listed(names: list[str]) -> str:
    return printable(", ".join(names))
