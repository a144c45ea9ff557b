"""The words of ROS 2 in a command line, as one."""

import json
from collections.abc import Sequence


def gather_ros_arguments(words: list[str]) -> list[str]:
    """Return the words of a command line with those of ROS 2 as one, after `--ros-args`.

    They begin at `--ros-args` and end at `--`, or at the end; there may be several such parts.
    """
    kept: list[str] = []
    own: list[str] = []
    inside = False
    for word in words:
        if word == "--ros-args":
            inside = True
        elif inside and word == "--":
            inside = False
        else:
            (own if inside else kept).append(word)
    return [*kept, "--ros-args", json.dumps(own)] if own else kept


def separate_ros_arguments(words: Sequence[str]) -> list[str]:
    """Return the words from which :func:`gather_ros_arguments` has made `words`."""
    if "--ros-args" not in words:
        return [*words]
    place = words.index("--ros-args")
    return [*words[:place], "--ros-args", *json.loads(words[place + 1])]
