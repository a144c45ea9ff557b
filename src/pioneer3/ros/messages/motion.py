"""Odometry, wheels and transforms to ROS messages, and a `Twist` to ours."""

from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import Any, NamedTuple

from pioneer3.geometry import Pose2, Twist2, arc_to
from pioneer3.models import RobotModel, shape_of
from pioneer3.models.description.tree import Joint, Quaternion
from pioneer3.robot.limits import checked
from pioneer3.ros.messages.update import (
    DRIVING,
    STANDING,
    DescriptionUpdate,
    StateUpdate,
    fill_header,
    fill_pose,
    resized,
)
from pioneer3.state import Odometry


def odometry(message: Any, update: StateUpdate) -> None:
    """Fill a nav_msgs/Odometry: pose in the odom frame, twist in the robot's own."""
    fill_header(message, update.stamp, update.frames.odom)
    message.child_frame_id = update.frames.root
    state = update.snapshot.odometry
    pose, twist = message.pose, message.twist
    fill_pose(pose.pose.position, pose.pose.orientation, state.robot_in_odom)
    twist.twist.linear.x, twist.twist.angular.z = state.twist.v, state.twist.w
    pose.covariance = covariance(state, update.options.pose_variances)
    twist.covariance = covariance(state, update.options.twist_variances)


def covariance(state: Odometry, driving: tuple[float, ...] = DRIVING) -> list[float]:
    """Return the 36 numbers, row by row: x, y, z, roll, pitch, yaw on the diagonal."""
    still = state.left_speed == 0 and state.right_speed == 0
    return _matrix(driving, still).copy()


@lru_cache
def _matrix(driving: tuple[float, ...], still: bool) -> list[float]:
    matrix = [0.0] * 36
    matrix[::7] = map(min, STANDING, driving) if still else driving
    return matrix


def wanted_twist(message: Any) -> Twist2:
    """Return forward speed [m/s] and turn rate [rad/s] of a geometry_msgs/Twist.

    Its other fields do not apply to a robot that moves in a plane and not sideways. CommandError
    for numbers that are not finite.
    """
    return checked(message.linear.x, message.angular.z)


def fill_twist(message: Any, wanted: Twist2) -> None:
    """Fill a geometry_msgs/Twist, which is empty."""
    message.linear.x, message.angular.z = wanted.v, wanted.w


def moving_transforms(message: Any, update: StateUpdate) -> None:
    """Fill a tf2_msgs/TFMessage: the robot in the odom frame, that in the map, turning wheels."""
    options, frames = update.options, update.frames
    placed = []
    if options.odometry_tf:
        pose = update.snapshot.odometry.robot_in_odom
        placed.append(_moving(update.stamp, frames.odom, frames.root, pose))
    if update.odom_in_map is not None:
        stamp, pose = update.odom_in_map
        placed.append(_moving(stamp, options.map_frame, frames.odom, pose))
    if options.wheels_tf:
        placed += wheels(update, update.turned)
    _fill_transforms(message, update, placed)


def fixed_transforms(message: Any, update: StateUpdate) -> None:
    """Fill a tf2_msgs/TFMessage with joints that never move, and wheels unless `/tf` has them."""
    placed = [_joint(update, joint) for joint in update.tree.fixed]
    if not update.options.wheels_tf:
        placed += wheels(update, (0.0, 0.0))
    _fill_transforms(message, update, placed)


class PlacedFrame(NamedTuple):
    """A frame in its parent: its place [m] and rotation, at the time `stamp`."""

    stamp: Any
    parent: str
    child: str
    at: tuple[float, float, float]
    rotation: Quaternion


def wheels(update: StateUpdate, turned: tuple[float, float]) -> Iterator[PlacedFrame]:
    """Yield the frame of each wheel; `turned` is left and right [rad]."""
    for number, joint in enumerate(update.tree.wheels):
        yield _joint(update, joint, turned[number % 2])


def _moving(stamp: Any, parent: str, child: str, pose: Pose2) -> PlacedFrame:
    at = (pose.x, pose.y, 0.0)
    return PlacedFrame(stamp, parent, child, at, Quaternion.about_z(pose.theta))


def _joint(update: StateUpdate, joint: Joint, turned: float = 0.0) -> PlacedFrame:
    prefix, at = update.options.prefix, (joint.x, joint.y, joint.z)
    parent, child = prefix + joint.parent, prefix + joint.child
    return PlacedFrame(update.stamp, parent, child, at, joint.rotation(turned))


def _fill_transforms(message: Any, update: StateUpdate, placed: Sequence[PlacedFrame]) -> None:
    """Fill a tf2_msgs/TFMessage, and the transforms in it anew."""
    kind = "geometry_msgs/TransformStamped"
    message.transforms = resized(message.transforms, len(placed), kind, update.make)
    for transform, frame in zip(message.transforms, placed, strict=True):
        fill_header(transform, frame.stamp, frame.parent)
        transform.child_frame_id = frame.child
        place, rotation = transform.transform.translation, transform.transform.rotation
        place.x, place.y, place.z = frame.at
        rotation.x, rotation.y, rotation.z, rotation.w = frame.rotation


def description(message: Any, update: DescriptionUpdate) -> None:
    """Fill a std_msgs/String with the description of the robot."""
    message.data = update.urdf


class WheelAngles:
    """Adds up the turns of the wheels, from odometry: Pioneers report no more by themselves.

    Left and right wheels have `turned` so far since the beginning [rad].
    """

    def __init__(self) -> None:
        self.turned = (0.0, 0.0)
        self._before: Pose2 | None = None
        self._of: tuple[RobotModel, float] | None = None

    def update(self, odometry: Odometry, model: RobotModel) -> tuple[float, float]:
        """Take the next odometry; return :attr:`turned`."""
        here = odometry.robot_in_odom
        if self._before is not None and self._before != here:
            moved, _ = arc_to(self._before.inverse() @ here)
            across = moved.w * model.true_base / 2
            if self._of is None or self._of[0] is not model:
                self._of = model, shape_of(model).wheel_radius
            _, radius = self._of
            left, right = self.turned
            self.turned = left + (moved.v - across) / radius, right + (moved.v + across) / radius
        self._before = here
        return self.turned

    def jumped(self) -> None:
        """Take the next odometry as the present pose: somebody has set it."""
        self._before = None


def joint_states(message: Any, update: StateUpdate) -> None:
    """Fill a sensor_msgs/JointState with every driven wheel [rad, rad/s]."""
    fill_header(message, update.stamp, "")
    radius = shape_of(update.model).wheel_radius
    state = update.snapshot.odometry
    speeds = (state.left_speed / radius, state.right_speed / radius)
    message.name = [joint.name for joint in update.tree.wheels]
    pairs = len(message.name) // 2
    message.position = list(update.turned) * pairs
    message.velocity = list(speeds) * pairs
    message.effort = []
