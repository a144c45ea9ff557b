"""The generated classes of messages and services, if their definitions are those known here.

Messages go through rclpy as bytes, so another definition would be read as other values.
"""

import threading
from collections.abc import Mapping
from importlib import import_module
from typing import Any, Final

from pioneer3.errors import ConfigError, MissingTypeError
from pioneer3.ros.encoding import NO_FIELD
from pioneer3.ros.ros2.backend import ServiceType
from pioneer3.ros.ros2.types import MessageTypes
from pioneer3.ros.typestore import ARRAY, BASE, NAME

IDL_NAMES: Final[Mapping[str, str]] = {
    "bool": "boolean",
    "byte": "octet",
    "char": "uint8",
    "float32": "float",
    "float64": "double",
}
"""Types in `get_fields_and_field_types()` of generated classes, where the names are others."""


class Definitions:
    """The generated classes for types that are known here; any thread may ask for them."""

    def __init__(self, types: MessageTypes) -> None:
        self._types = types
        self._checked: set[str] = set()
        self._lock = threading.Lock()

    def message(self, name: str) -> Any:
        """Return the class of a type; ConfigError if ROS has no such type, or another one."""
        kind = self._generated(name)
        with self._lock:
            self._check(name, kind)
        return kind

    def service(self, type_: ServiceType) -> Any:
        """Return the class of a type of services; ConfigError if ROS has none, or another one."""
        kind = self._generated(type_.name)
        with self._lock:
            self._check(type_.request.name, kind.Request)
            self._check(type_.response.name, kind.Response)
        return kind

    def _check(self, name: str, kind: Any) -> None:
        if name in self._checked:
            return
        fields = [each for each in self._types.fields[name][1] if each[0] != NO_FIELD]
        known = [(field, field_type(*desc)) for field, desc in fields]
        installed = list(kind.get_fields_and_field_types().items())
        if installed != known:
            differing = dict(sorted(set(installed) ^ set(known))) or "the order of fields"
            raise ConfigError(
                f"{name} of the ROS installed here is not that of ROS 2"
                f" {self._types.distro.name}: {differing}"
            )
        for _, (nodetype, what) in fields:
            inner, inside = (nodetype, what) if nodetype in {BASE, NAME} else what[0]
            if inner == NAME:
                self._check(str(inside), self._generated(str(inside)))
        self._checked.add(name)

    def _generated(self, name: str) -> Any:
        package, kind, last = name.split("/")
        try:
            return getattr(import_module(f"{package}.{kind}"), last)
        except (ImportError, AttributeError) as error:
            debian = f"ros-{self._types.distro.name}-{package.replace('_', '-')}"
            raise MissingTypeError(
                f"the ROS installed here has no {name}: install its package {package} ({debian})"
            ) from error


def field_type(nodetype: int, what: Any) -> str:
    """Return a field's type as in generated classes, such as `sequence<string>` or `double[36]`."""
    if nodetype == BASE:
        base, limit = what
        return f"{IDL_NAMES.get(base, base)}<{limit}>" if limit else IDL_NAMES.get(base, base)
    if nodetype == NAME:
        package, *_, name = str(what).split("/")
        return f"{package}/{name}"
    inner, length = what
    each = field_type(*inner)
    if nodetype == ARRAY:
        return f"{each}[{length}]"
    return f"sequence<{each}, {length}>" if length else f"sequence<{each}>"
