"""Reads a bag with rclpy's own codec. Needs rclpy and mcap only.

Usage: python read_bag.py FILE.mcap. Prints a line of JSON for each message whose type is installed:
topic, time [ns] and content, in which numbers that JSON lacks are texts; then how many there were
of each type that is not.
"""

import json
import sys
from importlib import import_module
from math import isfinite
from pathlib import Path
from typing import Any

from mcap.reader import make_reader
from rclpy.serialization import deserialize_message


def plain(value: Any) -> Any:
    """Return a message, or a value in one, as JSON takes it."""
    if hasattr(value, "get_fields_and_field_types"):
        return {name: plain(getattr(value, name)) for name in value.get_fields_and_field_types()}
    if isinstance(value, bytes):
        return list(value)
    if hasattr(value, "__len__") and not isinstance(value, str):
        return [plain(each) for each in value]
    if hasattr(value, "item"):
        value = value.item()
    return str(value) if isinstance(value, float) and not isfinite(value) else value


def main(path: Path) -> None:
    unknown: dict[str, int] = {}
    with path.open("rb") as file:
        for schema, channel, message in make_reader(file).iter_messages():
            assert schema is not None
            package, _, name = schema.name.split("/")
            try:
                kind = getattr(import_module(f"{package}.msg"), name)
            except ImportError:
                unknown[schema.name] = unknown.get(schema.name, 0) + 1
                continue
            content = plain(deserialize_message(message.data, kind))
            sys.stdout.write(json.dumps([channel.topic, message.log_time, content]) + "\n")
    sys.stdout.write(json.dumps(unknown) + "\n")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
