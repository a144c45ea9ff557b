"""How well readings fit a map: kernels beside their oracles."""

from functools import partial
from math import hypot, inf

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.jit import fast, plain
from pioneer3.maps import LineMap
from pioneer3.maps.line_map import OCCUPIED, OccupancyGrid
from pioneer3.maps.materials import GLASS
from pioneer3.nav.global_search import BLOCK, CandidatePoses
from pioneer3.nav.kernels import CACHE
from pioneer3.nav.kernels.fields import best_places
from pioneer3.nav.kernels.pings import echo_range, expected_ranges, weigh_ranges
from pioneer3.nav.kernels.scans import judge_poses, refine_poses, weigh_poses
from pioneer3.nav.likelihood import (
    INDEPENDENT_READINGS,
    WALL_REACH,
    WALL_SIGMA,
    ScanLikelihood,
    WallField,
    free_sides,
)
from pioneer3.nav.likelihood_sonar import (
    INCIDENCE,
    RAYS,
    SONAR_RANGE,
    EchoMap,
    PingLikelihood,
    Pings,
)
from pioneer3.nav.particles import array_of, pose_of
from tests.combinations import examples
from tests.unit.nav.rooms import FLAT, beams, echo, room

Float = NDArray[np.float64]

WALLS = WallField.for_lasers(FLAT)
ECHOES = EchoMap.of(FLAT)
HERE = Pose2(2.0, 1.5, 0.4)
LOOSE = np.diag([100.0, 100.0, 400.0])


def scan_at(pose: Pose2, near: float = inf) -> ScanLikelihood:
    return ScanLikelihood.of(WALLS, beams(FLAT, pose, ORIGIN, near=near))


def test_the_cost_is_the_square_of_the_distances_of_its_points() -> None:
    scan = scan_at(HERE)
    poses = np.array([[2.0, 1.5, 0.4], [2.1, 1.4, 0.5], [6.0, 3.0, -2.0], [20.0, 3.0, 0.0]])
    for pose, cost in zip(poses, scan.cost(poses), strict=True):
        c, s = np.cos(pose[2]), np.sin(pose[2])
        points = scan.weighed @ np.array([[c, s], [-s, c]]) + pose[:2]
        column, row = np.floor(WALLS.field.raster.in_cells(points)).astype(int).T
        height, width = WALLS.numbers.shape
        inside = (row >= 0) & (row < height) & (column >= 0) & (column < width)
        off = np.full(len(points), WALL_REACH)
        away = WALLS.field.reach + WALLS.field.distances[row[inside], column[inside]]
        off[inside] = away.clip(max=WALL_REACH)
        wanted = (0.5 * (off / WALL_SIGMA) ** 2).sum() * INDEPENDENT_READINGS / len(points)
        assert cost == pytest.approx(wanted, rel=1e-5)


@settings(max_examples=examples(30))
@given(st.floats(-0.15, 0.15), st.floats(-0.15, 0.15), st.floats(-0.1, 0.1))
def test_a_refined_pose_is_the_true_one(x: float, y: float, theta: float) -> None:
    start = array_of(HERE) + np.array([x, y, theta])
    refined, information = scan_at(HERE).refined(start[None], LOOSE)
    off = HERE.inverse() @ pose_of(refined[0])
    assert hypot(off.x, off.y) < 0.005
    assert abs(off.theta) < 0.002
    assert (np.linalg.eigvalsh(information[0]) > 0).all()


def test_a_pose_without_a_wall_near_its_points_stays() -> None:
    far = np.array([[50.0, 50.0, 1.0]])
    refined, _ = scan_at(HERE).refined(far, LOOSE)
    assert refined == pytest.approx(far)


