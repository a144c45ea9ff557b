"""Scans against scans."""

from math import hypot, pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.jit import plain
from pioneer3.nav.kernels.matching import align, nearest, sort_into
from pioneer3.nav.matching import (
    POINT_SIGMA,
    TARGET_REACH,
    WIDTHS,
    Cloud,
    Prior,
    Submap,
    rotation,
)
from tests.unit.nav.halls import HALL, look

Float = NDArray[np.float64]
Int = NDArray[np.int64]

FREE = Prior(ORIGIN, 1e-6 * np.eye(3))
"""Nothing is known beforehand."""

offsets = st.builds(Pose2, st.floats(-0.15, 0.15), st.floats(-0.15, 0.15), st.floats(-0.06, 0.06))
points_of: st.SearchStrategy[Float] = st.lists(
    st.tuples(st.floats(-2, 2), st.floats(-2, 2)), min_size=1, max_size=40
).map(np.array)


def cloud_at(pose: Pose2, noise: float = 0.0, seed: int = 0) -> Cloud:
    return Cloud.of(look(HALL, pose, noise=noise, rng=np.random.default_rng(seed)))


def near(a: Pose2, b: Pose2, metres: float, turn: float) -> bool:
    off = a.inverse() @ b
    return hypot(off.x, off.y) <= metres and abs(off.theta) <= turn


@settings(max_examples=20, deadline=None)
@given(offsets)
def test_a_scan_is_found_where_it_was_taken(off: Pose2) -> None:
    old, new = Pose2(2.0, 1.5, 0.0), Pose2(2.3, 1.6, 0.3)
    submap = Submap([cloud_at(old)], [old])
    match = submap.match(cloud_at(new), new @ off, Prior(new @ off, FREE.information))
    assert near(match.pose, new, 2e-3, 1e-3)
    assert match.inliers > 0.9
    assert match.ratio > 0.05


def solid(points: Float) -> Float:
    """Return walls as high as three points and a floor, as small_gicp has three dimensions."""
    walls = np.concatenate([np.insert(points, 2, z, axis=1) for z in (-0.1, 0.0, 0.1)])
    x, y = np.meshgrid(np.arange(-4, 4, 0.2), np.arange(-4, 4, 0.2))
    floor = np.stack([x.ravel(), y.ravel(), np.full(x.size, -3.0)], axis=1)
    return np.insert(np.concatenate([walls, floor]), 3, 1.0, axis=1)


@pytest.mark.parametrize("seed", range(5))
def test_it_agrees_with_small_gicp(seed: int) -> None:
    gicp = pytest.importorskip("small_gicp")
    old, new = Pose2(2.0, 1.5, 0.0), Pose2(2.2, 1.6, 0.1)
    target, source = cloud_at(old, 0.005, seed), cloud_at(new, 0.005, seed + 100)
    begin = old.inverse() @ new @ Pose2(0.05, -0.05, 0.02)
    match = Submap([target], [ORIGIN]).match(source, begin, Prior(begin, FREE.information))
    theirs, guess = gicp.PointCloud(solid(target.points)), np.eye(4)
    gicp.estimate_normals(theirs, num_neighbors=20)
    guess[:2, :2], guess[:2, 3] = rotation(begin.theta), (begin.x, begin.y)
    result = gicp.align(
        theirs,
        gicp.PointCloud(solid(source.points)),
        gicp.KdTree(theirs),
        guess,
        registration_type="PLANE_ICP",
        max_correspondence_distance=0.1,
        max_iterations=100,
    )
    x, y = result.T_target_source[:2, 3].tolist()
    assert result.converged
    assert hypot(match.pose.x - x, match.pose.y - y) < 2e-3


def test_where_walls_say_nothing_odometry_counts() -> None:
    corridor = np.array([[-40.0, 0.0, 40.0, 0.0], [40.0, 2.0, -40.0, 2.0]])
    old, new = Pose2(0.0, 1.0, 0.0), Pose2(0.4, 1.0, 0.0)
    submap = Submap([Cloud.of(look(corridor, old))], [old])
    said = new @ Pose2(0.05, 0.05, 0.02)
    match = submap.match(Cloud.of(look(corridor, new)), said, Prior.around(said, 0.02, 0.05))
    assert match.pose.x == pytest.approx(said.x, abs=5e-3)
    assert match.pose.y == pytest.approx(new.y, abs=2e-3)
    assert match.pose.theta == pytest.approx(0.0, abs=1e-3)
    assert match.ratio < 0.01


def test_somebody_in_the_way_does_no_harm() -> None:
    pose = Pose2(2.0, 1.5, 0.0)
    submap = Submap([cloud_at(pose)], [pose])
    scan = look(HALL, pose)
    away = np.hypot(*scan.points.T)
    bearing = np.arctan2(scan.points[:, 1], scan.points[:, 0])
    legs = np.abs(bearing) < 0.3
    scan.points[legs] *= (1.2 / away[legs])[:, None]
    said = pose @ Pose2(0.05, -0.05, 0.02)
    match = submap.match(Cloud.of(scan), said, Prior.around(said, 0.1, 0.1))
    assert near(match.pose, pose, 5e-3, 3e-3)
    assert match.inliers < 0.95


