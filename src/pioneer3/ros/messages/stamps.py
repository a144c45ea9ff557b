"""Times in messages: the one place that knows how ROS 1 and ROS 2 write them."""

from typing import Any, Final

NANO: Final = 1_000_000_000
"""Nanoseconds of a second."""


def nanoseconds(stamp: Any) -> int:
    """Return a time [ns]: of builtin_interfaces (ROS 2: `sec`, `nanosec`) or genpy (ROS 1)."""
    if hasattr(stamp, "nanosec"):
        return int(stamp.sec) * NANO + int(stamp.nanosec)
    return int(stamp.to_nsec())
