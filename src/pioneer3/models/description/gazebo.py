"""Names of Gazebo's plug-ins and messages, and of the topics between it and ROS, as data.

From the documentation of gz-sim, gz-sensors and ros_gz_bridge; they hold from Gazebo Garden on.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from typing import Final, NamedTuple

import yaml

from pioneer3.models.model import RobotModel


class Plugin(NamedTuple):
    """A system of a model: its library, and its class."""

    filename: str
    name: str


DRIVE: Final = Plugin("gz-sim-diff-drive-system", "gz::sim::systems::DiffDrive")
JOINTS: Final = Plugin(
    "gz-sim-joint-state-publisher-system", "gz::sim::systems::JointStatePublisher"
)
FRAME_ID: Final = "gz_frame_id"
"""Element of a sensor with the frame of its messages."""


class BridgeDirection(StrEnum):
    """Direction of messages over ros_gz_bridge."""

    TO_ROS = "GZ_TO_ROS"
    TO_GAZEBO = "ROS_TO_GZ"


@dataclass(frozen=True, slots=True)
class Exchange:
    """A topic of one name in Gazebo and in ROS.

    That is the name in the profile `standard` of our node, where the node has the same messages.
    """

    topic: str
    ros_type: str
    gazebo_type: str
    direction: BridgeDirection = BridgeDirection.TO_ROS


COMMAND: Final = Exchange(
    "cmd_vel", "geometry_msgs/msg/Twist", "gz.msgs.Twist", BridgeDirection.TO_GAZEBO
)
ODOMETRY: Final = Exchange("odom", "nav_msgs/msg/Odometry", "gz.msgs.Odometry")
TRANSFORMS: Final = Exchange("/tf", "tf2_msgs/msg/TFMessage", "gz.msgs.Pose_V")
WHEELS: Final = Exchange("joint_states", "sensor_msgs/msg/JointState", "gz.msgs.Model")
TURN_RATE: Final = Exchange("imu/data_raw", "sensor_msgs/msg/Imu", "gz.msgs.IMU")
SCAN: Final = Exchange("scan", "sensor_msgs/msg/LaserScan", "gz.msgs.LaserScan")
BUMPERS: Final = Exchange("bumpers/contacts", "ros_gz_interfaces/msg/Contacts", "gz.msgs.Contacts")
CLOCK: Final = Exchange("/clock", "rosgraph_msgs/msg/Clock", "gz.msgs.Clock")


def sonar(number: int) -> Exchange:
    """Return the topic of a transducer's rays; their smallest range is the reading."""
    return Exchange(f"sonar/scan_{number}", SCAN.ros_type, SCAN.gazebo_type)


def exchanges_of(model: RobotModel) -> Iterator[Exchange]:
    """Yield the topics of a robot in Gazebo."""
    yield from (COMMAND, ODOMETRY, TRANSFORMS, WHEELS, TURN_RATE)
    if model.laser is not None:
        yield SCAN
    if model.front_bumpers or model.rear_bumpers:
        yield BUMPERS
    yield from map(sonar, range(len(model.sonars)))
    yield CLOCK


def bridge_of(model: RobotModel) -> str:
    """Return the YAML of ros_gz_bridge for a robot."""
    entries = [
        {
            "ros_topic_name": each.topic,
            "gz_topic_name": each.topic,
            "ros_type_name": each.ros_type,
            "gz_type_name": each.gazebo_type,
            "direction": str(each.direction),
        }
        for each in exchanges_of(model)
    ]
    return yaml.safe_dump(entries, sort_keys=False)
