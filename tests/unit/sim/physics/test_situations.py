"""Slopes, sills, edges, walls, squares: the bounds of docs/explanation/physics.md."""

from pathlib import Path

import pytest

pytest.importorskip("mujoco")
from tests.situations import (
    SITUATIONS,
    brake,
    climb,
    fall,
    gets_up,
    hit,
    push,
    sill,
    square,
    straight,
)

MODELS = ["p3at-sh", "p3dx-sh"]
ONE_IS_QUICK = ["p3at-sh", pytest.param("p3dx-sh", marks=pytest.mark.thorough)]
"""For what wheels and casters do alike."""


@pytest.mark.parametrize("model", MODELS)
def test_a_straight_line_is_straight(model: str) -> None:
    aside, turned = straight(model, "mujoco")
    assert aside < 1.0
    assert turned < 0.01


@pytest.mark.parametrize(
    ("model", "away", "turned", "turn"),
    [("p3at-sh", 0.15, 3.0, 1), ("p3dx-sh", 0.01, 0.5, -1)],
)
def test_a_square_ends_as_its_track_says(model: str, away: float, turned: float, turn: int) -> None:
    measured = square(model, "mujoco", turn)
    assert measured[0] < away
    assert measured[1] < turned


@pytest.mark.parametrize("model", MODELS)
def test_the_ramps_of_the_firmware_brake_without_tipping(model: str) -> None:
    way, tilt = brake(model, "mujoco")
    assert way == pytest.approx(0.7**2 / 2 / 0.3, rel=0.05)
    assert tilt < 1.0


@pytest.mark.parametrize("model", ONE_IS_QUICK)
def test_a_slope_of_ten_degrees_is_climbed_and_held(model: str) -> None:
    made, creep = climb(model, "mujoco")
    assert made > 0.95
    assert creep <= 3.0


@pytest.mark.parametrize("model", ONE_IS_QUICK)
def test_five_kilograms_are_pushed(model: str) -> None:
    assert push(model, "mujoco") > 0.5
    assert push(model, "planar") == 0.0


@pytest.mark.parametrize("model", MODELS)
def test_a_wall_stalls_and_the_speed_loop_has_not_wound_up(model: str) -> None:
    stalls, away = hit(model, "mujoco")
    assert stalls < 1.0
    assert away < 0.8


@pytest.mark.parametrize(
    ("model", "height"),
    [("p3at-sh", 0.02), ("p3dx-sh", 0.015)],
)
def test_door_sills_are_driven_over(model: str, height: float) -> None:
    assert sill(model, "mujoco", height, 0.2)


def test_a_sill_is_too_high_for_small_wheels() -> None:
    assert not sill("p3dx-sh", "mujoco", 0.05, 0.2)


@pytest.mark.parametrize("model", ONE_IS_QUICK)
def test_an_edge_is_fallen_over(model: str) -> None:
    assert fall(model, "mujoco")[0] > 60
    assert fall(model, "planar") == (0.0, 0.0)


@pytest.mark.parametrize(
    ("model", "steepest"),
    [
        *(("p3at-sh", 30), ("p3dx-sh", 14)),
        pytest.param("amigo-sh", 14, marks=pytest.mark.thorough),
        pytest.param("peoplebot-sh", 12, marks=pytest.mark.thorough),
    ],
)
def test_ramps_are_climbed_up_to_the_angle_on_the_page(model: str, steepest: int) -> None:
    assert gets_up(model, steepest)
    assert not gets_up(model, steepest + 2)


def test_the_page_has_these_situations() -> None:
    page = (Path(__file__).parents[4] / "docs/explanation/physics.md").read_text()
    assert all(f"| {what} |" in page for what in SITUATIONS)
