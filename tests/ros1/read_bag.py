"""Reads a bag with ROS 1's own library, by the definitions in it. Needs rosbag only.

Usage: /usr/bin/python3 read_bag.py FILE ... Prints JSON: for each file its topics, with type,
checksum, whether they are latched, and of each message the time, the stamp of its header [ns] and
its numbers as they follow each other.
"""

from __future__ import annotations

import json
import sys
from typing import Any

import genpy
import rosbag


def numbers(value: Any) -> list[Any]:
    """Return all numbers and texts in a message."""
    if isinstance(value, genpy.Message):
        return [each for name in value.__slots__ for each in numbers(getattr(value, name))]
    if isinstance(value, genpy.Time):
        return [value.to_nsec()]
    if isinstance(value, (list, tuple)):
        return [each for part in value for each in numbers(part)]
    if isinstance(value, bytes):
        return list(value)
    return [value]


def read(path: str) -> dict[str, Any]:
    """Return the topics of a bag."""
    found: dict[str, Any] = {}
    with rosbag.Bag(path) as bag:
        for connection in bag._get_connections():  # as `rosbag info` does
            found[connection.topic] = {
                "type": connection.datatype,
                "checksum": connection.md5sum,
                "latched": connection.header.get(b"latching", connection.header.get("latching")),
                "messages": [],
            }
            found[connection.topic]["latched"] = found[connection.topic]["latched"] in ("1", b"1")
        for topic, message, time in bag.read_messages():
            found[topic]["messages"].append([time.to_nsec(), numbers(message)])
    return found


sys.stdout.write(json.dumps([read(path) for path in sys.argv[1:]]))
