"""The kernels beyond agreement with the reference: buffers, threads, far places."""

from math import inf, pi

import numpy as np
import pytest
from numpy.typing import NDArray

from pioneer3.errors import ConfigError
from pioneer3.sim.kernels import (
    Kernels,
    RobotArrays,
    build_grid,
    laser_fan,
    sonar_mounts,
)
from tests.rays import cast_rays

Float = NDArray[np.float64]

ROOM = np.array([[-5.0, -5, 5, -5], [5, -5, 5, 5], [5, 5, -5, 5], [-5, 5, -5, -5]])
AHEAD = np.zeros((1, 3))
NOBODY = np.array([-1], dtype=np.int32)


@pytest.fixture(scope="module")
def kernels() -> Kernels:
    return Kernels()


def robots_at(kernels: Kernels, *poses: tuple[float, float, float]) -> RobotArrays:
    size = np.full(len(poses), 0.25)
    robots = RobotArrays(size, size, size)
    robots.poses[:] = np.array(poses).reshape(-1, 3).T
    kernels.place(robots)
    return robots


def test_an_outline_is_the_footprint_in_the_world(kernels: Kernels) -> None:
    front, rear, half = (np.array([size]) for size in (0.3, 0.4, 0.2))
    robots = RobotArrays(front, rear, half)
    robots.poses[:, 0] = 1.0, 2.0, np.pi / 2
    kernels.place(robots)
    sides = robots.outlines[0]
    assert sides[:, ::2].min() == pytest.approx(1.0 - 0.2)
    assert sides[:, ::2].max() == pytest.approx(1.0 + 0.2)
    assert sides[:, 1::2].min() == pytest.approx(2.0 - 0.4)
    assert sides[:, 1::2].max() == pytest.approx(2.0 + 0.3)


def test_given_buffers_are_filled_and_returned(kernels: Kernels) -> None:
    grid, robots = build_grid(ROOM), robots_at(kernels, (0, 0, 0))
    mounts, fan = sonar_mounts([AHEAD], [0]), laser_fan((0, 0, 0), -1.0, 1.0, 3)
    heard, seen, hits = np.empty((1, 1)), np.empty((1, 3)), np.ones(1, dtype=np.bool_)
    assert kernels.sonar(grid, robots, mounts, 9.0, out=heard) is heard
    assert kernels.cast_fans(grid, robots, fan, 9.0, out=seen) is seen
    assert kernels.blocked(grid, robots, robots.poses, hits) is hits
    assert (heard[0, 0], seen[0, 1]) == pytest.approx((5.0, 5.0))
    assert not hits[0]


def test_a_sonar_hears_the_nearest_of_its_rays(kernels: Kernels) -> None:
    post = np.array([[2.0, 0.4, 2.0, 1.0]])
    grid, robots = build_grid(post), robots_at(kernels, (0, 0, 0))
    narrow, wide = sonar_mounts([AHEAD], [0]), sonar_mounts([AHEAD], [0], rays=5, width=0.6)
    assert kernels.sonar(grid, robots, narrow, 5.0)[0, 0] == 5.0
    assert kernels.sonar(grid, robots, wide, 5.0)[0, 0] == pytest.approx(2 / np.cos(0.3))


def test_robots_of_several_types_share_one_table(kernels: Kernels) -> None:
    grid, robots = build_grid(ROOM), robots_at(kernels, (0, 3, 0), (0, -3, 0), (0, 0, 0))
    types = [np.array([[0, 0, 0], [0, 0, pi / 2]]), np.empty((0, 3)), AHEAD]
    ranges = kernels.sonar(grid, robots, sonar_mounts(types, [0, 1, 2]), 8.0)
    np.testing.assert_allclose(ranges, [[5, 2], [8, 8], [5, 8]])


def test_only_some_robots_carry_a_laser(kernels: Kernels) -> None:
    grid, robots = build_grid(ROOM), robots_at(kernels, (-3, 0, 0), (3, 0, pi))
    fan, owners = laser_fan((0.1, 0, 0), 0.0, 1.0, 1), np.array([1], dtype=np.int32)
    ranges = kernels.cast_fans(grid, robots, fan, 20.0, owners=owners)
    np.testing.assert_allclose(ranges, [[6 - 0.1 - 0.25]])


