"""Sonars, laser, camera, gyro, bumpers, battery and inputs to ROS messages."""

import struct
from collections.abc import Callable, Sequence
from math import cos, inf, isfinite, nan, sin, tan
from typing import Any, Final

from pioneer3.models import RobotModel, SonarMount, shape_of
from pioneer3.models.description.tree import BUMPER_HEIGHT, bumper_segments
from pioneer3.robot.assemble import SONAR_MAX
from pioneer3.ros.messages.update import (
    UNMEASURED,
    Beam,
    NoEcho,
    PictureUpdate,
    ScanUpdate,
    SensorUpdate,
    StateUpdate,
    fill_header,
    resized,
)
from pioneer3.state import Bumpers, Charging, Sonar

FLOAT32: Final = 7
"""`PointField.FLOAT32`."""
ULTRASOUND: Final = 0
"""`Range.ULTRASOUND`."""
SCAN_MAX: Final = 32.766
"""Longest range of a simulator's laser [m] (protocol.md 5.13)."""
GYRO_VARIANCE: Final = 2.8e-4
"""Variance of a rate [rad^2/s^2]: the converter's step is 0.95 degrees/s (protocol.md 5.4)."""
NOT_THERE: Final = [-1.0, *[0.0] * 8]
"""Covariance of a quantity that a sensor does not measure (sensor_msgs/Imu)."""
RECHARGE_STATES: Final = {
    Charging.UNKNOWN: -1,
    Charging.NONE: 0,
    Charging.BULK: 1,
    Charging.OVERCHARGE: 2,
    Charging.FLOAT: 3,
    Charging.BALANCE: 4,
}
"""Numbers of `battery_recharge_state`; protocol.md 4.2, and -1 while it is not known."""
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


def rosarias_bumpers(message: Any, update: StateUpdate) -> None:
    """Fill a rosaria/BumperState as :func:`bumpers`; a robot without has five that nothing touches.

    RosAria takes their number from a file, and its clients read five of each, unchecked.
    """
    bumpers(message, update)
    message.front_bumpers = message.front_bumpers or [False] * ROSARIAS_BUMPERS
    message.rear_bumpers = message.rear_bumpers or [False] * ROSARIAS_BUMPERS


def bumpers(message: Any, update: StateUpdate) -> None:
    """Fill a rosaria/BumperState: both rows from left to right (protocol.md 4.7)."""
    fill_header(message, update.stamp, update.frames.bumpers)
    message.front_bumpers, message.rear_bumpers = bumper_rows(update.snapshot.bumpers)


def bumper_array(message: Any, update: StateUpdate) -> None:
    """Fill a std_msgs/UInt8MultiArray: a row for the front and one for the rear, 1 for pressed.

    Both are from left to right, and as long as the longer one.
    """
    fill_rows(message, update.make, *map(bytes, bumper_rows(update.snapshot.bumpers)))


def fill_rows(message: Any, make: Callable[[str], Any], front: bytes, rear: bytes) -> None:
    """Fill a std_msgs/UInt8MultiArray as :func:`bumper_array` has it."""
    length = max(len(front), len(rear))
    message.layout.dim = []
    for label, size, stride in (("front, rear", 2, 2 * length), ("segment", length, length)):
        dimension = make("std_msgs/MultiArrayDimension")
        dimension.label, dimension.size, dimension.stride = label, size, stride
        message.layout.dim.append(dimension)
    message.data = b"".join(row.ljust(length, b"\0") for row in (front, rear))


def bumper_rows(state: Bumpers) -> tuple[list[bool], list[bool]]:
    """Return front and rear, each from left to right."""
    return list(state.front), list(reversed(state.rear))


def touches(message: Any, update: StateUpdate) -> None:
    """Fill a sensor_msgs/PointCloud2 with the middle of each bumper segment that is pressed."""
    fill_header(message, update.stamp, update.frames.base)
    state, model = update.snapshot.bumpers, update.model
    pressed = [
        (pose.x, pose.y)
        for segments, rear in ((state.front, False), (state.rear, True))
        if any(segments)
        for pose, hit in zip(
            bumper_segments(model, len(segments), rear=rear), segments, strict=True
        )
        if hit
    ]
    _cloud2(message, update.make, pressed, BUMPER_HEIGHT)
    message.is_dense = True


def _data(value_of: Callable[[StateUpdate], object]) -> Callable[[Any, StateUpdate], None]:
    """Return the function that fills a message whose only field is `data`."""

    def fill(message: Any, update: StateUpdate) -> None:
        message.data = value_of(update)

    return fill