def test_the_other_side_of_a_thin_wall_is_no_match() -> None:
    wall = np.array([[-5.0, 0.0, 5.0, 0.0]])
    behind = np.array([[-5.0, 0.1, 5.0, 0.1]])
    before, after = Pose2(0.0, -2.0, pi / 2), Pose2(0.0, 2.0, -pi / 2)
    submap = Submap([Cloud.of(look(wall, before))], [before])
    match = submap.match(Cloud.of(look(behind, after)), after, Prior.around(after, 0.1, 0.1))
    assert match.inliers == 0
    assert near(match.pose, after, 1e-6, 1e-6)


@settings(max_examples=10, deadline=None)
@given(st.floats(-1.5, 1.5), st.floats(-1.5, 1.5), st.floats(-0.3, 0.3))
def test_a_search_finds_what_is_too_far_off_for_matching(x: float, y: float, theta: float) -> None:
    pose = Pose2(3.0, 1.5, 0.2)
    submap = Submap([cloud_at(pose)], [pose])
    cloud = cloud_at(pose)
    guess = pose @ Pose2(x, y, theta)
    found = submap.search(cloud.points, guess, 2.2, 0.35)
    assert near(found, pose, 0.12, 0.02)
    assert submap.search_for(cloud.points, guess, 2.2, 0.35, 0.5) == found
    assert submap.search_for(cloud.points, guess, 2.2, 0.35, 1.01) is None


def test_an_empty_submap_matches_nothing() -> None:
    match = Submap([], []).match(cloud_at(Pose2(2.0, 1.5)), ORIGIN, Prior.around(ORIGIN, 0.1, 0.1))
    assert match.inliers == 0
    assert match.pose == ORIGIN


def sorted_targets(points: Float, normals: Float) -> tuple[Int, Float, Float, Int]:
    low, cell = points.min(axis=0), 0.15
    columns, rows = (np.floor((points - low) / cell)).astype(np.int64).T
    shape = np.array([rows.max() + 1, columns.max() + 1])
    starts = np.zeros(shape.prod() + 1, dtype=np.int64)
    order = np.empty(len(points), dtype=np.int64)
    sort_into(rows * shape[1] + columns, starts, order)
    targets = np.concatenate([points, normals], axis=1)[order]
    return starts, targets, np.array([*low, cell]), shape


@given(points_of, st.floats(-2.5, 2.5), st.floats(-2.5, 2.5), st.floats(0.05, 1.0))
def test_the_nearest_target_is_the_nearest(points: Float, x: float, y: float, reach: float) -> None:
    normals = np.tile([1.0, 0.0], (len(points), 1))
    starts, targets, grid, shape = sorted_targets(points, normals)
    found = nearest(starts, targets, grid, shape, x, y, 1.0, 0.0, reach)
    away = np.hypot(*(targets[:, :2] - (x, y)).T)
    if away.min() < reach - 1e-9:
        assert away[found] == pytest.approx(away.min())
    elif away.min() > reach + 1e-9:
        assert found == -1


@given(points_of)
def test_targets_of_another_direction_are_passed_over(points: Float) -> None:
    normals = np.tile([1.0, 0.0], (len(points), 1))
    starts, targets, grid, shape = sorted_targets(points, normals)
    x, y = points[0].tolist()
    assert nearest(starts, targets, grid, shape, x, y, -1.0, 0.0, 1.0) == -1
    assert nearest(starts, targets, grid, shape, x, y, 0.0, 0.0, 1.0) >= 0


def test_compiled_and_plain_kernels_agree() -> None:
    old, new = Pose2(2.0, 1.5, 0.0), Pose2(2.2, 1.6, 0.1)
    cloud = Cloud.of(look(HALL, new, count=61))
    submap = Submap([Cloud.of(look(HALL, old, count=61))], [old])
    match = submap.match(cloud, new, Prior.around(new, 0.1, 0.1))
    pose, information = np.array([new.x, new.y, new.theta]), np.zeros((3, 3))
    inliers = plain(align)(
        submap._starts,
        submap._targets,
        submap._grid,
        submap._shape,
        np.concatenate([cloud.points, cloud.normals], axis=1),
        pose,
        pose.copy(),
        Prior.around(new, 0.1, 0.1).information,
        WIDTHS,
        TARGET_REACH,
        POINT_SIGMA,
        information,
    )
    assert inliers == pytest.approx(match.inliers)
    assert pose == pytest.approx([match.pose.x, match.pose.y, match.pose.theta], abs=1e-9)
    assert information == pytest.approx(match.information)


def test_normals_point_to_the_laser_along_the_nearest_wall() -> None:
    cloud = cloud_at(Pose2(2.5, 2.5, 0.0))
    middle = cloud.points + np.array([2.5, 2.5])
    left = (np.abs(middle[:, 0]) < 1e-6) & (np.abs(middle[:, 1] - 4.5) < 2.0)
    assert left.sum() > 10
    assert cloud.normals[left] == pytest.approx(np.tile([1.0, 0.0], (left.sum(), 1)), abs=1e-3)
    inside = (cloud.points * cloud.normals).sum(axis=1)
    assert (inside <= 1e-9).all()
