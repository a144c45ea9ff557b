"""Points to ROS messages: where sonars heard something, and what bumpers touch."""

import struct
from collections.abc import Callable, Sequence
from math import cos, isfinite, nan, sin
from typing import Any, Final

from pioneer3.models import RobotModel
from pioneer3.robot.assemble import SONAR_MAX
from pioneer3.ros.description.tree import BUMPER_HEIGHT, bumper_segments, height_of_sonars
from pioneer3.ros.messages.convert import Reading, head
from pioneer3.state import Sonar

FLOAT32: Final = 7
"""`PointField.FLOAT32`."""


def sonar_cloud(message: Any, reading: Reading) -> None:
    """Fill a sensor_msgs/PointCloud with a point for every transducer, in their order."""
    head(message, reading, reading.frames.sonar)
    message.points = []
    for x, y in sonar_points(reading.snapshot.sonar, reading.model):
        point = reading.make("geometry_msgs/Point32")
        point.x, point.y, point.z = x, y, 0.0
        message.points.append(point)


def sonar_cloud2(message: Any, reading: Reading) -> None:
    """Fill a sensor_msgs/PointCloud2 with a point for every transducer, in their order."""
    head(message, reading, reading.frames.sonar)
    _cloud2(message, reading.make, sonar_points(reading.snapshot.sonar, reading.model))
    message.is_dense = False  # as RosAria says it, though every point is a number


def echoes(message: Any, reading: Reading) -> None:
    """Fill a sensor_msgs/PointCloud2 with what has been heard since the last reading.

    Echoes that are older belong to a place where the robot no longer is, so they are left out.
    """
    head(message, reading, reading.frames.base)
    sonar, height = reading.snapshot.sonar, reading.conventions.sonar_height
    points = sonar_points(sonar, reading.model)
    heard = [
        points[number]
        for number in sonar.fresh
        if number < len(points) and isfinite(sonar.ranges[number])
    ]
    _cloud2(
        message, reading.make, heard, height_of_sonars(reading.model) if height is None else height
    )
    message.is_dense = True


def touches(message: Any, reading: Reading) -> None:
    """Fill a sensor_msgs/PointCloud2 with the middle of each bumper segment that is pressed."""
    head(message, reading, reading.frames.base)
    state, model = reading.snapshot.bumpers, reading.model
    pressed = [
        (pose.x, pose.y)
        for segments, rear in ((state.front, False), (state.rear, True))
        for pose, hit in zip(
            bumper_segments(model, len(segments), rear=rear), segments, strict=True
        )
        if hit
    ]
    _cloud2(message, reading.make, pressed, BUMPER_HEIGHT)
    message.is_dense = True


def sonar_points(sonar: Sonar, model: RobotModel) -> list[tuple[float, float]]:
    """Return where each transducer's echo came from, in the robot's frame [m].

    Without an echo, and before the first one, it is as far away as echoes are heard from: clients
    of RosAria read a point of each transducer, unchecked.
    """
    points = []
    for number, mount in enumerate(model.sonars):
        measured = sonar.ranges[number] if number < len(sonar.ranges) else nan
        metres = measured if isfinite(measured) else SONAR_MAX
        points.append((mount.x + metres * cos(mount.theta), mount.y + metres * sin(mount.theta)))
    return points


def _cloud2(
    message: Any,
    make: Callable[[str], Any],
    points: Sequence[tuple[float, float]],
    height: float = 0.0,
) -> None:
    """One row of points, three 32-bit floats each."""
    message.fields = []
    for offset, name in ((0, "x"), (4, "y"), (8, "z")):
        field = make("sensor_msgs/PointField")
        field.name, field.offset, field.datatype, field.count = name, offset, FLOAT32, 1
        message.fields.append(field)
    message.height, message.width = 1, len(points)
    message.is_bigendian = False
    message.point_step, message.row_step = 12, 12 * len(points)
    message.data = b"".join(struct.pack("<3f", x, y, height) for x, y in points)
