"""One robot: its button, its battery, its two poses."""

from math import pi

import pytest

from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.models import load_model
from pioneer3.sim.body import AMBIENT, EMPTY, FULL, Body
from pioneer3.sim.kernels.drives import CAPACITY, DRIVE_HEAT, DRIVE_POWER, IDLE_POWER
from pioneer3.sim.world import World
from tests.support import moves

MODEL = load_model("p3at-sh")


def driving(speed: float) -> Body:
    body = Body(MODEL)
    body.enable_motors(on=True)
    body.drive.linear.go(speed)
    return body


def test_the_stop_button_takes_the_power_and_keeps_it_while_pressed() -> None:
    body = Body(MODEL)
    body.enable_motors(on=True)
    body.stop_button = True
    assert not body.drive.powered
    body.enable_motors(on=True)
    assert not body.drive.powered
    body.stop_button = False
    assert not body.drive.powered
    body.enable_motors(on=True)
    assert body.drive.powered


def test_the_wheels_know_only_how_far_they_rolled() -> None:
    body = Body(MODEL, Pose2(2.0, 3.0, pi / 2))
    body.enable_motors(on=True)
    body.drive.linear.travel(1.0)
    World(None, [body]).step(8.0)
    assert (body.robot_in_world.x, body.robot_in_world.y) == pytest.approx((2.0, 4.0))
    assert (body.robot_in_odom.x, body.robot_in_odom.y) == pytest.approx((1.0, 0.0))
    assert body.wheel_travel == pytest.approx((1.0, 1.0))
    body.reset_odometry()
    assert body.robot_in_odom == ORIGIN
    assert body.robot_in_world.y == pytest.approx(4.0)


def test_a_turn_to_a_heading_takes_the_short_way() -> None:
    body = Body(MODEL)
    body.reset_odometry(Pose2(0, 0, pi - 0.1))
    body.turn_to(-pi + 0.1)
    assert body.drive.angular.remaining == pytest.approx(0.2)


def test_a_reset_brings_it_home_at_rest() -> None:
    body = Body(MODEL, Pose2(1, 1, 1))
    body.enable_motors(on=True)
    body.drive.linear.go(1.0)
    body.drive.linear.velocity = 1.0
    World(None, [body]).step(1.0)
    assert body.robot_in_world != body.home
    body.reset()
    assert (body.robot_in_world, body.robot_in_odom) == (Pose2(1, 1, 1), ORIGIN)
    assert not moves(body.drive)


def test_the_end_of_a_session_takes_the_power_and_what_the_host_has_set() -> None:
    body = Body(MODEL)
    body.enable_motors(on=True)
    body.drive.linear.deceleration, body.drive.linear.velocity = 9.0, 0.4
    body.drive.held = True
    body.reset_odometry(Pose2(1, 0, 0))
    body.session_ended()
    assert not body.drive.powered
    assert not body.drive.held
    assert body.drive.linear.deceleration == MODEL.deceleration
    assert body.drive.linear.velocity == 0.4  # wheels do not stop because a cable is out
    assert body.robot_in_odom == ORIGIN


def test_a_battery_falls_from_full_to_empty_and_no_further() -> None:
    body = Body(MODEL)
    assert body.battery.voltage == FULL
    World(None, [body]).step(100.0)
    assert CAPACITY - body.battery.energy == pytest.approx(100 * IDLE_POWER)
    body.battery.energy = CAPACITY / 2
    assert body.battery.voltage == pytest.approx((FULL + EMPTY) / 2)
    body.battery.energy = IDLE_POWER
    World(None, [body]).step(2.0)
    assert (body.battery.voltage, body.battery.charge) == (EMPTY, 0.0)


@pytest.mark.parametrize("speed", [0.5, -0.5])
def test_driving_costs_energy_and_voltage_both_ways(speed: float) -> None:
    body = driving(speed)
    body.drive.linear.velocity = speed
    World(None, [body]).step(100.0)
    assert CAPACITY - body.battery.energy == pytest.approx(100 * (IDLE_POWER + DRIVE_POWER / 2))
    rest = EMPTY + (FULL - EMPTY) * body.battery.charge
    assert body.battery.voltage < rest - 0.1


def test_motors_warm_up_while_they_drive_and_cool_down_again() -> None:
    body = driving(0.5)
    world = World(None, [body])
    assert body.motor_temperature == AMBIENT
    world.step(600.0)
    warm = body.motor_temperature
    assert AMBIENT + 5 < warm < AMBIENT + DRIVE_HEAT
    body.drive.stop()
    world.step(600.0)
    assert AMBIENT < body.motor_temperature < warm


def test_a_test_may_fix_the_voltage() -> None:
    body = driving(0.5)
    body.battery.fixed = 11.2
    World(None, [body]).step(10.0)
    assert body.battery.voltage == 11.2


def test_a_robot_taken_out_of_a_world_keeps_what_it_is_like() -> None:
    body, other = driving(0.5), driving(0.3)
    world = World(None, [body, other])
    world.step(1.0)
    pose, speed = body.robot_in_world, body.drive.linear.velocity
    world.remove(body)
    world.step(1.0)
    assert (body.robot_in_world, body.drive.linear.velocity) == (pose, speed)
    assert world.robots == (other,)
    assert other.drive.linear.velocity == 0.3
