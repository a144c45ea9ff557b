"""Both implementations of the kernels agree with the plain ray caster and footprint test."""

from dataclasses import dataclass
from importlib.util import find_spec
from math import cos, inf, pi, sin
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.sim.collision import footprint_hits
from pioneer3.sim.kernels import (
    Grid,
    Kernels,
    Robots,
    build_grid,
    laser_fan,
    load_kernels,
    sonar_mounts,
)
from pioneer3.sim.maps import read_map
from pioneer3.sim.raycast import cast_reference

Float = NDArray[np.float64]

MAPS = Path(__file__).parents[3] / "shared/maps"
NAMES = [
    "numpy",
    pytest.param("numba", marks=pytest.mark.skipif(not find_spec("numba"), reason="no numba")),
]

# whole and half numbers make corners, walls along rays and origins on walls likely
COORDINATES = st.one_of(
    st.integers(-4, 4).map(float), st.integers(-8, 8).map(lambda n: n / 2), st.floats(-12, 12)
)
ANGLES = st.one_of(st.integers(-8, 8).map(lambda n: n * np.pi / 4), st.floats(-7, 7))
WALLS = st.lists(st.tuples(*[COORDINATES] * 4), max_size=12).map(
    lambda rows: np.array(rows, dtype=float).reshape(-1, 4)
)
SIZES = st.sampled_from([0.1, 0.25, 0.5])
BODIES = st.lists(st.tuples(COORDINATES, COORDINATES, ANGLES, SIZES, SIZES, SIZES), max_size=5)
LIMITS = st.sampled_from([0.5, 3.0, 8.0, 40.0, inf])
MOUNTS = [np.array([[0.2, 0.0, 0.0], [0.1, 0.1, pi / 2], [-0.2, -0.1, 3.0]]), np.zeros((1, 3))]


@dataclass
class Scene:
    """Walls and robots, placed."""

    grid: Grid
    robots: Robots

    def around(self, n: int) -> Float:
        """Return what robot `n` can meet; -1 meets all."""
        others = [n != k for k in range(len(self.robots))]
        return np.concatenate([self.grid.walls, self.robots.outlines[others].reshape(-1, 4)])

    def pose(self, n: int) -> Pose2:
        return Pose2(*self.robots.poses[:, n].tolist())


@pytest.fixture(params=NAMES, scope="module")
def kernels(request: pytest.FixtureRequest) -> Kernels:
    return load_kernels(request.param)


def scene_of(kernels: Kernels, walls: Float, bodies: list[tuple[float, ...]]) -> Scene:
    state = np.array(bodies, dtype=float).reshape(-1, 6).T
    robots = Robots(*state[3:6])
    robots.state[:3] = state[:3]
    kernels.place(robots)
    return Scene(build_grid(walls), robots)


def check_rays(kernels: Kernels, scene: Scene, rays: Float, limit: float) -> None:
    """Compare rays x, y, theta (R, 3), each without one of the robots in turn."""
    owners = np.arange(len(rays), dtype=np.int32) % (len(scene.robots) + 1) - 1
    origins, angles = rays[:, :2], rays[:, 2]
    found = kernels.cast_rays(scene.grid, scene.robots, origins, angles, owner=owners, limit=limit)
    for k, (x, y, theta) in enumerate(rays.tolist()):
        seen = scene.around(int(owners[k]))
        plain = cast_reference(np.array([x, y]), np.array([theta]), seen, limit)
        np.testing.assert_allclose(found[k], plain[0], rtol=0, atol=1e-6)


def check_sonar(kernels: Kernels, scene: Scene, limit: float, rays: int) -> None:
    kinds = [n % 2 for n in range(len(scene.robots))]
    mounts = sonar_mounts(MOUNTS, kinds, rays=rays, width=0.5)
    found = kernels.sonar(scene.grid, scene.robots, mounts, limit)
    spread: Float = np.linspace(-0.25, 0.25, rays) if rays > 1 else np.zeros(1)
    for n, kind in enumerate(kinds):
        pose, expected = scene.pose(n), np.full(3, limit)
        for m, mount in enumerate(MOUNTS[kind].tolist()):
            at = pose @ Pose2(*mount)
            turns = pose.theta + mount[2] + spread
            plain = cast_reference(np.array([at.x, at.y]), turns, scene.around(n), limit)
            expected[m] = plain.min()
        np.testing.assert_allclose(found[n], expected, rtol=0, atol=1e-6)


