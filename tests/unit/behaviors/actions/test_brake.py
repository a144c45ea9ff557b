"""Stopping in time. Of a P3-AT: front end at 0.313 m, half width 0.2525 m, 1.5 m/s^2."""

from math import sqrt

import pytest

from pioneer3.behaviors.action import Desire
from pioneer3.behaviors.actions.limiters import BRAKE_DELAY, PLANNED_SHARE, Brake, stopping_speed
from pioneer3.behaviors.actions.sensing import BLIND
from tests.unit.behaviors.support import seen, value
from tests.unit.behaviors.tracking.scene import Scene, ahead


def decided(scene: Scene, brake: Brake, reports: int = 4) -> Desire | None:
    desire = None
    for _ in range(reports):
        desire = brake.decide(scene.report())
    return desire


def wall(distance: float) -> Scene:
    return Scene(walls=[(0.313 + distance, -3.0, 0.313 + distance, 3.0)])


def test_the_speed_is_that_from_which_it_stops() -> None:
    # a = 0.7 * 1.5 = 1.05; v = 1.05 * (sqrt(0.25^2 + 2 * 0.25 / 1.05) - 0.25) = 0.508
    speed = stopping_speed(0.25, 1.5)
    assert speed == pytest.approx(1.05 * (sqrt(0.0625 + 0.5 / 1.05) - 0.25))
    assert speed * BRAKE_DELAY + speed**2 / (2 * PLANNED_SHARE * 1.5) == pytest.approx(0.25)


@pytest.mark.parametrize("distance", [0.0, -0.1])
def test_without_room_there_is_no_speed(distance: float) -> None:
    assert stopping_speed(distance, 1.5) == 0.0


def test_it_lets_the_robot_follow_at_0_35_m() -> None:
    # a person's outline 0.35 m ahead leaves 0.25 m to the clearance of 0.1: 0.508 m/s
    top = value(decided(Scene(people=[ahead(0.35)]), Brake()), "v_max")
    assert top is not None
    assert 0.45 < top < 0.56


def test_at_its_clearance_the_robot_stands() -> None:
    assert value(decided(wall(0.1), Brake()), "v_max") == pytest.approx(0.0, abs=0.02)


def test_what_is_far_away_or_beside_does_not_limit() -> None:
    assert decided(wall(2.0), Brake()) is None
    assert decided(Scene(walls=[(-3.0, 0.6, 3.0, 0.6)]), Brake()) is None


def test_where_somebody_was_does_not_limit_once_they_have_gone() -> None:
    scene, brake = Scene(people=[ahead(0.2)]), Brake()
    assert decided(scene, brake) is not None
    scene.people = []
    assert decided(scene, brake) is None


def test_without_sonars_nobody_drives_on() -> None:
    desire = Brake().decide(seen())
    assert desire is not None
    assert (value(desire, "v_max"), desire.reason) == (0.0, BLIND)
