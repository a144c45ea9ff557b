import struct
from math import cos, inf, isnan, nan, pi, sin

import pytest

from pioneer3.arcos import commands
from pioneer3.errors import CommandError
from pioneer3.geometry import Pose2, Twist2
from pioneer3.ros.messages import motion, sensors
from pioneer3.ros.messages.update import MessageOptions
from pioneer3.state import Battery, Bumpers, Charging, Inputs, Motors
from tests.unit.ros.support import Blank, seen, update


def test_odometry_is_a_pose_in_odom_and_a_twist_of_the_robot() -> None:
    message = Blank()
    snapshot = seen(Pose2(1.5, -0.25, pi / 2), Twist2(0.3, -0.1), left=0.3, right=0.3)
    motion.odometry(message, update(snapshot))
    assert (message.header.stamp, message.header.frame_id) == ("now", "odom")
    assert message.child_frame_id == "base_footprint"
    assert (message.pose.pose.position.x, message.pose.pose.position.y) == (1.5, -0.25)
    turned = message.pose.pose.orientation
    assert (turned.z, turned.w) == pytest.approx((0.5**0.5, 0.5**0.5))
    assert (message.twist.twist.linear.x, message.twist.twist.angular.z) == (0.3, -0.1)


def test_the_robot_is_in_tf_where_odometry_has_it() -> None:
    tf, now = Blank(), update(seen(Pose2(1.5, -0.25, 2.0)))
    motion.moving_transforms(tf, now)
    (transform,) = tf.transforms
    assert (transform.header.frame_id, transform.child_frame_id) == ("odom", "base_footprint")
    at, turned = transform.transform.translation, transform.transform.rotation
    assert (at.x, at.y, at.z) == (1.5, -0.25, 0.0)
    assert (turned.x, turned.y) == (0.0, 0.0)
    assert (turned.z, turned.w) == pytest.approx((sin(1.0), cos(1.0)))


@pytest.mark.parametrize("speed", [0.0, 0.2])
def test_no_variance_is_zero_and_standing_still_is_surer(speed: float) -> None:
    matrix = motion.covariance(seen(left=speed, right=speed).odometry)
    assert len(matrix) == 36
    diagonal = matrix[::7]
    assert min(diagonal) > 0
    assert sum(matrix) == pytest.approx(sum(diagonal))
    assert diagonal[0] == (1e-3 if speed else 1e-9)
    assert diagonal[2:5] == [1e6, 1e6, 1e6]


def test_a_robot_without_bumpers_has_five_and_five_for_rosarias_clients_only() -> None:
    told, honest = Blank(), Blank()
    sensors.rosarias_bumpers(told, update(seen()))
    sensors.bumpers(honest, update(seen()))
    assert (told.front_bumpers, told.rear_bumpers) == ([False] * 5, [False] * 5)
    assert (honest.front_bumpers, honest.rear_bumpers) == ([], [])
    touched = Bumpers(front=(True, False, False), rear=(False, True))
    sensors.rosarias_bumpers(told, update(seen(bumpers=touched)))
    assert (told.front_bumpers, told.rear_bumpers) == ([True, False, False], [True, False])


def test_bumpers_read_from_left_to_right_in_front_and_in_the_rear() -> None:
    leftmost_in_front, rightmost_in_rear = (True, False, False, False, False), (True, *(False,) * 4)
    message = Blank()
    touched = Bumpers(front=leftmost_in_front, rear=rightmost_in_rear)
    sensors.bumpers(message, update(seen(bumpers=touched)))
    assert message.header.frame_id == "bumpers"
    assert message.front_bumpers == [True, False, False, False, False]
    assert message.rear_bumpers == [False, False, False, False, True]


@pytest.mark.parametrize(
    ("charging", "number"),
    [
        (Charging.UNKNOWN, -1),
        (Charging.NONE, 0),
        (Charging.BULK, 1),
        (Charging.OVERCHARGE, 2),
        (Charging.FLOAT, 3),
        (Charging.BALANCE, 4),
    ],
)
def test_recharge_states_have_arias_numbers(charging: Charging, number: int) -> None:
    message = Blank()
    sensors.recharge_state(message, update(seen(battery=Battery(voltage=12.0, charging=charging))))
    assert message.data == number