voltage = _data(lambda update: update.snapshot.battery.voltage)
"""Fills a std_msgs/Float64 [V]."""
recharge_state = _data(lambda update: RECHARGE_STATES[update.snapshot.battery.charging])
"""Fills a std_msgs/Int8 with one of :data:`RECHARGE_STATES`."""
charge = _data(lambda update: _known(update.snapshot.battery.charge))
"""Fills a std_msgs/Float32, 0 to 1; NaN where the robot does not know."""
emergency_stop = _data(lambda update: update.stopped)
"""Fills a std_msgs/Bool: whether the robot is stopped, by our latch or by its own button."""
compass = _data(lambda update: update.snapshot.inputs.compass)
"""Fills a std_msgs/Float32 with the heading as the robot's compass states it [rad]."""
motors = _data(lambda update: update.snapshot.motors.enabled)
"""Fills a std_msgs/Bool: whether the motors have power."""


def _known(charge: float | None) -> float:
    return nan if charge is None else charge


def battery(message: Any, update: StateUpdate) -> None:
    """Fill a sensor_msgs/BatteryState, with NaN for all that the robot does not measure."""
    state = update.snapshot.battery
    fill_header(message, update.stamp, update.frames.base)
    message.voltage = state.voltage
    message.current = message.charge = message.capacity = message.design_capacity = nan
    if hasattr(message, "temperature"):  # not every version of the message has it
        message.temperature = nan
    message.percentage = _known(state.charge)
    message.power_supply_status = SUPPLY_STATUS[state.charging]
    message.power_supply_technology = getattr(message, "POWER_SUPPLY_TECHNOLOGY_VRLA", 0)
    message.present = True


def digital(message: Any, update: StateUpdate) -> None:
    """Fill a std_msgs/UInt16: inputs in the low byte, outputs in the high one."""
    lines = update.snapshot.inputs
    message.data = lines.digital_in & 0xFF | (lines.digital_out & 0xFF) << 8


def analog(message: Any, update: StateUpdate) -> None:
    """Fill a std_msgs/Float32MultiArray: the number of the selected port, and its voltage [V]."""
    lines = update.snapshot.inputs
    message.data = [float(lines.analog_port), lines.analog]


def sonar_cloud(message: Any, update: StateUpdate) -> None:
    """Fill a sensor_msgs/PointCloud with a point for every transducer, in their order."""
    fill_header(message, update.stamp, update.frames.sonar)
    heard = sonar_points(update.snapshot.sonar, update.model)
    message.points = resized(message.points, len(heard), "geometry_msgs/Point32", update.make)
    for point, (x, y) in zip(message.points, heard, strict=True):
        point.x, point.y, point.z = x, y, 0.0


def sonar_cloud2(message: Any, update: StateUpdate) -> None:
    """Fill a sensor_msgs/PointCloud2 with a point for every transducer, in their order."""
    fill_header(message, update.stamp, update.frames.sonar)
    _cloud2(message, update.make, sonar_points(update.snapshot.sonar, update.model))
    message.is_dense = False  # as RosAria says it, though every point is a number


def echoes(message: Any, update: StateUpdate) -> None:
    """Fill a sensor_msgs/PointCloud2 with the echoes since the last update.

    Echoes that are older belong to a place where the robot no longer is, so they are left out.
    """
    fill_header(message, update.stamp, update.frames.base)
    sonar, height = update.snapshot.sonar, update.options.sonar_height
    mounts = update.model.sonars
    heard = [
        _echo(mounts[number], sonar.ranges[number])
        for number in sonar.fresh
        if number < len(mounts) and isfinite(sonar.ranges[number])
    ]
    usual = shape_of(update.model).sonar_height
    _cloud2(message, update.make, heard, usual if height is None else height)
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
        points.append(_echo(mount, metres))
    return points


def _echo(mount: SonarMount, metres: float) -> tuple[float, float]:
    """Return where an echo came from, in the robot's frame [m]."""
    return mount.x + metres * cos(mount.theta), mount.y + metres * sin(mount.theta)


def _cloud2(
    message: Any,
    make: Callable[[str], Any],
    points: Sequence[tuple[float, float]],
    height: float = 0.0,
) -> None:
    """One row of points, three 32-bit floats each."""
    if not message.fields:
        message.fields = [_number_of_point(make, *each) for each in ((0, "x"), (4, "y"), (8, "z"))]
    message.height, message.width = 1, len(points)
    message.is_bigendian = False
    message.point_step, message.row_step = 12, 12 * len(points)
    message.data = b"".join(struct.pack("<3f", x, y, height) for x, y in points)


