"""The tree of frames to ROS messages."""

from collections.abc import Iterator
from typing import Any

from pioneer3.ros.description.tree import Joint
from pioneer3.ros.messages.convert import Reading, head, place


def moving(message: Any, reading: Reading) -> None:
    """Fill a tf2_msgs/TFMessage: the robot in the odom frame, and turning wheels if wanted."""
    conventions = reading.conventions
    message.transforms = []
    if conventions.odometry_in_tree:
        transform = reading.make("geometry_msgs/TransformStamped")
        head(transform, reading, reading.frames.odom)
        transform.child_frame_id = reading.frames.base
        inner = transform.transform
        place(inner.translation, inner.rotation, reading.snapshot.odometry.robot_in_odom)
        message.transforms.append(transform)
    if conventions.wheels_in_tree:
        message.transforms += wheels(reading, reading.turned)


def fixed(message: Any, reading: Reading) -> None:
    """Fill a tf2_msgs/TFMessage with what never moves, and wheels that do not turn in the tree."""
    message.transforms = [_transform(reading, joint) for joint in reading.tree.fixed]
    if not reading.conventions.wheels_in_tree:
        message.transforms += wheels(reading, (0.0, 0.0))


def wheels(reading: Reading, turned: tuple[float, float]) -> Iterator[Any]:
    """Yield the transform of each wheel; `turned` is left and right [rad]."""
    for number, joint in enumerate(reading.tree.wheels):
        yield _transform(reading, joint, turned[number % 2])


def _transform(reading: Reading, joint: Joint, turned: float = 0.0) -> Any:
    prefix = reading.conventions.prefix
    transform = reading.make("geometry_msgs/TransformStamped")
    head(transform, reading, prefix + joint.parent)
    transform.child_frame_id = prefix + joint.child
    at, rotation = transform.transform.translation, transform.transform.rotation
    at.x, at.y, at.z = joint.x, joint.y, joint.z
    rotation.x, rotation.y, rotation.z, rotation.w = joint.rotation(turned)
    return transform
