"""Ramps, trapezoids and arcs, each number derived by hand."""

from dataclasses import replace
from math import pi

import pytest

from pioneer3.geometry import wrap
from pioneer3.models import load_model
from pioneer3.sim.body import Body
from pioneer3.sim.kernels import Kernels
from pioneer3.sim.kernels.drives import HARDEST, SUBSTEP
from pioneer3.sim.world import World
from tests.support import moves

MODEL = replace(
    load_model("p3dx-sh"),
    acceleration=0.5,
    deceleration=1.0,
    max_speed=1.0,
    turn_acceleration=2.0,
    turn_deceleration=2.0,
    max_turn_rate=2.0,
)


@pytest.fixture(scope="module")
def kernels() -> Kernels:
    return Kernels()


class Bench:
    """A robot on an empty plane."""

    def __init__(self, kernels: Kernels, speed: float = 0.0) -> None:
        self.body = Body(MODEL)
        self.world = World(None, [self.body], kernels)
        self.drive, self.axis = self.body.drive, self.body.drive.linear
        self.drive.power(on=True)
        self.axis.top = 1.0
        self.drive.angular.top = 2.0
        self.axis.velocity = speed

    def run(self, seconds: float, dt: float = SUBSTEP) -> float:
        """Let time pass; return the way covered."""
        before = self.body.robot_in_odom.x
        for _ in range(round(seconds / dt)):
            self.world.step(dt)
        return self.body.robot_in_odom.x - before


def test_speeding_up_follows_the_acceleration(kernels: Kernels) -> None:
    bench = Bench(kernels)
    bench.axis.go(0.4)
    assert bench.run(0.5) == pytest.approx(0.5 * 0.5 * 0.5**2)  # a t^2 / 2
    assert bench.axis.velocity == pytest.approx(0.25)
    bench.run(0.5)
    assert bench.axis.velocity == 0.4


def test_slowing_down_follows_the_deceleration(kernels: Kernels) -> None:
    bench = Bench(kernels, 0.8)
    bench.axis.go(0.0)
    assert bench.run(1.0) == pytest.approx(0.8**2 / 2 / 1.0)  # v^2 / 2a
    assert bench.axis.velocity == 0.0


def test_turning_round_passes_through_zero_with_both_ramps(kernels: Kernels) -> None:
    bench = Bench(kernels, 0.5)
    bench.axis.go(-0.5)
    way = bench.run(0.5 / 1.0 + 0.5 / 0.5)
    assert way == pytest.approx(0.5**2 / 2 / 1.0 - 0.5**2 / 2 / 0.5)
    assert bench.axis.velocity == pytest.approx(-0.5)


def test_no_command_goes_beyond_the_top_speed(kernels: Kernels) -> None:
    bench = Bench(kernels)
    bench.axis.go(99.0)
    bench.run(5)
    assert bench.axis.velocity == 1.0
    bench.axis.go(-99.0)
    bench.run(5)
    assert bench.axis.velocity == -1.0


@pytest.mark.parametrize("dt", [0.1, 0.02, 0.01, 0.003])
def test_the_length_of_a_step_does_not_change_a_ramp(kernels: Kernels, dt: float) -> None:
    bench = Bench(kernels)
    bench.axis.go(0.3)
    assert bench.run(1.2, dt) == pytest.approx(0.3**2 / 2 / 0.5 + 0.3 * 0.6, rel=1e-9)


def test_without_a_ramp_the_speed_is_there_at_once(kernels: Kernels) -> None:
    bench = Bench(kernels)
    bench.axis.acceleration = bench.axis.deceleration = 0.0
    bench.axis.go(0.3)
    assert bench.run(1.0) == pytest.approx(0.3)
    bench.axis.go(-0.3)
    assert bench.run(1.0) == pytest.approx(-0.3)


@pytest.mark.parametrize("dt", [0.1, 0.02])
@pytest.mark.parametrize("distance", [1.0, -1.0, 0.05, 3.0])
def test_a_distance_is_covered_exactly_and_ends_at_rest(
    kernels: Kernels, distance: float, dt: float
) -> None:
    bench = Bench(kernels)
    bench.axis.travel(distance)
    assert bench.run(20, dt) == pytest.approx(distance, abs=1e-9)
    assert bench.axis.velocity == 0.0
    assert bench.axis.remaining is None