def test_robots_outside_the_map_see_it_and_each_other(kernels: Kernels) -> None:
    grid = build_grid(ROOM)
    robots = robots_at(kernels, (5e4, 0, pi), (5e4 + 3, 0, pi), (0, -1e6, pi / 2))
    ranges = kernels.sonar(grid, robots, sonar_mounts([AHEAD], [0] * 3), inf)
    np.testing.assert_allclose(ranges[:, 0], [5e4 - 5, 2.75, 1e6 - 5], rtol=0, atol=1e-6)
    assert kernels.sonar(grid, robots, sonar_mounts([AHEAD], [0] * 3), 5.0).max() == 5.0


def test_a_world_without_walls_or_robots_answers(kernels: Kernels) -> None:
    grid, robots = build_grid(np.empty((0, 4))), robots_at(kernels)
    one = np.zeros((1, 2)), np.zeros(1)
    ranges = cast_rays(kernels, grid, robots, *one, owner=NOBODY, limit=4.0)
    assert ranges.tolist() == [4.0]
    assert kernels.sonar(grid, robots, sonar_mounts([AHEAD], []), 4.0).shape == (0, 1)
    assert kernels.cast_fans(grid, robots, laser_fan((0, 0, 0), 0, 1, 2), 4.0).shape == (0, 2)
    assert kernels.blocked(grid, robots, robots.poses).shape == (0,)


def test_a_robot_is_not_in_its_own_way(kernels: Kernels) -> None:
    grid, robots = build_grid(ROOM), robots_at(kernels, (0, 0, 0), (1, 0, 0))
    apart, close = [[0.1, 0.7], [0, 0], [0, 0]], [[0.6, 0.7], [0, 0], [0, 0]]
    assert kernels.blocked(grid, robots, np.array(apart)).tolist() == [False, False]
    assert kernels.blocked(grid, robots, np.array(close)).tolist() == [True, False]


def test_touching_is_free(kernels: Kernels) -> None:
    grid, robots = build_grid(ROOM), robots_at(kernels, (0, 0, 0))
    resting = np.array([[4.75], [0], [0]])
    assert not kernels.blocked(grid, robots, resting)[0]
    assert kernels.blocked(grid, robots, resting + 1e-6)[0]


def test_threads_change_nothing() -> None:
    random, count = np.random.default_rng(3), 200
    alone, shared = Kernels(), Kernels(threads=2)
    poses = np.column_stack([random.uniform(-5, 5, (count, 2)), random.uniform(-3, 3, count)])
    robots, grid = robots_at(alone, *map(tuple, poses.tolist())), build_grid(ROOM)
    mounts, fan = sonar_mounts([AHEAD], [0] * count), laser_fan((0, 0, 0), -1.5, 0.1, 31)
    one, other = (
        [
            k.sonar(grid, robots, mounts, 5.0),
            k.cast_fans(grid, robots, fan, 8.0),
            k.blocked(grid, robots, robots.poses),
        ]
        for k in (alone, shared)
    )
    for a, b in zip(one, other, strict=True):
        np.testing.assert_array_equal(a, b)


def test_impossible_sensors_are_refused() -> None:
    with pytest.raises(ConfigError, match="at least 1"):
        sonar_mounts([AHEAD], [0], rays=0)
    with pytest.raises(ConfigError, match="there are 1"):
        sonar_mounts([AHEAD], [1])
    with pytest.raises(ConfigError, match="positive"):
        laser_fan((0, 0, 0), 0.0, 0.0, 5)


def test_a_beam_that_touches_a_walls_end_sees_it(kernels: Kernels) -> None:
    step, count = pi / 180, 181
    angles = -pi / 2 + step * np.arange(count)
    ends = [3 * np.stack([np.cos(a), np.sin(a)], axis=1) for a in (angles, angles + 0.4 * step)]
    grid, robots = build_grid(np.concatenate(ends, axis=1)), robots_at(kernels, (0, 0, 0))
    for start in (-pi / 2, 3 * pi / 2):
        fan = laser_fan((0, 0, 0), start, step, count)
        np.testing.assert_allclose(kernels.cast_fans(grid, robots, fan, 8.0), 3.0, atol=1e-6)
