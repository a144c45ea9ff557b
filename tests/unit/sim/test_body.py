"""One robot: its button, its battery, its two poses."""

from math import pi

import pytest

from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.models import load_model
from pioneer3.sim.body import CAPACITY, DRIVE_POWER, EMPTY, FULL, IDLE_POWER, Battery, Body

MODEL = load_model("p3at-sh")


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
    body.advance(Pose2(1.0, 0.0, pi / 2))
    assert (body.robot_in_world.x, body.robot_in_world.y) == pytest.approx((2.0, 4.0))
    assert body.robot_in_odom == Pose2(1.0, 0.0, pi / 2)
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
    body.advance(Pose2(5, 0, 0))
    body.reset()
    assert (body.robot_in_world, body.robot_in_odom) == (Pose2(1, 1, 1), ORIGIN)
    assert not body.drive.moves


def test_the_end_of_a_session_takes_the_power_and_what_the_host_has_set() -> None:
    body = Body(MODEL)
    body.enable_motors(on=True)
    body.drive.linear.deceleration, body.drive.linear.velocity = 9.0, 0.4
    body.drive.held = True
    body.advance(Pose2(1, 0, 0))
    body.session_ended()
    assert not body.drive.powered
    assert not body.drive.held
    assert body.drive.linear.deceleration == MODEL.deceleration
    assert body.drive.linear.velocity == 0.4  # wheels do not stop because a cable is out
    assert body.robot_in_odom == ORIGIN


def test_a_battery_falls_from_full_to_empty_and_no_further() -> None:
    battery = Battery()
    assert battery.voltage == FULL
    battery.drain(0.0, CAPACITY / IDLE_POWER / 2)
    assert battery.voltage == pytest.approx((FULL + EMPTY) / 2)
    battery.drain(0.0, CAPACITY)
    assert battery.voltage == EMPTY


def test_driving_costs_energy_both_ways() -> None:
    for speed in (0.5, -0.5):
        battery = Battery()
        battery.drain(speed, 100)
        assert CAPACITY - battery.energy == pytest.approx(100 * (IDLE_POWER + DRIVE_POWER / 2))


def test_a_test_may_fix_the_voltage() -> None:
    battery = Battery(fixed=11.2)
    battery.drain(1.0, 1000)
    assert battery.voltage == 11.2
