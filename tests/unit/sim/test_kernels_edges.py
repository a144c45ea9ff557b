"""Which ends of walls are edges, and which of them a transducer hears."""

from itertools import pairwise
from math import pi, radians

import numpy as np
import pytest
from numpy.typing import NDArray

from pioneer3.jit import numba_version
from pioneer3.sim.kernels import (
    Kernels,
    Reflectors,
    RobotArrays,
    build_grid,
    compiled_kernels,
    find_edges,
    sonar_mounts,
)

Float = NDArray[np.float64]

SILENT = 5.0
"""The longest range [m]."""


@pytest.fixture(scope="module")
def kernels() -> Kernels:
    return Kernels()


def edges_of(*walls: tuple[float, float, float, float]) -> set[tuple[float, float]]:
    points = find_edges(build_grid(np.array(walls, dtype=np.float64))).walls[:, :2]
    return {(round(x, 3), round(y, 3)) for x, y in points.tolist()}


def path(*points: tuple[float, float]) -> list[tuple[float, float, float, float]]:
    return [(*a, *b) for a, b in pairwise(points)]


def test_free_ends_and_corners_are_edges_and_joints_are_none() -> None:
    walls = path((0, 0), (1, 0), (2, 0.2), (2, 2))
    assert edges_of(*walls) == {(0, 0), (2, 0.2), (2, 2)}


def test_a_post_is_an_edge_and_an_empty_map_has_none() -> None:
    assert edges_of((1, 1, 1, 1)) == {(1, 1)}
    assert len(find_edges(build_grid(np.empty((0, 4)))).walls) == 0


def test_where_one_wall_meets_the_side_of_another_is_no_edge() -> None:
    assert edges_of((-1, 0, 1, 0), (0, 0, 0, 1)) == {(-1, 0), (1, 0), (0, 1)}


def test_a_round_thing_made_of_short_pieces_has_no_edges() -> None:
    turns = np.linspace(0, 2 * pi, 25)
    ring = np.stack([np.cos(turns), np.sin(turns)], axis=1)
    assert edges_of(*path(*[(float(x), float(y)) for x, y in ring])) == set()


def test_pieces_of_a_wall_are_no_edges_however_short_not_even_beside_its_corner() -> None:
    along = [(round(0.02 * k, 2), 0.0) for k in range(51)]
    up = [(1.0, round(0.02 * k, 2)) for k in range(1, 51)]
    assert edges_of(*path(*along, *up)) == {(0, 0), (1, 0), (1, 1)}


def test_steps_of_pixels_and_small_gaps_are_no_edges() -> None:
    stairs = [(0.02 * (k // 2 + k % 2) * 3, 0.02 * (k // 2)) for k in range(60)]
    low, high = (0.05, 0.02), (stairs[-1][0] - 0.12, stairs[-1][1] - 0.04)
    found = edges_of(*path(*stairs))
    assert all(x <= low[0] or x >= high[0] for x, _ in found)
    assert edges_of((0, 0, 1, 0), (1.04, 0, 2, 0)) == {(0, 0), (2, 0)}
    assert edges_of((0, 0, 1, 0), (1.3, 0, 2, 0)) == {(0, 0), (1, 0), (1.3, 0), (2, 0)}


def test_rows_of_pixels_are_one_wall() -> None:
    rows = [(0.0, round(0.02 * k, 2), 0.04, round(0.02 * k, 2)) for k in range(51)]
    found = edges_of(*rows)
    assert {round(y, 1) for _, y in found} == {0.0, 1.0}
    assert max(min(y, 1 - y) for _, y in found) <= 0.08


def test_edges_lie_where_walls_end_in_any_direction() -> None:
    random = np.random.default_rng(3)
    for turn in random.uniform(-pi, pi, 50):
        x, y = float(np.cos(turn)), float(np.sin(turn))
        joined = edges_of((-x, -y, 0, 0), (0, 0, x, y))
        assert joined == {(round(-x, 3), round(-y, 3)), (round(x, 3), round(y, 3))}


def heard(
    kernels: Kernels,
    walls: list[tuple[float, float, float, float]],
    *,
    edge_range: float = 1.0,
    others: tuple[tuple[float, float, float], ...] = (),
) -> float:
    """Return what a transducer at the origin hears ahead, of a beam of 30 degrees."""
    grid = build_grid(np.array(walls, dtype=np.float64))
    size = np.full(1 + len(others), 0.05)
    robots = RobotArrays(size, size, size)
    robots.poses[:] = np.array([(0.0, 0.0, 0.0), *others]).T
    kernels.place(robots)
    mounts = sonar_mounts([np.zeros((1, 3))], [0], rays=5, width=radians(30))
    echoes = Reflectors(
        steep=float(np.cos(radians(27))), edges=find_edges(grid), edge_range=edge_range
    )
    return float(kernels.sonar(grid, robots, mounts, SILENT, echoes=echoes)[0, 0])


CORNER = path((2.0, 1.3), (0.7, 0.0), (2.0, -1.3))
"""Of a box that is turned by 45 degrees, so that no face sends anything back."""


def test_a_corner_is_heard_only_where_it_is_near(kernels: Kernels) -> None:
    assert heard(kernels, CORNER) == pytest.approx(0.7)
    assert heard(kernels, CORNER, edge_range=0.69) == SILENT
    assert heard(kernels, CORNER, edge_range=0.0) == SILENT


def test_a_wall_is_heard_end_on_between_two_rays(kernels: Kernels) -> None:
    y = 0.8 * float(np.tan(radians(4)))
    end = 0.8 / float(np.cos(radians(4)))
    assert heard(kernels, [(0.8, y, 3.0, y)]) == pytest.approx(end)


def test_an_edge_beside_the_beam_is_not_heard(kernels: Kernels) -> None:
    for degrees, inside in ((14.9, True), (15.1, False), (-14.9, True), (-15.1, False)):
        y = 0.8 * float(np.tan(radians(degrees)))
        wall = (0.8, y, 0.8 - 0.2, 4 * y)
        assert (heard(kernels, [wall]) < SILENT) == inside, degrees


def test_a_hidden_edge_is_not_heard(kernels: Kernels) -> None:
    slanted = (-0.06, -0.386, 0.86, 0.386)  # its own ends are beside the beam
    assert heard(kernels, [*CORNER, slanted]) == heard(kernels, [slanted]) == SILENT


def test_what_moves_before_an_edge_is_nearer(kernels: Kernels) -> None:
    assert heard(kernels, CORNER, others=((0.5, 0.0, 0.0),)) == pytest.approx(0.45)
    assert heard(kernels, CORNER, others=((1.0, 0.9, 0.0),)) == pytest.approx(0.7)


@pytest.mark.skipif(not numba_version(), reason="numba is not installed")
def test_nothing_is_compiled_in_the_middle_of_a_run_when_few_robots_listen() -> None:
    kernels = compiled_kernels()
    size = np.full(3, 0.2)
    mounts = sonar_mounts([np.zeros((1, 3))], [0, 0, 0])
    before = len(kernels._sonar.signatures)  # type: ignore[attr-defined]
    owners = np.array([0, 2], dtype=np.int32)
    grid = build_grid(np.array([[1.0, -1.0, 1.0, 1.0]]))
    kernels.sonar(grid, RobotArrays(size, size, size), mounts, SILENT, owners=owners)
    assert len(kernels._sonar.signatures) == before  # type: ignore[attr-defined]
