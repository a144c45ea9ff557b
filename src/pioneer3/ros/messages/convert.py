"""From readings to ROS messages and from a `Twist` to ours. Needs no ROS: messages are handed in.

Messages are filled, not made, because each middleware has its own classes with the same fields.
Distances [m] and angles [rad] are ROS's units too (REP 103). Facts are from RosAria, measured.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import cos, nan, sin
from typing import Any, Final

from pioneer3.geometry import Pose2, Twist2
from pioneer3.models import RobotModel
from pioneer3.robot.limits import checked
from pioneer3.ros.description.frames import Frames
from pioneer3.ros.description.tree import Tree
from pioneer3.ros.messages.conventions import DRIVING, STANDING, Conventions
from pioneer3.state import Bumpers, Charging, Odometry, Snapshot

RECHARGE_STATES: Final = {
    Charging.UNKNOWN: -1,
    Charging.NONE: 0,
    Charging.BULK: 1,
    Charging.OVERCHARGE: 2,
    Charging.FLOAT: 3,
    Charging.BALANCE: 4,
}
"""Numbers of `battery_recharge_state`; protocol.md 4.2, and -1 where the robot does not tell."""
ROSARIAS_BUMPERS: Final = 5
"""Segments in front, and as many behind."""
SUPPLY_STATUS: Final = {
    Charging.UNKNOWN: 0,
    Charging.NONE: 2,
    Charging.BULK: 1,
    Charging.OVERCHARGE: 1,
    Charging.FLOAT: 1,
    Charging.BALANCE: 1,
}
"""`POWER_SUPPLY_STATUS` of sensor_msgs/BatteryState: unknown, discharging, charging."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Reading:
    """What there is to convert.

    Attributes:
        snapshot: Of the robot.
        model: Of the robot.
        tree: Of the frames on it, without the prefix.
        frames: Names to use, with the prefix.
        conventions: How messages are to be.
        turned: Angles of the left wheels and of the right ones [rad].
        emergency: Whether the emergency stop is latched.
        stamp: When the snapshot arrived, as the middleware writes times.
        make: Returns an empty message of the type named, such as `geometry_msgs/Point32`.
    """

    snapshot: Snapshot
    model: RobotModel
    tree: Tree
    frames: Frames
    conventions: Conventions
    turned: tuple[float, float] = (0.0, 0.0)
    emergency: bool = False
    stamp: Any
    make: Callable[[str], Any]


def odometry(message: Any, reading: Reading) -> None:
    """Fill a nav_msgs/Odometry: pose in the odom frame, twist in the robot's own."""
    head(message, reading, reading.frames.odom)
    message.child_frame_id = reading.frames.base
    state = reading.snapshot.odometry
    pose, twist = message.pose, message.twist
    place(pose.pose.position, pose.pose.orientation, state.robot_in_odom)
    twist.twist.linear.x, twist.twist.angular.z = state.twist.v, state.twist.w
    pose.covariance = covariance(state, reading.conventions.pose_variances)
    twist.covariance = covariance(state, reading.conventions.twist_variances)


def covariance(state: Odometry, driving: Sequence[float] = DRIVING) -> list[float]:
    """Return the 36 numbers, row by row: x, y, z, roll, pitch, yaw on the diagonal."""
    still = state.left_speed == 0 and state.right_speed == 0
    matrix = [0.0] * 36
    matrix[::7] = map(min, STANDING, driving) if still else driving
    return matrix


def rosarias_bumpers(message: Any, reading: Reading) -> None:
    """Fill a rosaria/BumperState as :func:`bumpers`; a robot without has five that nothing touches.

    RosAria takes their number from a file, and its clients read five of each, unchecked.
    """
    bumpers(message, reading)
    message.front_bumpers = message.front_bumpers or [False] * ROSARIAS_BUMPERS
    message.rear_bumpers = message.rear_bumpers or [False] * ROSARIAS_BUMPERS


def bumpers(message: Any, reading: Reading) -> None:
    """Fill a rosaria/BumperState: both rows from left to right (protocol.md 4.7)."""
    head(message, reading, reading.frames.bumpers)
    message.front_bumpers, message.rear_bumpers = bumper_rows(reading.snapshot.bumpers)


def bumper_rows(state: Bumpers) -> tuple[list[bool], list[bool]]:
    """Return front and rear, each from left to right."""
    return list(state.front), list(reversed(state.rear))


def voltage(message: Any, reading: Reading) -> None:
    """Fill a std_msgs/Float64 [V]."""
    message.data = reading.snapshot.battery.voltage


def recharge_state(message: Any, reading: Reading) -> None:
    """Fill a std_msgs/Int8 with one of :data:`RECHARGE_STATES`."""
    message.data = RECHARGE_STATES[reading.snapshot.battery.charging]


def charge(message: Any, reading: Reading) -> None:
    """Fill a std_msgs/Float32, 0 to 1; NaN where the robot cannot tell."""
    known = reading.snapshot.battery.charge
    message.data = nan if known is None else known


def battery(message: Any, reading: Reading) -> None:
    """Fill a sensor_msgs/BatteryState; what the robot does not measure is NaN."""
    state = reading.snapshot.battery
    head(message, reading, reading.frames.base)
    message.voltage = state.voltage
    message.current = message.charge = message.capacity = message.design_capacity = nan
    if hasattr(message, "temperature"):  # not every version of the message has it
        message.temperature = nan
    message.percentage = nan if state.charge is None else state.charge
    message.power_supply_status = SUPPLY_STATUS[state.charging]
    message.power_supply_technology = getattr(message, "POWER_SUPPLY_TECHNOLOGY_VRLA", 0)
    message.present = True


def emergency_stop(message: Any, reading: Reading) -> None:
    """Fill a std_msgs/Bool: whether the robot is stopped, by our latch or by its own button."""
    message.data = stopped(reading)


def stopped(reading: Reading) -> bool:
    """Return whether the emergency stop is latched, or the robot's own button pressed."""
    return reading.emergency or reading.snapshot.motors.stop_button


def compass(message: Any, reading: Reading) -> None:
    """Fill a std_msgs/Float32 with the heading as the robot's compass states it [rad]."""
    message.data = reading.snapshot.inputs.compass


def digital(message: Any, reading: Reading) -> None:
    """Fill a std_msgs/UInt16: inputs in the low byte, outputs in the high one."""
    lines = reading.snapshot.inputs
    message.data = lines.digital_in & 0xFF | (lines.digital_out & 0xFF) << 8


def analog(message: Any, reading: Reading) -> None:
    """Fill a std_msgs/Float32MultiArray: the number of the selected port, and its voltage [V]."""
    lines = reading.snapshot.inputs
    message.data = [float(lines.analog_port), lines.analog]


def motors(message: Any, reading: Reading) -> None:
    """Fill a std_msgs/Bool: whether the motors have power."""
    message.data = reading.snapshot.motors.enabled


def wanted_twist(message: Any) -> Twist2:
    """Return what a geometry_msgs/Twist asks for: forward [m/s] and turning [rad/s].

    The rest of it means nothing to a robot that can neither fly nor go sideways.

    Raises:
        CommandError: not finite.
    """
    return checked(message.linear.x, message.angular.z)


def head(message: Any, reading: Reading, frame: str) -> None:
    """Fill a std_msgs/Header."""
    message.header.stamp, message.header.frame_id = reading.stamp, frame


def place(position: Any, orientation: Any, pose: Pose2) -> None:
    """Fill a position and a quaternion, which are empty."""
    position.x, position.y = pose.x, pose.y
    orientation.z, orientation.w = sin(pose.theta / 2), cos(pose.theta / 2)
