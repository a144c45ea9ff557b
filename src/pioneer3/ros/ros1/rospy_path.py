"""Where ROS 1 is installed: beside this project's environment, never in it."""

import sys
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Final

from pioneer3.errors import ConfigError

PLACES: Final = (
    Path("/usr/lib/python3/dist-packages"),
    Path("/opt/ros/noetic/lib/python3/dist-packages"),
)
"""Debian's own packages, and Ubuntu's ROS Noetic."""
PACKAGES: Final = (
    "python3-roslaunch python3-rospy rosout python3-rostopic python3-rosservice python3-rosparam"
    " python3-rosnode python3-rosmsg rosbash python3-rosbag python3-dynamic-reconfigure"
    " python3-nav-msgs python3-sensor-msgs python3-geometry-msgs python3-std-srvs python3-tf2-msgs"
    " python3-diagnostic-msgs ros-std-msgs ros-geometry-msgs ros-nav-msgs ros-sensor-msgs"
    " ros-std-srvs ros-tf2-msgs ros-diagnostic-msgs"
)
"""What the node and ROS's own command-line tools need of Debian 12."""


def find_rospy(places: Sequence[Path] = PLACES) -> None:
    """Make `import rospy` work, from one of `places` if need be.

    The place comes last in the search path: where both have a package, ours is taken.

    Raises:
        ConfigError: ROS 1 is not installed; the message has the command that installs it.
    """
    if find_spec("rospy") is not None:
        return
    for place in places:
        if (place / "rospy").is_dir():
            sys.path.append(str(place))
            return
    raise ConfigError(
        "ROS 1 is not installed on this computer; on Debian 12 run:\n"
        f"sudo apt-get update && sudo apt-get install -y --no-install-recommends {PACKAGES}"
    )
