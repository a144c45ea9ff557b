"""The arguments of ROS 2: `--ros-args -r cmd_vel:=teleop/cmd_vel -p port:=/dev/ttyUSB0`."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from pioneer3.errors import ConfigError
from pioneer3.ros.node.parameters import BELOW_NAMES
from pioneer3.ros.ros2.backend import NodeName
from pioneer3.ros.ros2.parameter_files import parameters_in, value_of
from pioneer3.ros.ros2.remapping import Remapping, RemapRule, rule

IGNORED: Final = {
    **dict.fromkeys(("--log-level", "--log-file-name", "--log-config-file", "--enclave", "-e"), 1),
    **dict.fromkeys(("--enable-stdout-logs", "--disable-stdout-logs"), 0),
    **dict.fromkeys(("--enable-rosout-logs", "--disable-rosout-logs"), 0),
    **dict.fromkeys(("--enable-external-lib-logs", "--disable-external-lib-logs"), 0),
}
"""Arguments that change nothing here, and the number of values that each takes."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RosArguments:
    """The arguments of one node; in names of parameters parts are joined by dots."""

    name: str | None = None
    namespace: str | None = None
    rules: tuple[Remapping, ...] = ()
    parameters: Mapping[str, object] = field(default_factory=dict)

    @property
    def raw(self) -> dict[str, object]:
        """The parameters as a node reads them: those of a laser, say, in a part of their own."""
        found: dict[str, object] = {}
        parts: dict[str, dict[str, object]] = {}
        for name, value in self.parameters.items():
            first, dot, rest = name.partition(".")
            if dot and first in BELOW_NAMES:
                parts.setdefault(first, {})[rest] = value
            elif first != "qos_overrides":
                found[name] = value
        return {**found, **parts}


def parse(arguments: Sequence[str], default: NodeName) -> RosArguments:
    """Return the meaning of the words after `--ros-args`; a name in them counts before the default.

    Raises:
        ConfigError: a word is none of ROS 2's, or a file cannot be read.
    """
    rules, values, files = _sorted(iter(arguments))
    name = _first(rules, "__node", default.name)
    namespace = _first(rules, "__ns", name or default.name)
    node = NodeName(name or default.name, namespace or default.namespace)
    kept = tuple(
        each.remapping for each in rules if not each.sets and each.owner in {"", node.name}
    )
    parameters: dict[str, object] = {}
    for file in files:
        parameters |= parameters_in(file, node)
    for target, value in values:
        owner, colon, plain = target.rpartition(":")
        if not colon or owner in {node.name, node.full}:
            parameters[plain] = value_of(target, value)
    # `ros2 param dump` writes null for a parameter without a value
    given = {name: value for name, value in parameters.items() if value is not None}
    return RosArguments(name=name, namespace=namespace, rules=kept, parameters=given)


def _first(rules: Sequence[RemapRule], sets: str, node: str) -> str | None:
    """Return the name that the first rule for `node` sets; `None` for no rule."""
    found = (each for each in rules if each.sets == sets and each.owner in {"", node})
    return next((each.remapping.target for each in found), None)


def _sorted(words: Iterator[str]) -> tuple[list[RemapRule], list[tuple[str, str]], list[Path]]:
    """Return the remapping rules, the parameters and their files."""
    rules, values, files = list[RemapRule](), list[tuple[str, str]](), list[Path]()
    for word in words:
        option, equals, _ = word.partition("=")
        if word in {"-r", "--remap"}:
            rules.append(rule(*_assignment(word, _value(word, words))))
        elif word in {"-p", "--param"}:
            values.append(_assignment(word, _value(word, words)))
        elif word == "--params-file":
            files.append(Path(_value(word, words)))
        elif word in IGNORED:
            for _ in range(IGNORED[word]):
                _value(word, words)
        elif equals and IGNORED.get(option):
            continue
        elif word not in {"--ros-args", "--"}:
            raise ConfigError(
                f"{word!r} is none of ROS 2's arguments here: --ros-args -r FROM:=TO"
                " -p NAME:=VALUE --params-file FILE"
            )
    return rules, values, files


def _value(option: str, words: Iterator[str]) -> str:
    """Return the word after an option."""
    if word := next(words, ""):
        return word
    raise ConfigError(f"{option}: its value is missing")


def _assignment(option: str, word: str) -> tuple[str, str]:
    name, mark, value = word.partition(":=")
    if not mark or not name:
        raise ConfigError(f"{option} {word}: give NAME:=VALUE, such as cmd_vel:=teleop/cmd_vel")
    return name, value
