"""Names in ROS 2: namespaces, private names, and names that come from the network."""

import re
from typing import Final

from pioneer3.errors import ConfigError
from pioneer3.ros.ros2.backend import NodeName

PART: Final = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
LONGEST_NODE: Final = 255
"""As `rmw_validate_node_name` has it."""
LONGEST_TOPIC: Final = 247
"""As `rmw_validate_full_topic_name` has it: 255 without prefixes of DDS."""
LONGEST_NAMESPACE: Final = LONGEST_TOPIC - 2
"""As `rmw_validate_namespace` has it: the shortest topic has two characters."""


def node_name(name: str, namespace: str = "/") -> NodeName:
    """Return a node's name; a namespace may lack its first slash; ConfigError for no such name."""
    if not PART.fullmatch(name):
        raise ConfigError(
            f"{name!r} is no name of a node in ROS 2: letters, digits and underscores, no digit"
            " first"
        )
    space = f"/{namespace.removeprefix('/')}"
    if space != "/" and not _is_full(space):
        raise ConfigError(
            f"{namespace!r} is no namespace in ROS 2: parts of letters, digits and underscores, no"
            " digit first, one slash between two, such as /lab/robot1"
        )
    if len(name) > LONGEST_NODE:
        raise ConfigError(f"a node's name has at most {LONGEST_NODE} characters, not {len(name)}")
    if len(space) > LONGEST_NAMESPACE:
        raise ConfigError(
            f"a namespace has at most {LONGEST_NAMESPACE} characters, not {len(space)}"
        )
    return NodeName(name, space)


def expanded(name: str, node: NodeName) -> str:
    """Return the full name of a topic or service: `~/x`, `~x`, `x`, `/x`, `{ns}/x`, `{node}/x`."""
    if "{" in name:
        spaces = dict.fromkeys(("{ns}", "{namespace}"), node.namespace.rstrip("/"))
        for mark, value in {"{node}": node.name, **spaces}.items():
            name = name.replace(mark, value)
    if name.startswith("/"):
        return name
    if name.startswith("~"):
        return f"{node.full}/{name[1:].lstrip('/')}".rstrip("/")
    return f"{node.namespace.rstrip('/')}/{name}"


def checked_topic(name: str) -> str:
    """Return a full name of a topic or service; ConfigError if ROS 2 has no such name."""
    if not _is_full(name):
        raise ConfigError(
            f"{name!r} is no name of a topic in ROS 2: parts of letters, digits and underscores,"
            " such as /robot1/cmd_vel"
        )
    if len(name) > LONGEST_TOPIC:
        raise ConfigError(f"a topic's name has at most {LONGEST_TOPIC} characters, not {len(name)}")
    return name


def _is_full(name: str) -> bool:
    parts = name.removeprefix("/").split("/")
    return name.startswith("/") and all(PART.fullmatch(part) for part in parts)
