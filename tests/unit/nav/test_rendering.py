"""Maps drawn from key frames."""

from dataclasses import replace
from math import floor

import numpy as np
import pytest
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.maps import OccupancyGrid
from pioneer3.maps.grid import samples
from pioneer3.maps.line_map import FREE, OCCUPIED, UNKNOWN, distances
from pioneer3.nav.beams import Beams
from pioneer3.nav.frames import KeyFrame, Survey
from pioneer3.nav.matching import Cloud
from pioneer3.nav.rendering import MapRenderer, line_map_of, render
from tests.unit.nav.halls import HALL, ROUND, look

Float = NDArray[np.float64]


def survey_of(*seen: tuple[Beams, Pose2]) -> Survey:
    frames = tuple(KeyFrame.of(beams, Cloud.of(beams), 0.0, 0.0) for beams, _ in seen)
    return Survey(frames, tuple(pose for _, pose in seen), ())


def around(noise: float = 0.0) -> Survey:
    rng = np.random.default_rng(1)
    return survey_of(*((look(HALL, p, noise=noise, rng=rng), p) for p in ROUND[::3]))


def state_at(grid: OccupancyGrid, x: float, y: float) -> int:
    column = floor((x - grid.origin.x) / grid.resolution)
    row = floor((y - grid.origin.y) / grid.resolution)
    return int(grid.states[row, column])


@pytest.mark.parametrize("noise", [0.0, 0.02])
def test_walls_are_where_they_are_and_nowhere_else(noise: float) -> None:
    walls = line_map_of(render(around(noise)), "hall").walls
    drawn = samples(walls, 0.02)
    off = np.array([distances(point, HALL).min() for point in drawn])
    assert (off > 0.05).mean() < 0.02
    assert off.max() < 0.15
    seen = [point for point in samples(HALL, 0.1) if point[0] > 0.99 or point[1] > 1.49]
    missed = [distances(point, walls).min() for point in seen]
    assert (np.array(missed) < 0.05).mean() > 0.98


def test_a_noisy_wall_gets_no_thicker_by_being_seen_for_long() -> None:
    rng = np.random.default_rng(3)
    places = 12 * ROUND[::3]
    survey = survey_of(*((look(HALL, p, noise=0.02, rng=rng), p) for p in places))
    drawn = samples(line_map_of(render(survey), "hall").walls, 0.02)
    off = np.array([distances(point, HALL).min() for point in drawn])
    assert (off > 0.05).mean() < 0.002


def test_what_was_passed_is_free_and_the_rest_unknown() -> None:
    grid = render(around())
    assert state_at(grid, 2.0, 4.0) == FREE
    assert state_at(grid, 6.0, 4.0) == UNKNOWN
    assert OCCUPIED in grid.states


def test_somebody_who_walks_by_leaves_nothing() -> None:
    rng = np.random.default_rng(2)
    seen = []
    for number, place in enumerate(ROUND[:28]):
        x = 3.0 + 0.3 * number
        person = np.array([[x, 2.2, x + 0.3, 2.2], [x, 2.2, x, 2.5], [x + 0.3, 2.2, x + 0.3, 2.5]])
        walls = np.concatenate([HALL, person])
        seen.append((look(walls, place, noise=0.005, rng=rng), place))
    walls = line_map_of(render(survey_of(*seen)), "hall").walls
    off = np.array([distances(point, HALL).min() for point in samples(walls, 0.02)])
    assert (off > 0.1).mean() < 0.01


def test_drawing_on_is_the_same_as_drawing_anew() -> None:
    survey, renderer = around(), MapRenderer()
    renderer.update(replace(survey, frames=survey.frames[:5], poses=survey.poses[:5]))
    moved = tuple(Pose2(p.x + 3.0, p.y - 9.0, p.theta + 0.4) for p in survey.poses)
    renderer.update(replace(survey, poses=moved))
    renderer.update(survey)
    anew = render(survey)
    assert renderer.grid.origin == anew.origin
    assert (renderer.grid.states == anew.states).all()


def test_nothing_echoes_in_the_open() -> None:
    beams = look(np.array([[3.0, -1.0, 3.0, 1.0]]), Pose2())
    grid = render(survey_of((beams, Pose2()), (beams, Pose2())))
    assert state_at(grid, -5.0, 0.1) == FREE
    assert state_at(grid, 2.0, 0.0) == FREE
    assert grid.states.shape[1] * grid.resolution < 17.0


def test_a_map_without_scans_is_empty() -> None:
    grid = render(Survey((), (), ()))
    assert (grid.states == UNKNOWN).all()
    assert line_map_of(grid, "nothing").walls.shape == (0, 4)
