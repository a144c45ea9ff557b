"""Single ranges and scans to ROS messages."""

from collections.abc import Callable
from math import inf
from typing import Any, Final

from pioneer3.robot.devices.gyro import GyroReading
from pioneer3.ros.messages.conventions import UNMEASURED, Beam, NoEcho
from pioneer3.ros.messages.convert import Reading, head
from pioneer3.state import Scan

ULTRASOUND: Final = 0
"""`Range.ULTRASOUND`."""
SCAN_MAX: Final = 32.766
"""Farthest that a simulator's laser can tell [m] (protocol.md 5.13)."""
GYRO_VARIANCE: Final = 2.8e-4
"""Of a rate [rad^2/s^2]: a step of the converter is 0.95 degrees per second (protocol.md 5.4)."""
NOT_THERE: Final = [-1.0, *[0.0] * 8]
"""Covariance that says that a sensor does not measure this (sensor_msgs/Imu)."""


def range_of(number: int) -> Callable[[Any, Reading], None]:
    """Return what fills a sensor_msgs/Range of one transducer, which looks along its frame's x."""

    def fill(message: Any, reading: Reading) -> None:
        beam = reading.conventions.beam
        head(message, reading, reading.frames.transducer(number))
        message.radiation_type = ULTRASOUND
        message.field_of_view = beam.field_of_view
        message.min_range, message.max_range = beam.nearest, beam.farthest
        message.range = told_range(reading.snapshot.sonar.ranges[number], beam)

    return fill


def told_range(metres: float, beam: Beam) -> float:
    """Return what a Range says of a range of `metres`, `inf` where nothing was heard [m]."""
    if metres > beam.farthest:
        return inf if beam.no_echo is NoEcho.INF else beam.farthest
    if metres < beam.nearest:
        return -inf if beam.no_echo is NoEcho.INF else beam.nearest
    return metres


def scan(message: Any, sweep: Scan, *, stamp: Any, frame: str, period: float) -> None:
    """Fill a sensor_msgs/LaserScan; `inf` where nothing answered (REP 117).

    `period` is the time from one sweep to the next [s], 0 where that is not known.
    """
    message.header.stamp, message.header.frame_id = stamp, frame
    count = len(sweep.angles)
    message.angle_min, message.angle_max = sweep.angles[0], sweep.angles[-1]
    span = message.angle_max - message.angle_min
    message.angle_increment = span / (count - 1) if count > 1 else 0.0
    message.time_increment, message.scan_time = 0.0, period  # simulators look all at once
    message.range_min, message.range_max = 0.0, SCAN_MAX
    message.ranges = list(sweep.ranges)
    message.intensities = list(map(float, sweep.reflectances))


def imu(message: Any, gyro: GyroReading, *, stamp: Any, frame: str) -> None:
    """Fill a sensor_msgs/Imu: the rate of turning, and that there is nothing else."""
    message.header.stamp, message.header.frame_id = stamp, frame
    message.orientation.w = 1.0
    message.orientation_covariance = list(NOT_THERE)
    message.linear_acceleration_covariance = list(NOT_THERE)
    message.angular_velocity.z = gyro.rate
    variances = [0.0] * 9
    variances[::4] = UNMEASURED, UNMEASURED, GYRO_VARIANCE
    message.angular_velocity_covariance = variances
