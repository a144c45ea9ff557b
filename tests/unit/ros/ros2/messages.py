"""The message types of the node, and random messages of each."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from hypothesis import strategies as st

from pioneer3.models import load_model
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.topics import topics_of

INTEGERS: Mapping[str, tuple[int, int]] = {
    **{f"int{bits}": (-(1 << bits - 1), (1 << bits - 1) - 1) for bits in (8, 16, 32, 64)},
    **{f"uint{bits}": (0, (1 << bits) - 1) for bits in (8, 16, 32, 64)},
    "byte": (0, 127),  # rosbags takes a single one as signed; ROS has no larger ones here
    "char": (0, 255),
}
ELSEWHERE = (
    "lifecycle_msgs/TransitionEvent",
    "nav_msgs/OccupancyGrid",
    "nav_msgs/Path",
    "rcl_interfaces/Log",
    "rcl_interfaces/ParameterEvent",
    "rmw_dds_common/ParticipantEntitiesInfo",
    "rosgraph_msgs/Clock",
    "std_msgs/Empty",
)
"""Types that are not in the table of topics."""


def type_names() -> tuple[str, ...]:
    """Return the types of all messages that nodes send or receive: `nav_msgs/Odometry`."""
    table = topics_of(load_model("p3at-sh"))
    return tuple(sorted({*(t.type_name for t in table if t.names(Profile.ROS2)), *ELSEWHERE}))


@dataclass(frozen=True)
class Nested:
    """Values of the fields of a message, by name."""

    type_name: str
    fields: dict[str, object]


def values(type_name: str, fields: Mapping[str, Any]) -> st.SearchStrategy[Nested]:
    """Return messages of a type.

    Args:
        type_name: Such as `nav_msgs/msg/Odometry`.
        fields: Fields of each type, as rosbags has them.
    """
    own = {name: _value(kind, what, fields) for name, (kind, what) in fields[type_name][1]}
    return st.fixed_dictionaries(own).map(lambda chosen: Nested(type_name, chosen))


def _value(kind: int, what: Any, fields: Mapping[str, Any]) -> st.SearchStrategy[Any]:
    if kind == 1:
        name, _ = what
        if name == "string":
            return st.text(st.characters(exclude_characters="\0", codec="utf-8"), max_size=8)
        if name == "bool":
            return st.booleans()
        if name.startswith("float"):
            return st.floats(width=32 if name == "float32" else 64)
        return st.integers(*INTEGERS[name])
    if kind == 2:
        return values(str(what), fields)
    (inner, base), length = what
    least, most = (length, length) if kind == 3 else (0, min(length or 4, 4))
    return st.lists(_value(inner, base, fields), min_size=least, max_size=most)


def put(value: object, make: Callable[[str], Any]) -> object:
    """Return a value with messages of the project's own codec, arrays as lists."""
    match value:
        case Nested(type_name, fields):
            message = make(type_name)
            for name, content in fields.items():
                setattr(message, name, put(content, make))
            return message
        case list():
            return [put(each, make) for each in value]
        case _:
            return value


def for_rosbags(value: Nested, store: Any) -> Any:
    """Return a message for rosbags alone, arrays as it wants them."""
    return store.types[value.type_name](
        **{
            name: _field(value.fields[name], desc, store)
            for name, desc in store.fielddefs[value.type_name][1]
        }
    )


def _field(value: Any, desc: Any, store: Any) -> object:
    kind, what = desc
    if kind == 1:
        return value
    if kind == 2:
        return for_rosbags(value, store)
    (inner, base), _ = what
    if inner == 2:
        return [for_rosbags(each, store) for each in value]
    if base[0] == "string":
        return value
    return np.array(value, {"byte": "uint8", "char": "uint8"}.get(base[0], base[0]))


def leaves(message: Any) -> Iterator[object]:
    """Yield all values in a message, arrays as bytes."""
    for name in message.__dataclass_fields__:
        if name == "__msgtype__":
            continue
        value = getattr(message, name)
        if hasattr(value, "__dataclass_fields__"):
            yield from leaves(value)
        elif isinstance(value, np.ndarray):
            yield value.tobytes()
        elif isinstance(value, list):
            for each in value:
                if hasattr(each, "__dataclass_fields__"):
                    yield from leaves(each)
                else:
                    yield each
        else:
            yield repr(value)
