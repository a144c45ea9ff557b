"""The wheels: how far they have turned, and what ROS is told of that."""

from math import pi, sin
from typing import Any

from pioneer3.geometry import Pose2
from pioneer3.models import RobotModel, shape_of
from pioneer3.ros.messages.convert import Reading, head
from pioneer3.state import Odometry

STRAIGHT = 1e-6
"""Turns less than this are none [rad]."""


class WheelAngles:
    """Adds up how far the wheels have turned, from odometry: Pioneers tell no more by themselves.

    Attributes:
        turned: Angles of the left wheels and of the right ones since the beginning [rad].
    """

    def __init__(self) -> None:
        self.turned = (0.0, 0.0)
        self._before: Pose2 | None = None

    def update(self, odometry: Odometry, model: RobotModel) -> tuple[float, float]:
        """Take the next reading; return :attr:`turned`."""
        here = odometry.robot_in_odom
        if self._before is not None:
            way, angle = _arc(self._before.inverse() @ here)
            across = angle * model.wheel_base / 2
            radius = shape_of(model).wheel_radius
            left, right = self.turned
            self.turned = left + (way - across) / radius, right + (way + across) / radius
        self._before = here
        return self.turned

    def jumped(self) -> None:
        """Take the next reading as the present pose: odometry was set."""
        self._before = None


def joint_states(message: Any, reading: Reading) -> None:
    """Fill a sensor_msgs/JointState with every driven wheel [rad, rad/s]."""
    head(message, reading, "")
    radius = shape_of(reading.model).wheel_radius
    state = reading.snapshot.odometry
    speeds = (state.left_speed / radius, state.right_speed / radius)
    message.name = [joint.name for joint in reading.tree.wheels]
    pairs = len(message.name) // 2
    message.position = list(reading.turned) * pairs
    message.velocity = list(speeds) * pairs
    message.effort = []


def _arc(step: Pose2) -> tuple[float, float]:
    """Return the length [m] and the angle [rad] of the arc that leads to `step`."""
    half = step.theta / 2
    chord = Pose2(theta=-half) @ step  # along x, but for slipping sideways
    shrunk = sin(half) / half if abs(half) > STRAIGHT and abs(half) < pi else 1.0
    return chord.x / shrunk, step.theta
