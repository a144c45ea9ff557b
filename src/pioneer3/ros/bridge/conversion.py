"""Messages of ROS 1 to messages of ROS 2, and back, field by field. Pure."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any, Final

import numpy as np

from pioneer3.errors import ConfigError
from pioneer3.ros.messages.sensors import fill_rows
from pioneer3.ros.ros2.types import MessageTypes
from pioneer3.ros.tcpros.types import Ros1Types
from pioneer3.ros.typestore import BASE, DTYPES, NAME, MessageStore, full_name

FRAMES: Final = ("frame_id", "child_frame_id")
"""Fields that name frames."""
BUMPERS: Final = ("rosaria/msg/BumperState", "std_msgs/msg/UInt8MultiArray")
TWIST: Final = "geometry_msgs/msg/Twist"
STAMPED: Final = "geometry_msgs/msg/TwistStamped"
Convert = Callable[[Any], Any]


@dataclass(frozen=True, slots=True)
class FrameNames:
    """The names of frames on both sides: only in ROS 1 they have `prefix`, such as `robot1/`.

    ROS 1 allows a leading slash, which tf2 refuses.
    """

    prefix: str = ""

    def in_ros2(self, name: str) -> str:
        """Return the name in ROS 2 of a frame in ROS 1."""
        return name.lstrip("/").removeprefix(self.prefix)

    def in_ros1(self, name: str) -> str:
        """Return the name in ROS 1 of a frame in ROS 2."""
        return f"{self.prefix}{name}" if name else name


class Converter:
    """Converts serialized messages."""

    def __init__(
        self, ros1: Ros1Types, ros2: MessageTypes, frames: FrameNames | None = None
    ) -> None:
        self.ros1, self.ros2 = ros1, ros2
        self._frames = frames or FrameNames()

    def to_ros2(self, ros1_type: str, ros2_type: str) -> Convert:
        """Return the function from messages of a type in ROS 1 to those of a type in ROS 2.

        Raises:
            ConfigError: there is no such type, or they differ.
        """
        first, second = full_name(ros1_type), full_name(ros2_type)
        self.ros1.definition(first), self.ros2.message_type(second)
        if (first, second) == BUMPERS:
            return self._bumper_array
        return _Mapping(self.ros1, self.ros2, self._frames.in_ros2).of(first, second)

    def to_ros1(self, ros1_type: str, ros2_type: str) -> Convert:
        """Return the function from messages of a type in ROS 2 to those of a type in ROS 1.

        ConfigError as of :meth:`to_ros2`.
        """
        first, second = full_name(ros1_type), full_name(ros2_type)
        self.ros1.definition(first), self.ros2.message_type(second)
        if (first, second) == BUMPERS:
            return self._bumper_state
        if (first, second) == (TWIST, STAMPED):
            within = _Mapping(self.ros2, self.ros1, self._frames.in_ros1).of(TWIST, TWIST)
            return lambda message: within(message.twist)
        return _Mapping(self.ros2, self.ros1, self._frames.in_ros1).of(second, first)

    def _bumper_array(self, message: Any) -> Any:
        """Return a std_msgs/UInt8MultiArray of two rows for a rosaria/BumperState."""
        made = self.ros2.make(BUMPERS[1])
        rows = (message.front_bumpers, message.rear_bumpers)
        fill_rows(made, self.ros2.make, *(bytes(map(bool, row)) for row in rows))
        return made

    def _bumper_state(self, message: Any) -> Any:
        """Return a rosaria/BumperState for a std_msgs/UInt8MultiArray of two rows."""
        made = self.ros1.make(BUMPERS[0])
        pressed = np.asarray(message.data, bool)
        half = len(pressed) // 2
        made.front_bumpers, made.rear_bumpers = pressed[:half], pressed[half:]
        return made


class _Mapping:
    """From the types of one store to those of another; fields that are missing there stay empty."""

    def __init__(
        self, source: MessageStore, target: MessageStore, frame: Callable[[str], str]
    ) -> None:
        self._source, self._target, self._frame = source, target, frame

    def of(self, name: str, other: str) -> Convert:
        """Return the function for a type and its counterpart.

        ConfigError if they differ in more than missing fields.
        """
        steps = list(self._steps(name, other))
        target = self._target

        def convert(message: Any) -> Any:
            made = target.make(other)
            for field, theirs, change in steps:
                value = getattr(message, field)
                setattr(made, theirs, value if change is None else change(value))
            return made

        return convert

    def _steps(self, name: str, other: str) -> Iterator[tuple[str, str, Convert | None]]:
        """Yield each field that both have, its name in the other type, and how it is changed."""
        theirs = {field.lower(): (field, kind) for field, kind in self._target.fields[other][1]}
        common = 0
        for field, kind in self._source.fields[name][1]:
            if field.lower() in theirs:
                their_field, their_kind = theirs[field.lower()]
                yield field, their_field, self._change(f"{name}.{field}", field, kind, their_kind)
                common += 1
        if not common and theirs and self._source.fields[name][1]:
            raise ConfigError(f"{name} and {other} have no field in common")

    def _change(self, where: str, field: str, kind: Any, their_kind: Any) -> Convert | None:
        (shape, what), (their_shape, their_what) = kind, their_kind
        if shape != their_shape:
            raise ConfigError(f"{where} has another shape on the other side")
        if shape == BASE:
            _check_same(where, what[0], their_what[0])
            return self._frame if field in FRAMES and what[0] == "string" else None
        if shape == NAME:
            return self.of(str(what), str(their_what))
        ((inner, base), _), ((their_inner, their_base), _) = what, their_what
        if inner == NAME == their_inner:
            return partial(_each, self.of(str(base), str(their_base)))
        _check_same(where, base[0], their_base[0])
        return None


def _each(convert: Convert, values: Any) -> list[Any]:
    return [convert(value) for value in values]


def _check_same(where: str, one: str, other: str) -> None:
    if DTYPES.get(one, one) != DTYPES.get(other, other):
        raise ConfigError(f"{where} is {one} on one side and {other} on the other")
