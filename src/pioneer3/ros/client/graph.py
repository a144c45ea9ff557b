"""Finds the robots in a ROS graph by the topics that nodes publish and subscribe to. Pure."""

import re
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Final

from pioneer3.errors import ConfigError, NoRobotError
from pioneer3.ros.node.names import NODE

ODOMETRY: Final = "nav_msgs/Odometry"
TWIST: Final = "geometry_msgs/Twist"
STAMPED: Final = "geometry_msgs/TwistStamped"

State = Iterable[tuple[str, Iterable[str]]]
"""Topics with the nodes that publish or subscribe to them, as in a master's system state."""


@dataclass(slots=True)
class NodeTopics:
    """The topics of a node with their types; `nodes` is the number of nodes of its name."""

    published: dict[str, str] = field(default_factory=dict)
    heard: dict[str, str] = field(default_factory=dict)
    nodes: int = 1


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotTopics:
    """The topics of a node that publishes odometry and subscribes to velocity commands.

    This robot alone subscribes to `commands`, if there is such a topic; their type is
    :data:`TWIST`, or :data:`STAMPED` where there is none of Twist. Topics that it publishes have
    their types; several `nodes` of its name would all be driven.
    """

    node: str
    pose: str
    commands: str
    command_type: str = TWIST
    published: Mapping[str, str] = field(default_factory=dict)
    nodes: int = 1

    @property
    def unclear(self) -> str:
        """Why reports and commands of this name are not those of one robot; or nothing."""
        if self.nodes == 1:
            return ""
        return (
            f"{self.nodes} nodes are called {self.node}: what is for one of them drives all. Give"
            " each robot a --namespace; a node that was killed is gone after 10 s"
        )

    @property
    def name(self) -> str:
        """The node's name without the first slash."""
        return self.node.removeprefix("/")

    @property
    def names(self) -> set[str]:
        """All its names: in the lab, the node's name without `RosAria_`, too."""
        space, _, last = self.name.rpartition("/")
        return {self.node, self.name, last, last.removeprefix(f"{NODE}_"), space} - {""}

    @property
    def emergency_stop(self) -> str | None:
        """Topic on which it tells whether an emergency stop holds it, or `None`."""
        return self.topic("std_msgs/Bool", "emergency_stop")

    def topic(self, kind: str, ending: str = "") -> str | None:
        """Return its topic of this type whose name ends so, or `None`."""
        of_kind = (name for name, type_ in self.published.items() if type_ == kind)
        return min((name for name in of_kind if name.endswith(ending)), default=None, key=len)

    def numbered(self, kind: str) -> dict[int, str]:
        """Return its topics of this type that end in a number, such as `sonar/range_0`."""
        return {
            int(match[1]): name
            for name, type_ in self.published.items()
            if type_ == kind and (match := re.search(r"_(\d+)$", name))
        }


def robots_on(publishers: State, subscribers: State, types: Mapping[str, str]) -> list[RobotTopics]:
    """Return the robots on a master, where each topic has one type, sorted by name."""
    nodes: dict[str, NodeTopics] = defaultdict(NodeTopics)
    for state, kind in ((publishers, "published"), (subscribers, "heard")):
        for topic, names in state:
            for name in names:
                getattr(nodes[name], kind)[topic] = types.get(topic, "")
    return robots_among(nodes)


def robots_among(nodes: Mapping[str, NodeTopics]) -> list[RobotTopics]:
    """Return the robots among nodes, which are given by their full names, sorted by name."""
    listeners = Counter(topic for node in nodes.values() for topic in node.heard)
    robots = []
    for name, node in sorted(nodes.items()):
        poses = sorted(topic for topic, kind in node.published.items() if kind == ODOMETRY)
        kind = TWIST if TWIST in node.heard.values() else STAMPED
        commands = [topic for topic, its_kind in node.heard.items() if its_kind == kind]
        if poses and commands:
            published = {topic: kind for topic, kind in sorted(node.published.items()) if kind}
            robots.append(
                RobotTopics(
                    node=name,
                    pose=poses[0],
                    commands=min(commands, key=partial(_preference, name, listeners)),
                    command_type=kind,
                    published=published,
                    nodes=node.nodes,
                )
            )
    return robots


def chosen(robots: Iterable[RobotTopics], name: str | None) -> RobotTopics:
    """Return the robot of this name, or the only one.

    Raises:
        NoRobotError: there is none, or none called so; the message says which there are.
        ConfigError: it is not clear which one is meant.
    """
    robot = _called(list(robots), name)
    if robot.unclear:
        raise ConfigError(robot.unclear)
    return robot


def wanted(
    robots: Sequence[RobotTopics], names: Sequence[str], *, several: bool
) -> list[RobotTopics]:
    """Return the robots of these names; without any the only one, or with `several` all.

    Raises:
        ConfigError, NoRobotError: see :func:`chosen`.
    """
    if names:
        return [chosen(robots, name) for name in names]
    return list(robots) if several and robots else [chosen(robots, None)]


def _called(known: Sequence[RobotTopics], wanted: str | None) -> RobotTopics:
    if not known:
        raise NoRobotError(
            "there is no robot on this ROS graph: start its node, as with"
            " `pioneer3 ros1 --port URL` or `pioneer3 ros2 --port URL`"
        )
    there_are = ", ".join(robot.name for robot in known)
    if wanted is None:
        if len(known) > 1:
            raise ConfigError(f"there are several robots: say which with --robot; {there_are}")
        return known[0]
    exact = [robot for robot in known if wanted in {robot.node, robot.name}]
    called = exact or [robot for robot in known if wanted in robot.names]
    if not called:
        raise NoRobotError(f"no robot is called {wanted!r} on this ROS graph, but {there_are}")
    if len(called) > 1:
        names = ", ".join(robot.name for robot in called)
        raise ConfigError(f"several robots are called {wanted!r}: {names}")
    return called[0]


def _preference(node: str, listeners: Mapping[str, int], topic: str) -> tuple[int, bool, str]:
    """Return a key that is least for the topic with the fewest other subscribers."""
    return listeners[topic], not topic.startswith(f"{node}/"), topic