def test_points_are_matched_with_the_face_of_a_wall_that_looks_at_the_laser() -> None:
    states = np.zeros((200, 200), dtype=np.uint8)
    states[:90, 100:102] = OCCUPIED
    states[98:100, :90] = OCCUPIED
    grid = OccupancyGrid(states=states, resolution=0.02, origin=ORIGIN)
    upright = room((2.0, 0), (2.04, 0), (2.04, 1.8), (2.0, 1.8))
    level = room((0, 1.96), (1.8, 1.96), (1.8, 2.0), (0, 2.0))
    outline = np.vstack([upright, level])
    thick = LineMap(name="thick", walls=outline, grids=(grid,), lines=np.empty((0, 4)))
    sides = free_sides(outline, thick)
    assert sides[[1, 3]] == pytest.approx(np.array([[1.0, 0.0], [-1.0, 0.0]]))
    walls = WallField.for_lasers(thick)
    truth = Pose2(1.0, 1.0, 0.785)
    scan = ScanLikelihood.of(walls, beams(thick, truth, ORIGIN))
    behind = array_of(truth) + np.array([0.03, 0.04, 0.0])  # beyond the middle of the walls
    refined, _ = scan.refined(behind[None], LOOSE)
    assert refined[0] == pytest.approx(array_of(truth), abs=0.003)


def test_beams_are_told_apart_that_agree_that_are_short_and_that_pass_walls() -> None:
    at = array_of(HERE)[None]
    verdict = scan_at(HERE).judged(at)
    assert verdict.agreement[0] > 0.97
    assert verdict.short[0] == 0
    crowded = scan_at(HERE, near=0.7).judged(at)
    assert crowded.short[0] == pytest.approx(30, abs=3)
    assert crowded.agreement[0] == pytest.approx(0.625, abs=0.05)
    moved = scan_at(HERE).judged(at + np.array([0.0, 1.0, 0.0]))
    assert moved.through[0] > 5
    assert moved.agreement[0] < 0.7
    assert moved.log_likelihood[0] < verdict.log_likelihood[0] - 5


def test_a_beam_without_an_echo_contradicts_a_wall() -> None:
    open_plane = LineMap(name="wall", walls=np.array([[100.0, 0.0, 101.0, 0.0]]))
    nothing = beams(open_plane, HERE, ORIGIN)
    scan = ScanLikelihood.of(WALLS, nothing)
    verdict = scan.judged(array_of(HERE)[None])
    assert verdict.through[0] > 55


def test_glass_is_no_wall_to_a_laser() -> None:
    codes = np.zeros(len(FLAT.walls), dtype=np.uint8)
    codes[0] = GLASS
    glazed = LineMap(name="glazed", walls=FLAT.walls, materials=codes)
    assert len(WallField.for_lasers(glazed).walls) == len(FLAT.walls) - 1
    assert len(EchoMap.of(glazed).walls.walls) == len(FLAT.walls)


def test_compiled_kernels_of_scans_compute_what_python_does() -> None:
    scan = scan_at(HERE, near=1.0)
    poses = array_of(HERE) + 0.1 * np.random.default_rng(1).standard_normal((3, 3))
    field = WALLS.field.distances, WALLS.field.frame
    surface = WALLS.walls, WALLS.facing, WALLS.numbers, WALLS.field.frame
    map_ = WALLS.walls, WALLS.field.distances, WALLS.numbers, WALLS.field.frame
    prior = LOOSE, WALL_SIGMA, np.array([0.3, 0.1])
    results = []
    for run in (partial(fast, kept=CACHE), plain):
        costs, verdicts, information = np.empty(3), np.empty((3, 4)), np.empty((3, 3, 3))
        moved = poses.copy()
        run(weigh_poses)(field, scan.weighed, poses, (WALL_SIGMA, WALL_REACH), costs)
        seen = scan.weighed, scan.clear, scan.origin
        run(judge_poses)(map_, seen, poses, (0.1, 0.015, 0.2), verdicts)
        run(refine_poses)(surface, (scan.weighed, scan.origin), moved, prior, information)
        arrays = costs, verdicts, moved, information
        results.append(np.concatenate([each.ravel() for each in arrays]))
    assert results[0] == pytest.approx(results[1], rel=1e-9)


