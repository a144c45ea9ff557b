"""Which robots there are on the ROS 1 master, and alive."""

from contextlib import closing
from socket import create_connection
from typing import Final
from urllib.parse import urlsplit

from pioneer3.errors import NoRobotError
from pioneer3.ros.interface.graph import RobotTopics, robots_on
from pioneer3.ros.ros1.rospy_path import find_rospy

ALIVE: Final = 0.5
"""A node that takes no connection within this time [s] has gone."""


def find_robots() -> list[RobotTopics]:
    """Return the robots on the master whose nodes are alive.

    Raises:
        ConfigError: ROS 1 is not installed.
        NoRobotError: there is no master.
    """
    find_rospy()
    import rosgraph  # noqa: PLC0415

    uri = rosgraph.get_master_uri()
    master = rosgraph.Master("/pioneer3")
    try:
        publishers, subscribers, _ = master.getSystemState()
        types = dict(master.getTopicTypes())
        found = robots_on(publishers, subscribers, types)
        return [robot for robot in found if _is_alive(master.lookupNode(robot.node))]
    except (OSError, rosgraph.MasterException) as error:
        raise NoRobotError(
            f"there is no ROS master at {uri} ({error}): start roscore, or set ROS_MASTER_URI"
        ) from error


def _is_alive(uri: str) -> bool:
    """Whether a node answers at its address: one that was killed stays registered."""
    address = urlsplit(uri)
    try:
        with closing(create_connection((address.hostname, address.port), ALIVE)):
            return True
    except OSError:
        return False
