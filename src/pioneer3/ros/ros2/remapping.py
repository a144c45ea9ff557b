"""Remapping rules of ROS 2: `node:rostopic://match:=replacement`.

The syntax is that of https://design.ros2.org/articles/static_remapping.html, with its wildcards,
which rcl refuses ("not implemented" in 10.1).
"""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum
from typing import Final

from pioneer3.errors import ConfigError
from pioneer3.ros.ros2.backend import NodeName
from pioneer3.ros.ros2.names import PART, expanded

TOKEN: Final = r"(?:[A-Za-z_]\w*|\{(?:node|ns|namespace)\}|\*\*?|~|\\[1-9])"
RULE: Final = re.compile(
    rf"(?:(?P<node>{PART.pattern}):(?!//))?(?:(?P<scheme>rostopic|rosservice)://)?"
    rf"(?P<match>/?{TOKEN}(?:/{TOKEN})*)",
    re.ASCII,
)
REPLACEMENT: Final = re.compile(rf"/?{TOKEN}(?:/{TOKEN})*", re.ASCII)
NODE: Final = {"__node", "__name"}
NAMESPACE: Final = "__ns"
WILDCARDS: Final = {"*": r"(\w+)", "**": r"((?:/?\w+(?:/\w+)*)?)"}


class Resource(StrEnum):
    """The kinds of names that are remapped."""

    TOPIC = "rostopic"
    SERVICE = "rosservice"


@dataclass(frozen=True, slots=True)
class Remapping:
    r"""A remapping rule: topics and services called `source` are called `target` instead.

    `*` in the source is a part, `**` are several; `\1` in the target is the text at the first of
    them. A `resource` of `None` stands for topics and services.
    """

    source: str
    target: str
    resource: Resource | None = None


@dataclass(frozen=True, slots=True)
class RemapRule:
    """A rule of the command line; its owner is the name of a node, or empty for all nodes."""

    owner: str
    remapping: Remapping

    @property
    def sets(self) -> str:
        """`__node` or `__ns` where the rule sets the name or namespace of a node; else empty."""
        if self.remapping.source in NODE:
            return "__node"
        return NAMESPACE if self.remapping.source == NAMESPACE else ""


def rule(source: str, target: str) -> RemapRule:
    """Return the rule `source:=target`; ConfigError if ROS 2 has no such rule."""
    found = RULE.fullmatch(source)
    if not found or found["node"] in set(Resource):
        raise ConfigError(
            f"-r {source}:={target}: {source!r} is no name that can be remapped: give it such as"
            " cmd_vel, ~/x, node:cmd_vel or rostopic://cmd_vel"
        )
    resource = Resource(found["scheme"]) if found["scheme"] else None
    made = RemapRule(found["node"] or "", Remapping(found["match"], target, resource))
    if not made.sets and not REPLACEMENT.fullmatch(target):
        raise ConfigError(f"-r {source}:={target}: {target!r} is no name of a topic or service")
    if not target:
        raise ConfigError(f"-r {source}:=: the new name is missing")
    return made


def resolved(
    name: str, node: NodeName, rules: Iterable[Remapping], resource: Resource = Resource.TOPIC
) -> str:
    """Return the full name after remapping; the first rule that fits counts."""
    full = expanded(name, node)
    for each in rules:
        if each.resource in {None, resource} and (found := _pattern(each, node).fullmatch(full)):
            return _replaced(each.target, found, node)
    return full


def _pattern(remapping: Remapping, node: NodeName) -> re.Pattern[str]:
    source = remapping.source
    source = source if source.startswith("*") else expanded(source, node)
    parts = [WILDCARDS.get(part, re.escape(part)) for part in source.split("/")]
    if source.startswith("*") and not source.startswith("**"):
        parts[0] = f"/{parts[0]}"
    return re.compile("/".join(parts), re.ASCII)


def _replaced(target: str, found: re.Match[str], node: NodeName) -> str:
    groups = found.groups()

    def text(mark: re.Match[str]) -> str:
        number = int(mark[1])
        return (groups[number - 1] or "") if number <= len(groups) else ""

    name = re.sub(r"\\([1-9])", text, target)
    return expanded(re.sub(r"/+", "/", name), node)