def check_fan(kernels: Kernels, scene: Scene, fan: tuple[float, float, int], limit: float) -> None:
    start, step, count = fan
    mount = (0.15, -0.05, 0.5)
    laser = laser_fan(mount, start, step, count)
    found = kernels.cast_fans(scene.grid, scene.robots, laser, limit)
    for n in range(len(scene.robots)):
        pose = scene.pose(n)
        x = pose.x + cos(pose.theta) * mount[0] - sin(pose.theta) * mount[1]
        y = pose.y + sin(pose.theta) * mount[0] + cos(pose.theta) * mount[1]
        turns = pose.theta + mount[2] + start + step * np.arange(count, dtype=np.float64)
        plain = cast_reference(np.array([x, y]), turns, scene.around(n), limit)
        np.testing.assert_allclose(found[n], plain, rtol=0, atol=1e-6)


def check_blocked(kernels: Kernels, scene: Scene, poses: Float) -> None:
    found = kernels.blocked(scene.grid, scene.robots, poses)
    for n in range(len(scene.robots)):
        front, rear, half = scene.robots.state[3:6, n].tolist()
        pose = Pose2(*poses[:, n].tolist())
        assert found[n] == footprint_hits(pose, front, rear, half, scene.around(n))


RAYS = st.lists(st.tuples(COORDINATES, COORDINATES, ANGLES), max_size=8).map(
    lambda rows: np.array(rows, dtype=float).reshape(-1, 3)
)


@given(WALLS, BODIES, RAYS, LIMITS)
@settings(max_examples=150, deadline=None)
def test_rays_agree_with_the_reference(
    kernels: Kernels, walls: Float, bodies: list[tuple[float, ...]], rays: Float, limit: float
) -> None:
    check_rays(kernels, scene_of(kernels, walls, bodies), rays, limit)


@given(WALLS, BODIES, LIMITS, st.sampled_from([1, 5]))
@settings(max_examples=100, deadline=None)
def test_sonar_agrees_with_the_reference(
    kernels: Kernels, walls: Float, bodies: list[tuple[float, ...]], limit: float, rays: int
) -> None:
    check_sonar(kernels, scene_of(kernels, walls, bodies), limit, rays)


FANS = st.sampled_from(
    [
        (-pi / 2, pi / 180, 181),
        (-pi / 4, pi / 4, 3),
        (-pi, pi / 8, 17),
        (-0.5, 2e-6, 20),
        (3.0, 0.25, 20),
        (-7.0, 0.5, 40),
        (0.0, 1.0, 1),
    ]
)


@given(WALLS, BODIES, FANS, LIMITS)
@settings(max_examples=150, deadline=None)
def test_fans_agree_with_the_reference(
    kernels: Kernels,
    walls: Float,
    bodies: list[tuple[float, ...]],
    fan: tuple[float, float, int],
    limit: float,
) -> None:
    check_fan(kernels, scene_of(kernels, walls, bodies), fan, limit)


@given(WALLS, BODIES, st.tuples(COORDINATES, COORDINATES, ANGLES))
@settings(max_examples=150, deadline=None)
def test_blocked_agrees_with_the_footprint_test(
    kernels: Kernels,
    walls: Float,
    bodies: list[tuple[float, ...]],
    shift: tuple[float, float, float],
) -> None:
    scene = scene_of(kernels, walls, bodies)
    check_blocked(kernels, scene, scene.robots.poses.copy())
    check_blocked(kernels, scene, scene.robots.poses + 0.3 * np.array(shift)[:, None])


@pytest.mark.skipif(not MAPS.is_dir(), reason="no maps here")
@pytest.mark.parametrize("name", ["AMROffice", "columbia", "office", "triangle"])
def test_every_map_agrees_with_the_reference(kernels: Kernels, name: str) -> None:
    walls = read_map(MAPS / f"{name}.map").walls
    low, high = walls.reshape(-1, 2).min(axis=0), walls.reshape(-1, 2).max(axis=0)
    random = np.random.default_rng(7)
    # some of them outside, one just beside a wall's end
    places = random.uniform(low - 2.0, high + 2.0, (5, 2))
    places[0] = walls[0, :2] + 0.01
    sizes = np.full((5, 3), 0.25)
    bodies = np.column_stack([places, random.uniform(-pi, pi, 5), sizes])
    scene = scene_of(kernels, walls, [tuple(row) for row in bodies.tolist()])
    along = np.arctan2(walls[::2000, 3] - walls[::2000, 1], walls[::2000, 2] - walls[::2000, 0])
    rays = np.concatenate([bodies[:, :3], np.column_stack([walls[::2000, :2], along])])
    check_rays(kernels, scene, rays, 30.0)
    check_sonar(kernels, scene, 5.0, 5)
    check_fan(kernels, scene, (-pi / 2, pi / 60, 61), 8.0)
    check_blocked(kernels, scene, scene.robots.poses.copy())
