"""What maps know of cells: scanned points and pictures, for people to look at."""

from pathlib import Path

import numpy as np
import pytest

from pioneer3.geometry import Pose2
from pioneer3.maps import read_map, shipped_map
from pioneer3.maps.grid import grid_of, outline, raster_outline
from pioneer3.maps.line_map import FREE, OCCUPIED, UNKNOWN, OccupancyGrid

POINTS = np.array([[1.0, 2.0], [1.1, 2.0], [1.3, 2.2], [1.3, 2.2]])


def test_cells_are_those_that_are_outlined() -> None:
    cells = grid_of(POINTS, 0.1)
    assert cells is not None
    assert cells.states.tolist() == [[1, 1, 0, 0], [0, 0, 0, 0], [0, 0, 0, 1]]
    assert (cells.origin.x, cells.origin.y) == pytest.approx((0.95, 1.95))
    corner = np.tile([cells.origin.x, cells.origin.y], 2)
    walls = raster_outline(cells.states == OCCUPIED) * cells.resolution + corner
    assert sorted(walls.round(9).tolist()) == sorted(outline(POINTS, 0.1).round(9).tolist())


def test_points_too_far_apart_are_no_grid() -> None:
    assert grid_of(np.array([[0.0, 0.0], [9e4, 9e4]]), 0.02) is None
    assert grid_of(np.empty((0, 2)), 0.02) is None


def test_joined_cells_keep_what_is_occupied_then_what_is_free() -> None:
    states = np.full((3, 5), UNKNOWN, dtype=np.uint8)
    states[0, 0], states[0, 1], states[2, 2], states[1, 4] = FREE, OCCUPIED, FREE, OCCUPIED
    cells = OccupancyGrid(states=states, resolution=0.5, origin=Pose2(1.0, 2.0, 3.0))
    joined = cells.coarser(6)
    assert joined.states.tolist() == [[OCCUPIED, UNKNOWN, OCCUPIED], [UNKNOWN, FREE, UNKNOWN]]
    assert (joined.resolution, joined.origin) == (1.0, cells.origin)
    assert cells.coarser(15) is cells


def test_a_map_of_lines_has_no_cells_and_draws_all_its_walls() -> None:
    office = shipped_map("office")
    assert office.grids == ()
    assert office.lines is office.walls


def test_points_of_a_map_are_cells_and_the_rest_of_its_walls_lines(tmp_path: Path) -> None:
    path = tmp_path / "a.map"
    path.write_text(
        "2D-Map\nResolution: 100\n"
        'Cairn: Sim.BoxObstacle 0 0 0 "" ICON "" 3000 3000 4000 4000\n'
        "LINES\n0 0 5000 0\nDATA\n1000 2000\n1100 2000\n"
    )
    read = read_map(path)
    (cells,) = read.grids
    assert (cells.states.tolist(), cells.resolution) == ([[OCCUPIED, OCCUPIED]], 0.1)
    assert len(read.lines) == 1 + 4
    assert len(read.walls) == 1 + 4 + 4


@pytest.mark.parametrize(
    ("shades", "more", "states"),
    [
        ([0, 205, 254], "", [OCCUPIED, UNKNOWN, FREE]),
        ([255, 50, 0], "negate: 1\n", [OCCUPIED, UNKNOWN, FREE]),
        ([100, 101, 0], "mode: raw\n", [OCCUPIED, UNKNOWN, FREE]),
    ],
)
def test_a_picture_tells_occupied_unknown_and_free(
    tmp_path: Path, shades: list[int], more: str, states: list[int]
) -> None:
    (tmp_path / "m.pgm").write_bytes(b"P5 3 1 255\n" + bytes(shades))
    path = tmp_path / "lab.yaml"
    path.write_text(f"image: m.pgm\nresolution: 0.5\norigin: [1.0, 2.0, 0.5]\n{more}")
    read = read_map(path)
    assert read.grids[0].states.tolist() == [states]
    assert read.grids[0].origin == Pose2(1.0, 2.0, 0.5)
    assert not len(read.lines)
