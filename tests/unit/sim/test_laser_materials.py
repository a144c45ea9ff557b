"""Walls of glass, black walls and reflectors: what lasers, sonars and bodies make of them."""

from dataclasses import replace
from math import inf, radians

import numpy as np
import pytest

from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.maps.materials import Material
from pioneer3.models.lasers import LASERS
from pioneer3.sim.laser_scanner import Arc
from pioneer3.sim.raycast import cast_reference
from pioneer3.sim.sensing import Surfaces
from pioneer3.sim.worldfile import Box
from tests.unit.sim.test_laser_scanner import (
    UTM,
    Float,
    arc_of,
    scan_at_rest,
    straight_ahead,
    world_of,
)

PLAIN, BLACK, GLASS, REFLECTOR = Material
PANE = [2.0, -3.0, 2.0, 3.0]
BEHIND = [5.0, -30.0, 5.0, 30.0]
PANE_AND_WALL = np.array([PANE, BEHIND])


def fan(heading: float = 0.0) -> tuple[Float, Float]:
    """Return angles, and ranges of a laser in front of a pane with a wall behind it."""
    world, body = world_of(PANE_AND_WALL, GLASS, PLAIN, at=Pose2(0.0, 0.0, heading))
    turn = Arc(first=radians(-60), step=radians(1), count=121, beam_time=1e-5)
    ranges, _ = scan_at_rest(world, body, UTM, turn)
    return heading + radians(-60) + radians(1) * np.arange(121, dtype=np.float64), ranges


@pytest.mark.parametrize("heading_deg", [0.0, 30.5])
def test_glass_is_seen_nearly_from_in_front_and_else_what_is_behind(heading_deg: float) -> None:
    angles, ranges = fan(radians(heading_deg))
    pane = cast_reference(np.zeros(2), angles, PANE_AND_WALL[:1], 30.0)
    behind = cast_reference(np.zeros(2), angles, PANE_AND_WALL[1:], 30.0)
    in_front = abs(angles) < radians(5.0001)
    assert in_front.sum() in {10, 11}
    assert ranges[in_front] == pytest.approx(pane[in_front], abs=1e-6)
    seen = ~in_front & (behind < 30.0)
    assert ranges[seen] == pytest.approx(behind[seen], abs=1e-6)


def test_the_in_band_laser_and_the_camera_see_through_glass_too() -> None:
    world, body = world_of(PANE_AND_WALL, GLASS, PLAIN)
    ranges = world.laser(body, ORIGIN, radians(-30), radians(30), 3)
    assert ranges == pytest.approx([5.0 / np.cos(radians(30)), 2.0, 5.0 / np.cos(radians(30))])
    assert world.sight(body, ORIGIN, radians(-30), radians(30), 3) == pytest.approx(ranges)


def test_sonars_and_bodies_meet_glass_as_any_wall() -> None:
    glass, body = world_of(PANE_AND_WALL, GLASS, PLAIN)
    plain, other = world_of(PANE_AND_WALL)
    assert glass.sonar(body).tobytes() == plain.sonar(other).tobytes()
    assert glass.is_free(body, Pose2(1.0)) is True
    assert glass.is_free(body, Pose2(2.0)) is False


@pytest.mark.parametrize(
    ("name", "near", "far"), [("utm-30lx", 4.8, 5.0), ("lms-200", 4.8, 5.0), ("lms-111", 8.7, 8.9)]
)
def test_black_walls_are_lost_from_afar(name: str, near: float, far: float) -> None:
    # the range to 10 % of remission times the root of 2.4 % over that
    for x, there in ((near, True), (far, False)):
        wall = np.array([[x, -3.0, x, 3.0]])
        ranges, intensities = straight_ahead(*world_of(wall, BLACK), LASERS[name])
        assert bool(np.isfinite(ranges).all()) is there, x
        assert intensities[0] == (pytest.approx(0.024) if there else 0.0)
        assert np.isfinite(straight_ahead(*world_of(wall), LASERS[name])[0]).all()


def test_a_reflector_is_bright_from_any_side() -> None:
    wall = np.array([[6.0, -3.0, 6.0, 3.0]])
    world, body = world_of(wall, REFLECTOR)
    turn = Arc(first=radians(-20), step=radians(20), count=3, beam_time=1e-5)
    _, intensities = scan_at_rest(world, body, UTM, turn)
    assert intensities == pytest.approx(10.0)


def test_only_the_wall_that_a_beam_ends_at_counts() -> None:
    # a plain wall in front of a black one
    walls = np.array([[2.0, -3.0, 2.0, 3.0], [3.0, -3.0, 3.0, 3.0]])
    assert straight_ahead(*world_of(walls, PLAIN, BLACK))[1][0] == pytest.approx(0.8)
    assert straight_ahead(*world_of(walls[::-1], PLAIN, BLACK))[1][0] == pytest.approx(0.024)


def test_a_movable_box_keeps_its_material_where_it_is_put() -> None:
    world, body = world_of(np.array([[9.0, -3.0, 9.0, 3.0]]))
    box = Box(pose=Pose2(3.0, 2.0), size=(1.0, 1.0), movable=True, material=REFLECTOR)
    obstacle = world.add_obstacle(box)
    assert straight_ahead(world, body)[1][0] == pytest.approx(0.8)
    world.move_obstacle(obstacle, Pose2(3.0, 0.0))
    ranges, intensities = straight_ahead(world, body)
    assert (ranges[0], intensities[0]) == (pytest.approx(2.5), pytest.approx(10.0))
    person = replace(box, material=PLAIN)
    world.remove_obstacle(obstacle)
    world.add_obstacle(replace(person, pose=Pose2(2.0, 0.0)))
    assert straight_ahead(world, body)[1][0] == pytest.approx(0.8)


def test_a_world_without_other_materials_takes_the_same_random_numbers() -> None:
    plain, body = world_of(np.array([BEHIND]))
    glass, other = world_of(PANE_AND_WALL, GLASS, PLAIN)
    before = plain.generator(body), glass.generator(other)
    assert before[0].random() == before[1].random()


def test_a_laser_changes_no_other_random_number() -> None:
    with_laser, body = world_of(np.array([BEHIND]))
    without, other = world_of(np.array([BEHIND]))
    scan_at_rest(with_laser, body, UTM, arc_of(UTM))
    without.step(0.1)
    assert with_laser._rng.random() == without._rng.random()
    assert with_laser._own[body].random() == without._own[other].random()


def test_another_map_forgets_the_glass() -> None:
    world, body = world_of(PANE_AND_WALL, GLASS, PLAIN)
    world.change_map(replace(world.map, materials=np.zeros(2, dtype=np.uint8)))
    assert world.sight(body, ORIGIN, radians(-30), radians(30), 1) == pytest.approx(
        2.0 / np.cos(radians(30))
    )


def test_surfaces_name_the_material_at_the_end_of_each_ray() -> None:
    surfaces = Surfaces.among(PANE_AND_WALL, np.array([2, 1], dtype=np.uint8))
    ranges, codes = surfaces.seen(np.zeros(2), np.radians([0.0, 30.0, 180.0]), np.full(3, 30.0))
    assert ranges == pytest.approx([2.0, 5.0 / np.cos(radians(30)), 30.0])
    assert codes.tolist() == [2, 1, 0]
    assert inf not in ranges