def _number_of_point(make: Callable[[str], Any], offset: int, name: str) -> Any:
    """Return a sensor_msgs/PointField."""
    field = make("sensor_msgs/PointField")
    field.name, field.offset, field.datatype, field.count = name, offset, FLOAT32, 1
    return field


def range_of(number: int) -> Callable[[Any, StateUpdate], None]:
    """Return the function that fills a sensor_msgs/Range of one transducer, along its frame's x."""

    def fill(message: Any, update: StateUpdate) -> None:
        beam = update.options.beam
        fill_header(message, update.stamp, update.frames.transducer(number))
        message.radiation_type = ULTRASOUND
        message.field_of_view = beam.field_of_view
        message.min_range, message.max_range = beam.nearest, beam.farthest
        message.range = bounded_range(update.snapshot.sonar.ranges[number], beam)

    return fill


def bounded_range(metres: float, beam: Beam) -> float:
    """Return `metres`, `inf` without an echo, as a Range within its bounds [m]."""
    if metres > beam.farthest:
        return inf if beam.no_echo is NoEcho.INF else beam.farthest
    if metres < beam.nearest:
        return -inf if beam.no_echo is NoEcho.INF else beam.nearest
    return metres


def scan(message: Any, update: ScanUpdate) -> None:
    """Fill a sensor_msgs/LaserScan; `inf`, `-inf` and NaN as in REP 117."""
    sweep = update.scan
    fill_header(message, update.stamp, update.frame)
    count = len(sweep.angles)
    message.angle_min, message.angle_max = sweep.angles[0], sweep.angles[-1]
    span = message.angle_max - message.angle_min
    message.angle_increment = span / (count - 1) if count > 1 else 0.0
    message.time_increment, message.scan_time = sweep.beam_time, update.period
    message.range_min = sweep.near
    message.range_max = sweep.far if isfinite(sweep.far) else SCAN_MAX
    message.ranges = list(sweep.ranges)
    message.intensities = list(map(float, sweep.reflectances))


def scan_cloud(message: Any, update: ScanUpdate) -> None:
    """Fill a sensor_msgs/PointCloud with the echoes of a scan, in the frame of odometry."""
    fill_header(message, update.stamp, update.odom)
    message.points = []
    for x, y in update.scan.points_in_odom():
        point = update.make("geometry_msgs/Point32")
        point.x, point.y, point.z = x, y, 0.0
        message.points.append(point)


def imu(message: Any, update: SensorUpdate) -> None:
    """Fill a sensor_msgs/Imu: the rate of turning, and that there is nothing else."""
    fill_header(message, update.stamp, update.frames.imu)
    message.orientation.w = 1.0
    message.orientation_covariance = list(NOT_THERE)
    message.linear_acceleration_covariance = list(NOT_THERE)
    message.angular_velocity.z = update.reading.rate
    variances = [0.0] * 9
    variances[::4] = UNMEASURED, UNMEASURED, GYRO_VARIANCE
    message.angular_velocity_covariance = variances


def image(message: Any, update: PictureUpdate) -> None:
    """Fill a sensor_msgs/Image as `rgb8`."""
    pixels = update.image.pixels
    fill_header(message, update.stamp, update.frame)
    message.height, message.width = pixels.shape[:2]
    message.encoding, message.is_bigendian = "rgb8", 0
    message.step = 3 * message.width
    message.data = pixels.tobytes()


def camera_info(message: Any, update: PictureUpdate) -> None:
    """Fill a sensor_msgs/CameraInfo of a pinhole without distortion.

    Its matrices are 0, which means that it is not calibrated, where nobody tells the field of view.
    """
    fill_header(message, update.stamp, update.frame)
    message.height, message.width = height, width = update.image.pixels.shape[:2]
    message.distortion_model, message.D = "plumb_bob", [0.0] * 5
    message.R = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
    message.K, message.P = [0.0] * 9, [0.0] * 12
    if update.view is None:
        return
    focal = width / 2 / tan(update.view / 2)
    x, y = (width - 1) / 2, (height - 1) / 2  # the middle of the first pixel is at 0, 0
    message.K = [focal, 0.0, x, 0.0, focal, y, 0.0, 0.0, 1.0]
    message.P = [focal, 0.0, x, 0.0, 0.0, focal, y, 0.0, 0.0, 0.0, 1.0, 0.0]
