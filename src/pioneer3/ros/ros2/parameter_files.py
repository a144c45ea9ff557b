"""Values and files of parameters in YAML, as `rcl_yaml_param_parser` understands it."""

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Final

import yaml

from pioneer3.errors import ConfigError
from pioneer3.ros.ros2.backend import NodeName

INTEGER, FLOAT = "tag:yaml.org,2002:int", "tag:yaml.org,2002:float"
OTHERWISE: Final = {INTEGER, FLOAT, "tag:yaml.org,2002:timestamp"}
"""Types that YAML 1.1 finds in other texts than ROS 2: `3e-1` is a text there, `1:30` is 90."""
PARAMETERS: Final = "ros__parameters"
LEVELS: Final = {"*": r"/\w+", "**": r"(?:/\w+)*"}


class RosLoader(yaml.SafeLoader):
    """Loads YAML without aliases; numbers are those of C."""

    yaml_implicit_resolvers = {  # noqa: RUF012 - not annotated in PyYAML
        first: [(tag, pattern) for tag, pattern in several if tag not in OTHERWISE]
        for first, several in yaml.SafeLoader.yaml_implicit_resolvers.items()
    }

    def compose_node(self, parent: yaml.Node | None, index: int) -> yaml.Node | None:
        """Return the next node; yaml.YAMLError if it is an alias."""
        if self.check_event(yaml.AliasEvent):
            mark = self.get_event().start_mark  # type: ignore[no-untyped-call]
            raise yaml.MarkedYAMLError(problem="ROS 2 takes no aliases (*)", problem_mark=mark)
        return super().compose_node(parent, index)


RosLoader.add_implicit_resolver(
    INTEGER, re.compile(r"[-+]?(?:0[0-7]*|[1-9][0-9]*|0[xX][0-9a-fA-F]+)$"), list("-+0123456789")
)
RosLoader.add_implicit_resolver(
    FLOAT,
    re.compile(
        r"[-+]?(?:(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?|\.(?:inf|Inf|INF))$"
        r"|\.(?:nan|NaN|NAN)$"
    ),
    list("-+.0123456789"),
)


def value_of(name: str, text: str) -> object:
    """Return the value in `-p name:=text`; ConfigError if it is no YAML."""
    return _loaded(text, f"-p {name}:={text}")


def parameters_in(path: Path, node: NodeName) -> dict[str, object]:
    """Return the parameters of `node` in a file, wildcards first; ConfigError for another file."""
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigError(f"--params-file {path}: {error}") from error
    content = _loaded(text, f"--params-file {path}")
    if not isinstance(content, dict):
        raise ConfigError(f"--params-file {path}: it has no nodes: see docs/reference/ros2-node.md")
    fitting = [(name, part) for name, part in _parts(content, path) if fits(name, node)]
    found: dict[str, object] = {}
    for _, part in sorted(fitting, key=lambda row: "*" not in row[0]):
        found |= dict(_flat(part))
    return found


def fits(pattern: str, node: NodeName) -> bool:
    """Return whether the name of a node in a file means `node`: `*` is a part, `**` are several."""
    levels = [LEVELS.get(part, f"/{re.escape(part)}") for part in pattern.strip("/").split("/")]
    return re.fullmatch("".join(levels), node.full, re.ASCII) is not None


def _loaded(text: str, where: str) -> object:
    try:
        return yaml.load(text, RosLoader)
    except (yaml.YAMLError, ValueError) as error:
        raise ConfigError(f"{where}: {error}") from error
    except RecursionError:
        raise ConfigError(f"{where}: it is nested too deeply") from None


def _parts(
    content: Mapping[object, object], path: Path, above: str = ""
) -> Iterator[tuple[str, Mapping[object, object]]]:
    """Yield the name of each node in a file, below namespaces, and its parameters."""
    for key, value in content.items():
        if not isinstance(value, dict):
            raise ConfigError(f"--params-file {path}: {key}: {PARAMETERS} is missing")
        name = f"{above}/{str(key).strip('/')}"
        if PARAMETERS not in value:
            yield from _parts(value, path, name)
            continue
        inner = value[PARAMETERS] or {}
        if not isinstance(inner, dict):
            raise ConfigError(f"--params-file {path}: {key}: {PARAMETERS} holds no names")
        yield name, inner


def _flat(part: Mapping[object, object], above: str = "") -> Iterator[tuple[str, object]]:
    for key, value in part.items():
        name = f"{above}{key}"
        if isinstance(value, dict):
            yield from _flat(value, f"{name}.")
        else:
            yield name, value
