"""Messages of a type system of rosbags, that of ROS 1 or one of ROS 2: empty ones to fill."""

from collections.abc import Callable, Mapping
from functools import lru_cache, partial
from keyword import iskeyword
from typing import Any, Final

import numpy as np

BASE = 1
"""Kind of a field of a base type in rosbags' definitions (`Nodetype`); kinds not here are
sequences."""
NAME = 2
"""Kind of a field of a named type."""
ARRAY = 3
"""Kind of a field that is an array."""
DTYPES: Final[Mapping[str, str]] = {"byte": "uint8", "char": "uint8"}
"""Types of numpy where they have other names."""
ZEROS: Final[Mapping[str, object]] = {"bool": False, "float32": 0.0, "float64": 0.0, "string": ""}
"""Empty values of base types; of all others 0."""


class MessageStore:
    """Message types and their definitions, in a store of rosbags."""

    def __init__(self, store: Any) -> None:
        self._store = store
        self._makers: dict[str, Callable[[], Any]] = {}

    @property
    def fields(self) -> Mapping[str, Any]:
        """Fields of each type, as rosbags has them: `(constants, [(name, kind), ...])`."""
        fields: Mapping[str, Any] = self._store.fielddefs
        return fields

    def make(self, name: str) -> Any:
        """Return an empty message of a type such as `nav_msgs/Odometry`."""
        if name not in self._makers:
            self._makers[name] = self._maker(full_name(name))
        return self._makers[name]()

    def filled(self, name: str, values: object) -> Any:
        """Return a message of a type with the fields that an object has, or that message itself."""
        full = full_name(name)
        if getattr(values, "__msgtype__", "") == full:
            return values
        message = self.make(full)
        for field, _ in self.fields[full][1]:
            if hasattr(values, field):
                setattr(message, field, getattr(values, field))
        return message

    def _maker(self, name: str) -> Callable[[], Any]:
        kind, descs = self._store.types[name], [each for _, each in self._store.fielddefs[name][1]]
        fields = [self._empty(desc) for desc in descs]
        if all(inner == BASE for inner, _ in descs):
            return partial(kind, *[make() for make in fields])
        return lambda: kind(*[make() for make in fields])

    def _empty(self, desc: Any) -> Callable[[], Any]:
        """Return the function that makes the empty value of a field."""
        kind, what = desc
        if kind == BASE:
            value: Any = ZEROS.get(what[0], 0)
            return lambda: value
        if kind == NAME:
            return self._maker(str(what))
        (inner, base), length = what
        if inner == BASE and base[0] != "string":
            dtype = np.dtype(DTYPES.get(base[0], base[0]))
            return lambda: np.zeros(length if kind == ARRAY else 0, dtype)
        if kind == ARRAY:
            each = self._empty((inner, base))
            return lambda: [each() for _ in range(length)]
        return list


@lru_cache
def full_name(name: str, kind: str = "msg") -> str:
    """Return `nav_msgs/msg/Odometry` for `nav_msgs/Odometry`."""
    package, *between, last = name.split("/")
    return "/".join((package, *(between or [kind]), last))


def python_name(field: str) -> str:
    """Return the name that rosbags' classes have for a field."""
    return f"{field}_" if iskeyword(field) else field