def test_the_battery_in_numbers() -> None:
    volts, part, whole = Blank(), Blank(), Blank()
    full = update(seen(battery=Battery(voltage=12.7, charge=0.8, charging=Charging.FLOAT)))
    sensors.voltage(volts, full)
    sensors.charge(part, full)
    sensors.battery(whole, full)
    assert (volts.data, part.data) == (12.7, 0.8)
    assert (whole.voltage, whole.percentage, whole.power_supply_status) == (12.7, 0.8, 1)
    assert all(map(isnan, (whole.current, whole.charge, whole.capacity, whole.design_capacity)))
    assert whole.present is True


def test_a_charge_that_the_robot_cannot_tell_is_no_number() -> None:
    part, whole = Blank(), Blank()
    sensors.charge(part, update(seen()))
    sensors.battery(whole, update(seen()))
    assert isnan(part.data)
    assert isnan(whole.percentage)


def test_motors_are_on_or_off() -> None:
    message = Blank()
    for on in (True, False):
        sensors.motors(message, update(seen(motors=Motors(enabled=on))))
        assert message.data is on


@pytest.mark.parametrize(
    ("latched", "pressed", "stopped"),
    [(False, False, False), (True, False, True), (False, True, True), (True, True, True)],
)
def test_it_is_stopped_by_the_latch_or_by_its_own_button(
    latched: bool, pressed: bool, stopped: bool
) -> None:
    message = Blank()
    now = update(seen(motors=Motors(stop_button=pressed)), emergency=latched)
    sensors.emergency_stop(message, now)
    assert message.data is stopped


def test_lines_are_bits_of_a_word_and_a_port_with_its_voltage() -> None:
    bits, volts = Blank(), Blank()
    now = update(seen(inputs=Inputs(digital_in=3, digital_out=0x81, analog=2.5, analog_port=4)))
    sensors.digital(bits, now)
    sensors.analog(volts, now)
    assert bits.data == 0x8103
    assert volts.data == [4.0, 2.5]


def test_variances_that_are_given_hold_while_it_drives() -> None:
    message = Blank()
    chosen = MessageOptions(pose_variances=(1.0,) * 6, twist_variances=(2.0,) * 6)
    motion.odometry(message, update(seen(left=0.1), chosen))
    assert (message.pose.covariance[::7], message.twist.covariance[::7]) == ([1.0] * 6, [2.0] * 6)
    motion.odometry(message, update(seen(), chosen))
    assert message.pose.covariance[0] == message.twist.covariance[0] == 1e-9


def twist(v: float, w: float) -> Blank:
    return Blank(linear=Blank(x=v, y=9.0, z=nan), angular=Blank(x=9.0, y=nan, z=w))


def test_a_twist_is_what_a_robot_on_wheels_can_do_of_it() -> None:
    assert motion.wanted_twist(twist(0.5, -0.2)) == Twist2(0.5, -0.2)


@pytest.mark.parametrize(("rate", "degrees"), [(0.4, 23), (0.5, 29), (0.3, 17), (-0.5, -29)])
def test_a_turn_rate_is_rounded_on_the_wire(rate: float, degrees: int) -> None:
    wanted = motion.wanted_twist(twist(0.0, rate))
    payload = commands.to_payload(commands.RVel(rate=wanted.w))
    kind, number = payload[1], struct.unpack("<H", payload[2:4])[0]
    assert (number if kind == 0x3B else -number) == degrees


@pytest.mark.parametrize("bad", [nan, inf, -inf])
def test_what_is_no_number_is_refused(bad: float) -> None:
    for message in (twist(bad, 0.0), twist(0.0, bad)):
        with pytest.raises(CommandError):
            motion.wanted_twist(message)
