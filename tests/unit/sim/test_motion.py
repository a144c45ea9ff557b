"""Ramps, trapezoids and arcs, each number derived by hand."""

from math import pi

import pytest

from pioneer3.sim.motion import HARDEST, SUBSTEP, Axis, Drive


def axis(velocity: float = 0.0) -> Axis:
    return Axis(acceleration=0.5, deceleration=1.0, top=1.0, velocity=velocity)


def run(moved: Axis, seconds: float, dt: float = SUBSTEP, *, held: bool = False) -> float:
    """Let time pass; return the way covered."""
    return sum(moved.step(dt, held=held) for _ in range(round(seconds / dt)))


def test_speeding_up_follows_the_acceleration() -> None:
    moved = axis()
    moved.go(0.4)
    assert run(moved, 0.5) == pytest.approx(0.5 * 0.5 * 0.5**2)  # a t^2 / 2
    assert moved.velocity == pytest.approx(0.25)
    run(moved, 0.5)
    assert moved.velocity == 0.4


def test_slowing_down_follows_the_deceleration() -> None:
    moved = axis(0.8)
    moved.go(0.0)
    assert run(moved, 1.0) == pytest.approx(0.8**2 / 2 / 1.0)  # v^2 / 2a
    assert moved.velocity == 0.0


def test_turning_round_passes_through_zero_with_both_ramps() -> None:
    moved = axis(0.5)
    moved.go(-0.5)
    way = run(moved, 0.5 / 1.0 + 0.5 / 0.5)
    assert way == pytest.approx(0.5**2 / 2 / 1.0 - 0.5**2 / 2 / 0.5)
    assert moved.velocity == pytest.approx(-0.5)


def test_no_command_goes_beyond_the_top_speed() -> None:
    moved = axis()
    moved.go(99.0)
    run(moved, 5)
    assert moved.velocity == 1.0
    moved.go(-99.0)
    run(moved, 5)
    assert moved.velocity == -1.0


@pytest.mark.parametrize("dt", [0.02, 0.01, 0.003])
def test_the_length_of_a_step_does_not_change_a_ramp(dt: float) -> None:
    moved = axis()
    moved.go(0.3)
    assert run(moved, 1.2, dt) == pytest.approx(0.3**2 / 2 / 0.5 + 0.3 * 0.6, rel=1e-9)


@pytest.mark.parametrize("distance", [1.0, -1.0, 0.05, 3.0])
def test_a_distance_is_covered_exactly_and_ends_at_rest(distance: float) -> None:
    moved = axis()
    moved.travel(distance)
    assert run(moved, 20) == pytest.approx(distance, abs=1e-9)
    assert moved.velocity == 0.0
    assert moved.remaining is None


def test_a_short_distance_is_a_triangle_a_long_one_a_trapezoid() -> None:
    moved, fastest = axis(), []
    for distance in (0.3, 5.0):
        moved.travel(distance)
        speeds = [0.0]
        while moved.remaining is not None:
            moved.step(SUBSTEP)
            speeds.append(moved.velocity)
        fastest.append(max(speeds))
    # v^2 (1/2a + 1/2d) = s
    assert fastest[0] == pytest.approx((0.3 / (1 / 1.0 + 1 / 2.0)) ** 0.5, rel=0.03)
    assert fastest[1] == pytest.approx(1.0)


def test_a_velocity_ends_a_distance() -> None:
    moved = axis()
    moved.travel(5.0)
    run(moved, 1)
    moved.go(0.0)
    run(moved, 2)
    assert moved.velocity == 0.0
    assert moved.remaining is None


@pytest.mark.parametrize("distance", [None, 2.0])
def test_held_it_brakes_and_remembers(distance: float | None) -> None:
    moved = axis()
    if distance is None:
        moved.go(0.5)
    else:
        moved.travel(distance)
    run(moved, 1)
    run(moved, 2, held=True)
    assert moved.velocity == 0.0
    run(moved, 1)
    assert moved.velocity == pytest.approx(0.5)


def drive() -> Drive:
    moved = Drive(linear=axis(), angular=Axis(2.0, 2.0, 2.0))
    moved.power(on=True)
    return moved


def test_a_full_turn_on_the_spot_goes_nowhere() -> None:
    moved = drive()
    moved.angular.travel(2 * pi)
    steps = [moved.step(SUBSTEP) for _ in range(500)]
    assert sum(step.theta for step in steps) == pytest.approx(2 * pi)
    assert all(step.x == step.y == 0 for step in steps)


def test_without_power_it_obeys_nothing_and_the_wheels_brake_hard() -> None:
    moved = drive()
    moved.linear.velocity = 1.0
    moved.power(on=False)
    assert not moved.obeys
    for _ in range(round(1.0 / HARDEST / SUBSTEP) + 1):
        moved.step(SUBSTEP)
    assert moved.linear.velocity == 0.0


def test_an_emergency_stop_brakes_hard_and_obeys_again_once_it_stands() -> None:
    moved = drive()
    moved.linear.velocity = 1.0
    moved.emergency_stop()
    assert not moved.obeys
    way = sum(moved.step(SUBSTEP).x for _ in range(20))
    assert way == pytest.approx(1.0 / 2 / HARDEST)
    assert moved.obeys


def test_an_emergency_stop_at_rest_leaves_it_obedient() -> None:
    moved = drive()
    moved.emergency_stop()
    assert not moved.moves
    assert moved.obeys


def test_it_moves_while_anything_turns_or_is_about_to() -> None:
    moved = drive()
    assert not moved.moves
    moved.angular.go(0.1)
    assert moved.moves
    moved.power(on=False)
    assert not moved.moves
    moved.linear.velocity = 0.1
    assert moved.moves
    moved.halt()
    assert not moved.moves
