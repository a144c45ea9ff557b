"""Finds the robots in a ROS graph by the topics that nodes publish and subscribe to. Pure."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Final

from pioneer3.errors import ConfigError, NoRobotError
from pioneer3.ros.node.names import NODE

ODOMETRY: Final = "nav_msgs/Odometry"
TWIST: Final = "geometry_msgs/Twist"
LAB_PREFIX: Final = f"{NODE}_"

State = Iterable[tuple[str, Iterable[str]]]
"""Topics with the nodes that publish or subscribe to them, as in a master's system state."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotTopics:
    """The topics of a node that publishes odometry and subscribes to velocity commands.

    Attributes:
        node: Its full name, such as `/RosAria_p3at_1_113`.
        pose: Topic of nav_msgs/Odometry.
        commands: Topic of geometry_msgs/Twist that this robot alone subscribes to, if there is one.
        published: Types of all topics that it publishes, by topic.
    """

    node: str
    pose: str
    commands: str
    published: Mapping[str, str] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """The node's name without the first slash."""
        return self.node.removeprefix("/")

    @property
    def plain_name(self) -> str:
        """The same as a part of other names."""
        return self.name.replace("/", "_")

    @property
    def names(self) -> set[str]:
        """All its names: in the lab, the node's name without `RosAria_`, too."""
        last = self.name.rpartition("/")[2]
        return {self.node, self.name, last, last.removeprefix(LAB_PREFIX)} | {
            space for space in [self.name.rpartition("/")[0]] if space
        }

    def topic(self, kind: str, ending: str = "") -> str | None:
        """Return its topic of this type whose name ends so, or `None`."""
        found = [
            name
            for name, type_ in self.published.items()
            if type_ == kind and name.endswith(ending)
        ]
        return min(found, default=None, key=len)

    def numbered(self, kind: str) -> dict[int, str]:
        """Return its topics of this type that end in a number, such as `sonar/range_0`."""
        return {
            int(match[1]): name
            for name, type_ in self.published.items()
            if type_ == kind and (match := re.search(r"_(\d+)$", name))
        }


def robots_on(publishers: State, subscribers: State, types: Mapping[str, str]) -> list[RobotTopics]:
    """Return the robots, sorted by name."""
    published, heard = _by_node(publishers), _by_node(subscribers)
    listeners = {topic: len(list(nodes)) for topic, nodes in subscribers}
    robots = []
    for node in sorted(published.keys() & heard.keys()):
        poses = sorted(name for name in published[node] if types.get(name) == ODOMETRY)
        commands = [name for name in heard[node] if types.get(name) == TWIST]
        if poses and commands:
            own = min(commands, key=partial(_preference, node, listeners))
            kinds = {name: types[name] for name in sorted(published[node]) if name in types}
            robots.append(RobotTopics(node=node, pose=poses[0], commands=own, published=kinds))
    return robots


def chosen(robots: Iterable[RobotTopics], wanted: str | None) -> RobotTopics:
    """Return the robot called `wanted`, or the only one.

    Raises:
        NoRobotError: there is none, or none called so; the message says which there are.
        ConfigError: it is not clear which one is meant.
    """
    known = list(robots)
    if not known:
        raise NoRobotError(
            "there is no robot on this ROS master: start a node, as with `pioneer3 ros1 --port URL`"
        )
    there_are = ", ".join(robot.name for robot in known)
    if wanted is None:
        if len(known) > 1:
            raise ConfigError(f"there are several robots: say which with --robot; {there_are}")
        return known[0]
    exact = [robot for robot in known if wanted in {robot.node, robot.name}]
    called = exact or [robot for robot in known if wanted in robot.names]
    if not called:
        raise NoRobotError(f"no robot is called {wanted!r} on this ROS master, but {there_are}")
    if len(called) > 1:
        names = ", ".join(robot.name for robot in called)
        raise ConfigError(f"several robots are called {wanted!r}: {names}")
    return called[0]


def _preference(node: str, listeners: Mapping[str, int], topic: str) -> tuple[int, bool, str]:
    """Return a key that is least for the topic with the fewest other subscribers."""
    return listeners[topic], not topic.startswith(f"{node}/"), topic


def _by_node(state: State) -> dict[str, set[str]]:
    nodes: dict[str, set[str]] = {}
    for topic, names in state:
        for name in names:
            nodes.setdefault(name, set()).add(topic)
    return nodes
