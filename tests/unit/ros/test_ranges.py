from dataclasses import replace
from math import inf, pi

import pytest

from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.models.description.tree import Frames
from pioneer3.robot.devices.gyro import GyroReading
from pioneer3.ros.messages import sensors
from pioneer3.ros.messages.update import Beam, MessageOptions, NoEcho, ScanUpdate, SensorUpdate
from pioneer3.state import Scan, Sonar
from tests.unit.ros.support import Blank, seen, update


def test_a_range_says_what_its_transducer_hears_and_can_hear() -> None:
    message = Blank()
    sonar = Sonar(ranges=(*(inf,) * 3, 1.25, *(inf,) * 12))
    sensors.range_of(3)(message, update(seen(sonar=sonar), MessageOptions(prefix="r1/")))
    assert (message.header.stamp, message.header.frame_id) == ("now", "r1/sonar_3")
    assert message.radiation_type == 0
    assert message.field_of_view == pytest.approx(pi / 6, abs=1e-4)
    assert (message.min_range, message.max_range, message.range) == (0.15, 5.0, 1.25)


@pytest.mark.parametrize(
    ("metres", "as_number", "as_rep_117"),
    [(inf, 3.0, inf), (4.0, 3.0, inf), (3.0, 3.0, 3.0), (0.2, 0.2, 0.2), (0.1, 0.15, -inf)],
)
def test_without_an_echo_it_is_the_longest_range_or_infinity(
    metres: float, as_number: float, as_rep_117: float
) -> None:
    assert sensors.bounded_range(metres, Beam(farthest=3.0)) == as_number
    assert sensors.bounded_range(metres, Beam(farthest=3.0, no_echo=NoEcho.INF)) == as_rep_117


def make(type_name: str) -> Blank:
    """Return an empty message."""
    return Blank(kind=type_name)


def sweep(count: int) -> Scan:
    """Return a sweep over half a circle; the last reading hears nothing."""
    step = pi / max(count - 1, 1)
    return Scan(
        stamp=1.0,
        sequence=1,
        robot_in_odom=ORIGIN,
        sensor_in_robot=ORIGIN,
        angles=tuple(-pi / 2 + step * number for number in range(count)),
        ranges=(*(2.0,) * (count - 1), inf),
        reflectances=(32,) * count,
    )


def test_the_points_of_a_scan_are_where_the_robot_saw_them() -> None:
    message = Blank()
    scan = replace(sweep(3), robot_in_odom=Pose2(1.0, 2.0, pi / 2), sensor_in_robot=Pose2(0.5, 0.0))
    seen_from = ScanUpdate(scan=scan, stamp="then", frame="laser", odom="r1/odom", make=make)
    sensors.scan_cloud(message, seen_from)
    assert (message.header.stamp, message.header.frame_id) == ("then", "r1/odom")
    found = [(point.x, point.y, point.z) for point in message.points]
    assert found == [pytest.approx((3.0, 2.5, 0.0)), pytest.approx((1.0, 4.5, 0.0))]
    assert {point.kind for point in message.points} == {"geometry_msgs/Point32"}


def test_a_scan_goes_counter_clockwise_and_keeps_infinity() -> None:
    message = Blank()
    sensors.scan(
        message, ScanUpdate(scan=sweep(181), stamp="then", frame="laser", period=0.1, make=make)
    )
    assert (message.header.stamp, message.header.frame_id) == ("then", "laser")
    assert message.angle_min == pytest.approx(-pi / 2)
    assert message.angle_min + 180 * message.angle_increment == pytest.approx(message.angle_max)
    assert (len(message.ranges), message.ranges[-1]) == (181, inf)
    assert message.range_min <= 2.0 < message.range_max
    assert message.intensities == [32.0] * 181
    assert (message.scan_time, message.time_increment) == (0.1, 0.0)


def test_a_scan_of_one_reading_has_no_step() -> None:
    message = Blank()
    sensors.scan(message, ScanUpdate(scan=sweep(1), stamp="then", frame="laser", make=make))
    assert message.angle_increment == 0.0


def test_a_gyro_tells_the_rate_of_turning_and_nothing_else() -> None:
    message = Blank()
    gyro = GyroReading(stamp=1.0, heading=0.5, rate=-0.25, temperature_raw=3)
    sensors.imu(message, SensorUpdate(reading=gyro, stamp="then", frames=Frames()))
    assert (message.header.stamp, message.header.frame_id) == ("then", "imu_link")
    assert message.angular_velocity.z == -0.25
    assert message.orientation_covariance[0] == message.linear_acceleration_covariance[0] == -1
    assert 0 < message.angular_velocity_covariance[8] < 1e-3
    assert message.angular_velocity_covariance[0] == message.angular_velocity_covariance[4] == 1e6
