"""Writes small rosbags, as robots record them."""

from collections.abc import Sequence
from math import cos, sin
from pathlib import Path
from typing import Any

import numpy as np

from pioneer3.geometry import ORIGIN, Pose2

ROS_1 = "ros1"
"""A bag of ROS 1."""
CDR = {"sqlite3": "SQLITE3", "mcap": "MCAP"}
"""Storages of ROS 2, as rosbags names them."""


class BagWriter:
    """A new bag.

    Args:
        path: A file for ROS 1, else a folder.
        storage: `ros1`, `sqlite3` or `mcap`.
        compression: Of ROS 1: `BZ2` or `LZ4`.
    """

    def __init__(self, path: Path, storage: str, compression: str | None = None) -> None:
        from rosbags.rosbag1 import Writer as Writer1
        from rosbags.rosbag2 import StoragePlugin
        from rosbags.rosbag2 import Writer as Writer2
        from rosbags.typesys import Stores, get_types_from_msg, get_typestore

        self._ros_1 = storage == ROS_1
        self.store = get_typestore(Stores.ROS1_NOETIC if self._ros_1 else Stores.ROS2_JAZZY)
        if self._ros_1:
            field = "geometry_msgs/TransformStamped[] transforms"
            self.store.register(get_types_from_msg(field, "tf2_msgs/msg/TFMessage"))
        self._writer: Any
        if self._ros_1:
            self._writer = Writer1(path)
            if compression:
                self._writer.set_compression(Writer1.CompressionFormat[compression])
        else:
            self._writer = Writer2(path, version=9, storage_plugin=StoragePlugin[CDR[storage]])
        self._connections: dict[str, Any] = {}

    def __enter__(self) -> "BagWriter":
        self._writer.open()
        return self

    def __exit__(self, *_: object) -> None:
        self._writer.close()

    def put(self, topic: str, kind: str, time: float, **fields: Any) -> None:
        """Write a message."""
        if topic not in self._connections:
            self._connections[topic] = self._writer.add_connection(
                topic, kind, typestore=self.store
            )
        message = self.make(kind, **fields)
        write = self.store.serialize_ros1 if self._ros_1 else self.store.serialize_cdr
        self._writer.write(self._connections[topic], int(time * 1e9), write(message, kind))

    def make(self, kind: str, **fields: Any) -> Any:
        """Return a message."""
        return self.store.types[kind](**fields)

    def header(self, time: float, frame: str) -> Any:
        """Return a header."""
        stamp = self.make("builtin_interfaces/msg/Time", sec=int(time), nanosec=int(time % 1 * 1e9))
        more = {"seq": 0} if self._ros_1 else {}
        return self.make("std_msgs/msg/Header", stamp=stamp, frame_id=frame, **more)

    def transform(
        self,
        time: float,
        parent: str,
        child: str,
        pose: Pose2 = ORIGIN,
        *,
        topic: str = "/tf",
        turned: Sequence[float] | None = None,
    ) -> None:
        """Write a transform; `turned` is its quaternion x, y, z, w if it is not level."""
        where = self.make("geometry_msgs/msg/Vector3", x=pose.x, y=pose.y, z=0.3)
        turn = turned or (0.0, 0.0, sin(pose.theta / 2), cos(pose.theta / 2))
        rotation = self.make("geometry_msgs/msg/Quaternion", **dict(zip("xyzw", turn, strict=True)))
        transform = self.make("geometry_msgs/msg/Transform", translation=where, rotation=rotation)
        stamped = self.make(
            "geometry_msgs/msg/TransformStamped",
            header=self.header(time, parent),
            child_frame_id=child,
            transform=transform,
        )
        self.put(topic, "tf2_msgs/msg/TFMessage", time, transforms=[stamped])

    def odometry(
        self, time: float, pose: Pose2, topic: str = "/odom", child: str = "base_link"
    ) -> None:
        """Write odometry."""
        point = self.make("geometry_msgs/msg/Point", x=pose.x, y=pose.y, z=0.0)
        turn = self.make(
            "geometry_msgs/msg/Quaternion",
            x=0.0,
            y=0.0,
            z=sin(pose.theta / 2),
            w=cos(pose.theta / 2),
        )
        place = self.make("geometry_msgs/msg/Pose", position=point, orientation=turn)
        zero = self.make("geometry_msgs/msg/Vector3", x=0.0, y=0.0, z=0.0)
        still = self.make("geometry_msgs/msg/Twist", linear=zero, angular=zero)
        no = np.zeros(36)
        self.put(
            topic,
            "nav_msgs/msg/Odometry",
            time,
            header=self.header(time, "odom"),
            child_frame_id=child,
            pose=self.make("geometry_msgs/msg/PoseWithCovariance", pose=place, covariance=no),
            twist=self.make("geometry_msgs/msg/TwistWithCovariance", twist=still, covariance=no),
        )

    def scan(
        self,
        time: float,
        ranges: Sequence[float],
        *,
        topic: str = "/scan",
        frame: str = "laser",
        step: float = 0.1,
        beam_time: float = 0.0,
        at: float | None = None,
    ) -> None:
        """Write a scan that begins at -0.1 rad; it comes when it is measured, or `at` a time."""
        self.put(
            topic,
            "sensor_msgs/msg/LaserScan",
            at or time,
            header=self.header(time, frame),
            angle_min=-0.1,
            angle_max=-0.1 + step * (len(ranges) - 1),
            angle_increment=step,
            time_increment=beam_time,
            scan_time=0.0,
            range_min=0.1,
            range_max=30.0,
            ranges=np.array(ranges, dtype=np.float32),
            intensities=np.zeros(0, dtype=np.float32),
        )
