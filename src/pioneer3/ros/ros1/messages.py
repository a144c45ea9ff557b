"""ROS 1 message classes by name; :func:`pioneer3.ros.ros1.rospy_path.find_rospy` comes first."""

from functools import cache
from importlib import import_module
from typing import Any, Final

QUEUE: Final = 10
"""Messages that wait for a slow subscriber; then the oldest is dropped. Without a bound rospy would
block the publisher."""
BUMPER_KIND: Final = "rosaria/BumperState"
BUMPER_STATE: Final = """Header header
bool[] front_bumpers
bool[] rear_bumpers
================================================================================
MSG: std_msgs/Header
uint32 seq
time stamp
string frame_id
"""
"""Of RosAria's own message, md5sum f81947761ff7e166a3bbaf937b9869b5: no package need bring it."""


@cache
def message_class(kind: str) -> Any:
    """Return the class of a message type such as `nav_msgs/Odometry`."""
    if kind == BUMPER_KIND:
        from genpy.dynamic import generate_dynamic  # noqa: PLC0415

        return generate_dynamic(kind, BUMPER_STATE)[kind]
    package, name = kind.split("/")
    return getattr(import_module(f"{package}.msg"), name)


def make(kind: str) -> Any:
    """Return an empty message."""
    return message_class(kind)()


def publisher(name: str, kind: str, *, latch: bool = False, listener: object = None) -> Any:
    """Return a `rospy.Publisher` that no subscriber holds up.

    Args:
        name: Of the topic.
        kind: Of its messages, as "nav_msgs/Odometry".
        latch: Whether a late subscriber is sent the last message.
        listener: A `rospy.SubscribeListener`.
    """
    import rospy  # noqa: PLC0415

    return rospy.Publisher(
        name,
        message_class(kind),
        queue_size=QUEUE,
        latch=latch,
        subscriber_listener=listener,
        tcp_nodelay=True,
    )
