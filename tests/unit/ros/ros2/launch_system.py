"""A stand-in of launch, launch_ros and nav2_common, as strict about arguments as they are.

The names and signatures are those of https://docs.ros.org/en/jazzy/p/launch/ and
https://docs.ros.org/en/jazzy/p/launch_ros/; :func:`launched` runs a launch file, and returns its
nodes and the files of other packages that it includes.
"""

import runpy
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
import yaml

MISSING = object()
INSTALLED = ("nav2_bringup", "slam_toolbox")


@dataclass
class LaunchContext:
    launch_configurations: dict[str, str] = field(default_factory=dict)
    nodes: list["Node"] = field(default_factory=list)
    included: list[tuple[str, dict[str, Any]]] = field(default_factory=list)
    namespaces: list[str] = field(default_factory=list)
    remaps: list[tuple[str, str]] = field(default_factory=list)


class Substitution:
    def perform(self, context: LaunchContext) -> str:
        raise NotImplementedError


class LaunchConfiguration(Substitution):
    def __init__(self, variable_name: str, *, default: str | None = None) -> None:
        self.variable_name, self.default = variable_name, default

    def perform(self, context: LaunchContext) -> str:
        if self.variable_name not in context.launch_configurations and self.default is None:
            raise LookupError(f"launch configuration {self.variable_name!r} does not exist")
        return context.launch_configurations.get(self.variable_name, self.default or "")


class ReplaceString(Substitution):
    def __init__(
        self, source_file: Any, replacements: dict[str, Any], condition: Any = None
    ) -> None:
        self.source_file, self.replacements = source_file, replacements

    def perform(self, context: LaunchContext) -> str:
        text = Path(text_of(self.source_file, context)).read_text("utf-8")
        for before, after in self.replacements.items():
            text = text.replace(before, text_of(after, context))
        return text


class ParameterValue:
    """A value of this type already, or a substitution, which becomes one; nothing else."""

    def __init__(self, value: Any, *, value_type: type | None = None) -> None:
        if value_type is not None and not isinstance(value, value_type | Substitution):
            raise TypeError(f"{value!r} is not of {value_type}, and no substitution")
        self.value, self.value_type = value, value_type

    def evaluate(self, context: LaunchContext) -> Any:
        """Return the value, which is written as in YAML unless it is to be a text."""
        if not isinstance(self.value, Substitution):
            return self.value
        text = self.value.perform(context)
        read = text if self.value_type is str else yaml.safe_load(text)
        if self.value_type is not None and not isinstance(read, self.value_type):
            raise ValueError(f"{text!r} cannot be converted to {self.value_type}")
        return read


def text_of(value: Any, context: LaunchContext) -> str:
    if isinstance(value, str):
        return value
    if isinstance(value, Substitution):
        return value.perform(context)
    assert isinstance(value, Iterable), f"{value!r} is no substitution"
    return "".join(text_of(part, context) for part in value)


class LaunchDescription:
    def __init__(self, initial_entities: Sequence[Any] | None = None) -> None:
        self.entities = list(initial_entities or ())


class Action:
    def execute(self, context: LaunchContext) -> None:
        raise NotImplementedError


class DeclareLaunchArgument(Action):
    def __init__(
        self,
        name: str,
        *,
        default_value: Any = MISSING,
        description: str | None = None,
        choices: list[str] | None = None,
        condition: Any = None,
    ) -> None:
        self.name, self.default, self.choices = name, default_value, choices

    def execute(self, context: LaunchContext) -> None:
        values = context.launch_configurations
        if self.name not in values:
            if self.default is MISSING:
                raise LookupError(f"the argument {self.name!r} is required")
            values[self.name] = text_of(self.default, context)
        assert self.choices is None or values[self.name] in self.choices


class OpaqueFunction(Action):
    def __init__(
        self,
        *,
        function: Callable[..., list[Any] | None],
        args: Iterable[Any] | None = None,
        kwargs: Mapping[str, Any] | None = None,
        condition: Any = None,
    ) -> None:
        self.function, self.args, self.kwargs = function, args or (), kwargs or {}

    def execute(self, context: LaunchContext) -> None:
        visit(self.function(context, *self.args, **self.kwargs) or [], context)


class PythonLaunchDescriptionSource:
    def __init__(self, launch_file_path: Any) -> None:
        self.path = launch_file_path


class IncludeLaunchDescription(Action):
    def __init__(
        self,
        launch_description_source: PythonLaunchDescriptionSource,
        *,
        launch_arguments: Iterable[tuple[str, Any]] | None = None,
        condition: Any = None,
    ) -> None:
        assert isinstance(launch_description_source, PythonLaunchDescriptionSource)
        self.source, self.arguments = launch_description_source, launch_arguments or ()

    def execute(self, context: LaunchContext) -> None:
        path = text_of(self.source.path, context)
        given = {name: text_of(value, context) for name, value in self.arguments}
        context.launch_configurations.update(given)
        if path.startswith("/installed/"):
            context.included.append((path.removeprefix("/installed/"), given))
        else:
            visit(described(Path(path)).entities, context)


