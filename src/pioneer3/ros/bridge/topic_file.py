"""Further rows of a bridge, from a file or the command line.

::

    [[topic]]
    ros1 = "/joy"
    ros2 = "/robot1/joy"          # without it as in ROS 1
    type = "sensor_msgs/Joy"
    way = "to_ros2"               # or to_ros1, both
    latched = false
    reliable = true               # false: best effort, which suits every publisher in ROS 2
"""

import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from itertools import permutations
from pathlib import Path
from typing import Final, Literal

from pioneer3.errors import ConfigError
from pioneer3.ros.bridge.conversion import Converter
from pioneer3.ros.bridge.rows import BridgedTopic, BridgeWay
from pioneer3.ros.ros2.names import checked_topic
from pioneer3.tables import Source, converted, load
from pioneer3.text import decoded, read_bytes

LARGEST: Final = 1 << 20
"""Larger files are not read [bytes]."""
ARGUMENT: Final = re.compile(r"(/[^:]+):([^:/]+(?:/msg)?/[^:/]+)")


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicTable:
    """A row as it is written; see this module."""

    ros1: str
    type: str
    way: Literal["to_ros1", "to_ros2", "both"]
    ros2: str = ""
    latched: bool = False
    reliable: bool = True


@dataclass(frozen=True, slots=True)
class FileTable:
    """A file of rows."""

    topic: tuple[TopicTable, ...] = ()


def read_topics(path: Path, converter: Converter) -> tuple[BridgedTopic, ...]:
    """Return the rows of a file; ConfigError, with file, line and key, if it is wrong."""
    text = decoded(read_bytes(path, LARGEST, kind="topics"))
    source = Source.of(path, text)
    tables = converted(source, load(source), FileTable).topic
    rows = []
    for index, table in enumerate(tables):
        ros2 = table.ros2 or table.ros1
        checks: dict[str, Callable[[], object]] = {
            "ros1": partial(checked_topic, table.ros1),
            "ros2": partial(checked_topic, ros2),
            "type": partial(checked_type, table.type, converter),
        }
        for key, check in checks.items():
            try:
                check()
            except ConfigError as error:
                raise source.wrong(f"topic[{index}].{key}", str(error)) from None
        rows.append(
            BridgedTopic(
                ros1=table.ros1,
                ros2=ros2,
                ros1_type=table.type,
                ros2_type=table.type,
                way=BridgeWay(table.way),
                latched=table.latched,
                reliable=table.reliable,
            )
        )
    return tuple(rows)


def parse_topic(text: str, way: BridgeWay, converter: Converter) -> BridgedTopic:
    """Return the row of an option such as `/joy:sensor_msgs/Joy`; ConfigError if it is none."""
    match = ARGUMENT.fullmatch(text)
    if match is None:
        raise ConfigError(f"a topic to bridge is such as /joy:sensor_msgs/Joy, not {text!r}")
    name, type_name = checked_topic(match[1]), checked_type(match[2], converter)
    return BridgedTopic(ros1=name, ros2=name, ros1_type=type_name, ros2_type=type_name, way=way)


def checked_type(name: str, converter: Converter) -> str:
    """Return the short name of a type that both sides have alike; else ConfigError."""
    short = name.replace("/msg/", "/")
    if short.count("/") != 1 or not all(short.split("/")):
        raise ConfigError(f"a type is such as sensor_msgs/Joy, not {name!r}")
    converter.to_ros2(short, short)
    converter.to_ros1(short, short)
    return short


def refuse_circles(rows: tuple[BridgedTopic, ...]) -> None:
    """Raise ConfigError if a topic has two rows, or one passes on what another passes back."""
    for row, other in permutations(rows, 2):
        if (row.ros1, row.ros2) == (other.ros1, other.ros2):
            raise ConfigError(f"two rows for the same topics: {row}, and {other}")
        for source in row.way.sources:
            target = source.other
            if target in other.way.sources and row.name(target) == other.name(target):
                raise ConfigError(f"messages would go in a circle: {row}, and {other}")