@pytest.mark.parametrize("least", [0, 500, 700])
def test_the_best_places_are_those_of_all_that_are_scored(least: int) -> None:
    rng = np.random.default_rng(2)
    places = CandidatePoses.of(WALLS.field, 0.3)
    offsets = rng.integers(-12, 12, (4, 5, 2), dtype=np.int32)
    out = np.empty((8 * 4 * len(places.blocks), 4), dtype=np.int32)
    ends = offsets + BLOCK
    search = fast(best_places, CACHE)
    count = search(places.fields, places.free, places.blocks, ends, least, out)
    padded = np.pad(places.fields[0, BLOCK:, BLOCK:].astype(int), 12)
    best: dict[tuple[int, ...], int] = {}
    for row, column in np.argwhere(places.free).tolist():
        for heading, each in enumerate(offsets):
            score = int(padded[row + 12 + each[:, 0], column + 12 + each[:, 1]].sum())
            group = row // 2, column // 2, heading // 2
            best[group] = max(score, best.get(group, 0))
    rows = out[:count].tolist()
    found = {(row // 2, column // 2, turn // 2): score for row, column, turn, score in rows}
    assert len(found) == count > 0
    assert found == {group: score for group, score in best.items() if score >= least}


def test_a_transducer_hears_the_nearest_wall_in_its_beam() -> None:
    rng = np.random.default_rng(5)
    walls, right = ECHOES.walls, 0
    surface = walls.walls, walls.field.distances, walls.numbers, walls.field.frame
    for _ in range(400):
        x, y, axis = rng.uniform((0.3, 0.3, -3.1), (7.7, 4.7, 3.1)).tolist()
        heard = fast(echo_range, CACHE)(surface, (RAYS, SONAR_RANGE, INCIDENCE), x, y, axis)
        wanted = echo(FLAT.walls, (x, y), axis)
        right += abs(heard - wanted) < 0.01 or min(heard, wanted) > SONAR_RANGE
    assert right >= 360  # rays that nearly touch the end of a wall may go either way


def test_a_wall_that_is_met_obliquely_echoes_nothing() -> None:
    wall = EchoMap.of(LineMap(name="wall", walls=np.array([[-9.0, 1.0, 9.0, 1.0]])))
    pose = np.array([[0.0, 0.0, 0.0]])
    ahead, oblique = np.array([[0.0, 0.0, np.pi / 2]]), np.array([[0.0, 0.0, np.radians(40)]])
    assert wall.expected(ahead, pose)[0, 0] == pytest.approx(1.0, abs=0.02)
    assert wall.expected(oblique, pose)[0, 0] > SONAR_RANGE
    assert wall.expected(ahead, np.array([[999.0, 0.0, 0.0]]))[0, 0] > SONAR_RANGE


def test_remembered_ranges_are_those_computed_anew() -> None:
    poses = np.array([[2.03, 1.48, 0.4], [5.5, 2.5, -1.0]])
    mounts = np.array([[0.1, 0.2, 1.2], [0.1, -0.2, -2.0]])
    first = ECHOES.expected(mounts, poses)
    assert (ECHOES.expected(mounts, poses) == first).all()
    w, out = ECHOES.walls, np.empty((2, 2))
    surface = w.walls, w.field.distances, w.numbers, w.field.frame
    memory = np.zeros_like(ECHOES.known), 0.1
    plain(expected_ranges)(surface, (RAYS, SONAR_RANGE, INCIDENCE), memory, (mounts, poses), out)
    assert out == pytest.approx(first, abs=1e-9)


def test_ranges_are_weighed_by_a_normal_distribution_and_rare_mistakes() -> None:
    shape = np.array([5.0, 0.04, 0.02, 1.0, 0.08, 0.06])
    ranges, expected = np.array([2.0, inf, 1.0, 4.0]), np.array([[2.1, 9.0, 3.0, 2.0]])
    out = np.empty(1)
    fast(weigh_ranges, CACHE)(ranges, expected, shape, out)
    right = np.exp(-0.5 * (0.1 / (0.04 + 0.02 * 2.1)) ** 2)
    chances = np.array([right + 0.08 + 0.06, 1.0 + 0.06, 0.08 + 0.06, 0.06])
    assert out[0] == pytest.approx(-np.log(chances).sum(), abs=1e-6)


def test_echoes_that_agree_are_counted() -> None:
    mounts = np.array([[0.0, 0.0, -np.pi / 2], [0.0, 0.0, np.pi / 2], [0.0, 0.0, np.pi]])
    pings = Pings(stamp=0.0, robot_in_odom=ORIGIN, mounts=mounts, ranges=np.array([1.5, 0.4, inf]))
    rows = np.column_stack([pings.mounts, pings.ranges])
    likelihood = PingLikelihood(ECHOES, rows)
    assert likelihood.agreeing(np.array([3.0, 1.5, 0.0])) == (1, 2)