class GroupAction(Action):
    def __init__(
        self,
        actions: Iterable[Any],
        *,
        scoped: bool = True,
        forwarding: bool = True,
        launch_configurations: Mapping[str, Any] | None = None,
        condition: Any = None,
    ) -> None:
        self.actions = list(actions)

    def execute(self, context: LaunchContext) -> None:
        visit(self.actions, context)


class PushROSNamespace(Action):
    def __init__(self, namespace: Any, *, condition: Any = None) -> None:
        self.namespace = namespace

    def execute(self, context: LaunchContext) -> None:
        context.namespaces.append(text_of(self.namespace, context))


class SetRemap(Action):
    def __init__(self, src: Any, dst: Any, *, condition: Any = None) -> None:
        self.rule = (src, dst)

    def execute(self, context: LaunchContext) -> None:
        context.remaps.append(self.rule)


class Node(Action):
    """Arguments of launch_ros's Node, and those of launch's ExecuteProcess that make sense."""

    def __init__(
        self,
        *,
        executable: Any,
        package: Any = None,
        name: Any = None,
        namespace: Any = None,
        exec_name: Any = None,
        parameters: list[Any] | None = None,
        remappings: Iterable[tuple[Any, Any]] | None = None,
        ros_arguments: Iterable[Any] | None = None,
        arguments: Iterable[Any] | None = None,
        output: str = "log",
        emulate_tty: bool = False,
        respawn: bool = False,
        respawn_delay: float | None = None,
        condition: Any = None,
    ) -> None:
        assert isinstance(respawn, bool)
        self.package, self.executable, self.name = package, executable, name
        self.namespace, self.respawn = namespace, respawn
        self.arguments, self.parameters = list(arguments or ()), list(parameters or ())
        self.remappings = list(remappings or ())
        self.values: dict[str, Any] = {}

    def execute(self, context: LaunchContext) -> None:
        self.namespace = text_of(self.namespace or "", context)
        self.arguments = [text_of(each, context) for each in self.arguments]
        self.remappings = [(text_of(a, context), text_of(b, context)) for a, b in self.remappings]
        for given in self.parameters:
            if isinstance(given, dict):
                self.values |= {name: _value(each, context) for name, each in given.items()}
            else:
                assert Path(text_of(given, context)).is_file()
        context.nodes.append(self)


def _value(value: Any, context: LaunchContext) -> Any:
    if not isinstance(value, ParameterValue):
        value = ParameterValue(value)
    return value.evaluate(context)


def visit(entities: Iterable[Any], context: LaunchContext) -> None:
    for entity in entities:
        assert isinstance(entity, Action), f"{entity!r} cannot be launched"
        entity.execute(context)


def described(path: Path) -> LaunchDescription:
    description = runpy.run_path(str(path))["generate_launch_description"]()
    assert isinstance(description, LaunchDescription)
    return description


def launched(path: Path, **arguments: str) -> LaunchContext:
    """Run a launch file with these arguments, as `ros2 launch` does."""
    context = LaunchContext(dict(arguments))
    entities = described(path).entities
    declared = {each.name for each in entities if isinstance(each, DeclareLaunchArgument)}
    assert set(arguments) <= declared
    visit(entities, context)
    return context


def install(monkeypatch: pytest.MonkeyPatch, share: Path, *, humble: bool = False) -> None:
    """Put the stand-ins in the place of the modules; `pioneer3` is installed at `share`."""

    def share_of(package_name: str, print_warning: bool = True) -> str:
        assert package_name in (*INSTALLED, "pioneer3")
        return str(share) if package_name == "pioneer3" else f"/installed/{package_name}"

    namespace = "PushRosNamespace" if humble else "PushROSNamespace"
    modules: dict[str, dict[str, object]] = {
        "launch": {"LaunchContext": LaunchContext, "LaunchDescription": LaunchDescription},
        "launch.actions": {
            each.__name__: each
            for each in (
                DeclareLaunchArgument,
                GroupAction,
                IncludeLaunchDescription,
                OpaqueFunction,
            )
        },
        "launch.launch_description_sources": {
            "PythonLaunchDescriptionSource": PythonLaunchDescriptionSource
        },
        "launch.substitutions": {"LaunchConfiguration": LaunchConfiguration},
        "launch_ros": {},
        "launch_ros.actions": {"Node": Node, "SetRemap": SetRemap, namespace: PushROSNamespace},
        "launch_ros.parameter_descriptions": {"ParameterValue": ParameterValue},
        "nav2_common": {},
        "nav2_common.launch": {"ReplaceString": ReplaceString},
        "ament_index_python": {},
        "ament_index_python.packages": {"get_package_share_directory": share_of},
    }
    for name, contents in modules.items():
        module = ModuleType(name)
        vars(module).update(contents)
        monkeypatch.setitem(sys.modules, name, module)