def test_a_short_distance_is_a_triangle_a_long_one_a_trapezoid(kernels: Kernels) -> None:
    bench, fastest = Bench(kernels), []
    for distance in (0.3, 5.0):
        bench.axis.travel(distance)
        speeds = [0.0]
        while bench.axis.remaining is not None:
            bench.world.step(SUBSTEP)
            speeds.append(bench.axis.velocity)
        fastest.append(max(speeds))
    # v^2 (1/2a + 1/2d) = s
    assert fastest[0] == pytest.approx((0.3 / (1 / 1.0 + 1 / 2.0)) ** 0.5, rel=0.03)
    assert fastest[1] == pytest.approx(1.0)


def test_a_velocity_ends_a_distance(kernels: Kernels) -> None:
    bench = Bench(kernels)
    bench.axis.travel(5.0)
    bench.run(1)
    bench.axis.go(0.0)
    bench.run(2)
    assert bench.axis.velocity == 0.0
    assert bench.axis.remaining is None


@pytest.mark.parametrize("distance", [None, 2.0])
def test_held_it_brakes_and_remembers(kernels: Kernels, distance: float | None) -> None:
    bench = Bench(kernels)
    if distance is None:
        bench.axis.go(0.5)
    else:
        bench.axis.travel(distance)
    bench.run(1)
    bench.drive.held = True
    bench.run(2)
    assert bench.axis.velocity == 0.0
    bench.drive.held = False
    bench.run(1)
    assert bench.axis.velocity == pytest.approx(0.5)


def test_a_full_turn_on_the_spot_goes_nowhere(kernels: Kernels) -> None:
    bench = Bench(kernels)
    bench.drive.angular.travel(2 * pi)
    turned = 0.0
    for _ in range(500):
        before = bench.body.robot_in_world.theta
        bench.world.step(SUBSTEP)
        turned += wrap(bench.body.robot_in_world.theta - before)
    assert turned == pytest.approx(2 * pi)
    assert (bench.body.robot_in_world.x, bench.body.robot_in_world.y) == (0, 0)
    half = pi * MODEL.wheel_base
    assert bench.body.wheel_travel == pytest.approx((-half, half))


def test_without_power_it_obeys_nothing_and_the_wheels_brake_hard(kernels: Kernels) -> None:
    bench = Bench(kernels, 1.0)
    bench.drive.power(on=False)
    assert not bench.drive.obeys
    bench.run(1.0 / HARDEST + SUBSTEP)
    assert bench.axis.velocity == 0.0


def test_an_emergency_stop_brakes_hard_and_obeys_again_once_it_stands(kernels: Kernels) -> None:
    bench = Bench(kernels, 1.0)
    bench.drive.emergency_stop()
    assert not bench.drive.obeys
    assert bench.run(0.4) == pytest.approx(1.0 / 2 / HARDEST)
    assert bench.drive.obeys


def test_an_emergency_stop_at_rest_leaves_it_obedient(kernels: Kernels) -> None:
    bench = Bench(kernels)
    bench.drive.emergency_stop()
    assert not moves(bench.drive)
    assert bench.drive.obeys


def test_it_moves_while_anything_turns_or_is_about_to(kernels: Kernels) -> None:
    drive = Bench(kernels).drive
    assert not moves(drive)
    drive.angular.go(0.1)
    assert moves(drive)
    drive.power(on=False)
    assert not moves(drive)
    drive.linear.velocity = 0.1
    assert moves(drive)
    drive.halt()
    assert not moves(drive)


def test_an_arc_ends_where_geometry_says(kernels: Kernels) -> None:
    bench = Bench(kernels, 0.5)
    bench.axis.go(0.5)
    bench.drive.angular.velocity = 0.5
    bench.drive.angular.go(0.5)
    bench.run(pi, 0.1 * pi / 3.1)  # a quarter of a circle of 1 m
    pose = bench.body.robot_in_world
    assert (pose.x, pose.y, pose.theta) == pytest.approx((1.0, 1.0, pi / 2), abs=0.02)
