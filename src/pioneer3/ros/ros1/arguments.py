"""The arguments of programs of ROS 1: names, remappings, private parameters and addresses.

As `__name:=front`, `~cmd_vel:=/teleop/cmd_vel` or `_port:=/dev/ttyS0`
(http://wiki.ros.org/Names, http://wiki.ros.org/Remapping%20Arguments).
"""

import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import yaml

from pioneer3.errors import ConfigError

ASSIGN: Final = ":="
PRIVATE: Final = re.compile(r"_(?!_)(.+)", re.DOTALL)
"""A parameter of the node's own."""
ENVIRONMENT: Final = {
    "__master": "ROS_MASTER_URI",
    "__ip": "ROS_IP",
    "__hostname": "ROS_HOSTNAME",
    "__ns": "ROS_NAMESPACE",
}
"""Arguments that stand for a variable."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Ros1Arguments:
    """The arguments of a node, whose full name they tell.

    Rules of remapping are as somebody has written them; parameters are private ones by their names
    without `~`; the environment has what arguments say in place of variables.
    """

    node: str
    rules: Mapping[str, str]
    parameters: Mapping[str, object]
    environment: Mapping[str, str]

    def full(self, name: str) -> str:
        """Return the full name of what this node calls `name`, before remapping."""
        if name.startswith("/"):
            return _clean(name)
        if name.startswith("~"):
            return _clean(f"{self.node}/{name[1:]}")
        return _clean(f"{self.node.rpartition('/')[0]}/{name}")

    def resolved(self, name: str) -> str:
        """Return the full name after remapping."""
        full = self.full(name)
        final = {self.full(source): self.full(target) for source, target in self.rules.items()}
        return final.get(full, full)


def parse(
    arguments: Sequence[str], name: str, environment: Mapping[str, str] = os.environ
) -> Ros1Arguments:
    """Return the arguments of a node that is called `name` unless they say otherwise.

    Raises:
        ConfigError: one is none of ROS's, or has a wrong value.
    """
    rules: dict[str, str] = {}
    parameters: dict[str, object] = {}
    special: dict[str, str] = {}
    for argument in arguments:
        source, assigned, target = (part.strip() for part in argument.partition(ASSIGN))
        if not assigned:
            raise ConfigError(
                f"{argument!r} is none of ROS's arguments, such as _port:=/dev/ttyS0, and no"
                " command: pioneer3 ros1 --help lists those"
            )
        if not (source and target):
            continue  # as in rospy: a launch file may leave an argument empty
        if private := PRIVATE.fullmatch(source):
            parameters[private[1]] = _value(argument, target)
        elif source.startswith("__"):
            special[source] = target
        else:
            rules[source] = target
    name = special.get("__name") or name
    if not re.fullmatch(r"\w+", name, re.ASCII):
        raise ConfigError(f"{name!r} is no name of a node: it has letters, digits and underscores")
    said = {ENVIRONMENT[key]: value for key, value in special.items() if key in ENVIRONMENT}
    hidden = {"ROS_HOSTNAME"} if "ROS_IP" in said and "ROS_HOSTNAME" not in said else set()
    variables = {key: value for key, value in environment.items() if key not in hidden} | said
    return Ros1Arguments(
        node=_clean(f"/{variables.get('ROS_NAMESPACE', '')}/{name}"),
        rules=rules,
        parameters=parameters,
        environment=variables,
    )


def _value(argument: str, text: str) -> object:
    """Return the value of a parameter as YAML has it."""
    try:
        return yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise ConfigError(f"{argument!r} has a value that is no YAML: {error}") from error


def _clean(name: str) -> str:
    """Return a full name without slashes that do not count."""
    return "/" + "/".join(filter(None, name.split("/")))
