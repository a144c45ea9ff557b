"""The kernels agree with the plain ray caster and footprint test."""

from math import cos, pi, sin

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.maps import read_map
from pioneer3.sim.collision import footprint_hits
from pioneer3.sim.kernels import (
    Kernels,
    Reflectors,
    find_edges,
    laser_fan,
    sonar_mounts,
)
from pioneer3.sim.kernels.echoes import ALL, SHADE
from pioneer3.sim.raycast import cast_reference, ranges_reference
from tests.combinations import examples
from tests.property.scenes import (
    ANGLES,
    BODIES,
    COORDINATES,
    LIMITS,
    MAPS,
    MOUNTS,
    ODD_BODIES,
    WALLS,
    Scene,
    scene_of,
)
from tests.rays import cast_rays

Float = NDArray[np.float64]

WIDTH = 0.5
"""Of a beam [rad]."""


@pytest.fixture(scope="module", params=["compiled", "plain"])
def kernels(request: pytest.FixtureRequest) -> Kernels:
    return Kernels(compiled=request.param == "compiled")


def check_rays(kernels: Kernels, scene: Scene, rays: Float, limit: float) -> None:
    """Compare rays x, y, theta (R, 3), each without one of the robots in turn."""
    owners = np.arange(len(rays), dtype=np.int32) % (len(scene.robots) + 1) - 1
    origins, angles = rays[:, :2], rays[:, 2]
    found = cast_rays(kernels, scene.grid, scene.robots, origins, angles, owner=owners, limit=limit)
    for k, (x, y, theta) in enumerate(rays.tolist()):
        seen = scene.around(int(owners[k]))
        plain = cast_reference(np.array([x, y]), np.array([theta]), seen, limit)
        np.testing.assert_allclose(found[k], plain[0], rtol=0, atol=1e-6)


def reflected(
    origin: Float, angle: float, walls: Float, others: Float, *, limit: float, steep: float
) -> Float:
    """Return the range at which a ray echoes, at least and at most [m].

    They differ where rounding decides which of two walls is nearer, or whether one is steep enough.
    """
    angles = np.array([angle])
    each = ranges_reference(origin, angles, walls, limit)[0]
    along = walls[:, 2:] - walls[:, :2]
    sines = abs(cos(angle) * along[:, 1] - sin(angle) * along[:, 0]) / np.hypot(*along.T)
    robot = float(cast_reference(origin, angles, others, limit)[0])
    nearest, found = each.min(initial=limit), []
    for slack in (-1e-6, 1e-6):
        for tie in (0.0, 1e-6):
            echo = each[sines >= steep + slack].min(initial=limit)
            heard = echo if echo <= nearest + tie else limit
            found += [robot if robot < nearest else heard]
            if nearest - tie <= robot <= nearest + tie:
                found += [heard, robot]
    return np.array([min(found), max(found)])


def within(walls: Float, origin: Float, reach: float) -> Float:
    """Return the walls that may be within `reach` [m] of a point."""
    low = np.minimum(walls[:, :2], walls[:, 2:]) - reach <= origin
    high = np.maximum(walls[:, :2], walls[:, 2:]) + reach >= origin
    return walls[(low & high).all(axis=1)]


def edges_heard(
    origin: Float, axis: float, walls: Float, echoes: Reflectors, limit: float
) -> Float:
    """Return the range to the nearest edge in a beam [m], at least and at most, up to `limit`.

    They differ where rounding decides whether an edge is in the beam, near enough or in sight.
    """
    found = [[limit], [limit]]
    if echoes.edges is not None:
        apart = echoes.edges.walls[:, :2] - origin
        for x, y in apart[np.hypot(*apart.T) < echoes.edge_range + 1e-6].tolist():
            away, bearing = np.hypot(x, y), np.arctan2(y, x)
            sight = cast_reference(origin, np.array([bearing]), walls, limit)[0]
            off = abs(float(np.angle(np.exp(1j * (bearing - axis)))))
            for near, slack in zip(found, (1e-6, -1e-6), strict=True):
                if (
                    away < echoes.edge_range + slack
                    # which way it is to an edge that is touched is noise
                    and (off <= WIDTH / 2 + slack if away > 1e-9 else slack > 0)
                    and sight >= away - SHADE - slack
                ):
                    near.append(away)
    return np.array([min(near) for near in found])


def check_sonar(
    kernels: Kernels, scene: Scene, limit: float, rays: int, *, echoes: Reflectors = ALL
) -> None:
    """Compare all transducers, then those of some robots alone, then some transducers."""
    kinds = [n % 2 for n in range(len(scene.robots))]
    mounts = sonar_mounts(MOUNTS, kinds, rays=rays, width=WIDTH)
    found = kernels.sonar(scene.grid, scene.robots, mounts, limit, echoes=echoes)
    spread: Float = np.linspace(-WIDTH / 2, WIDTH / 2, rays) if rays > 1 else np.zeros(1)
    for n, kind in enumerate(kinds):
        pose, expected = scene.pose(n), np.full((3, 2), limit)
        for m, mount in enumerate(MOUNTS[kind].tolist()):
            at = pose @ Pose2(*mount)
            origin, turns = np.array([at.x, at.y]), pose.theta + mount[2] + spread
            if echoes is not ALL:
                walls, others = within(scene.grid.walls, origin, limit), scene.others(n)
                each = [
                    reflected(origin, turn, walls, others, limit=limit, steep=echoes.steep)
                    for turn in turns.tolist()
                ]
                if rays > 1:
                    axis = pose.theta + mount[2]
                    each.append(edges_heard(origin, axis, walls, echoes, limit))
                expected[m] = np.min(each, axis=0)
            else:
                expected[m] = cast_reference(origin, turns, scene.around(n), limit).min()
        low, high = expected.T - [[1e-6], [-1e-6]]
        assert ((low <= found[n]) & (found[n] <= high)).all(), (n, found[n], expected)
    some = np.arange(len(kinds), dtype=np.int32)[::-2]
    heard = kernels.sonar(scene.grid, scene.robots, mounts, limit, echoes=echoes, owners=some)
    np.testing.assert_array_equal(heard, found[some])
    few = mounts.only([[2, 0], []])
    heard = kernels.sonar(scene.grid, scene.robots, few, limit, echoes=echoes)
    np.testing.assert_allclose(heard[::2], found[::2, [2, 0]], rtol=0, atol=1e-9)
    assert (heard[1::2] == limit).all()


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
        hits = footprint_hits(pose, front, rear, half, scene.around(n))
        assert found[n] == (hits and not scene.robots.hidden[n])


RAYS = st.lists(st.tuples(COORDINATES, COORDINATES, ANGLES), max_size=8).map(
    lambda rows: np.array(rows, dtype=float).reshape(-1, 3)
)


@given(WALLS, BODIES, RAYS, LIMITS)
@settings(max_examples=examples(150))
def test_rays_agree_with_the_reference(
    kernels: Kernels, walls: Float, bodies: list[tuple[float, ...]], rays: Float, limit: float
) -> None:
    check_rays(kernels, scene_of(kernels, walls, bodies), rays, limit)


@given(WALLS, BODIES, LIMITS, st.sampled_from([1, 5]))
@settings(max_examples=examples(100))
def test_sonar_agrees_with_the_reference(
    kernels: Kernels, walls: Float, bodies: list[tuple[float, ...]], limit: float, rays: int
) -> None:
    check_sonar(kernels, scene_of(kernels, walls, bodies), limit, rays)


# hidden robots are far away: they are not there for any sensor that ends somewhere
FINITE_LIMITS = st.sampled_from([0.5, 3.0, 8.0, 40.0])

# a wall without length has no direction
LONG_WALLS = WALLS.map(lambda walls: walls[np.hypot(*(walls[:, 2:] - walls[:, :2]).T) > 1e-3])


@given(LONG_WALLS, ODD_BODIES, FINITE_LIMITS, st.tuples(st.sampled_from([1, 5]), st.floats(1, 89)))
@settings(max_examples=examples(100))
def test_only_walls_that_are_met_steeply_echo(
    kernels: Kernels,
    walls: Float,
    bodies: list[tuple[float, ...]],
    limit: float,
    beam: tuple[int, float],
) -> None:
    rays, critical = beam
    scene, steep = scene_of(kernels, walls, bodies), cos(np.radians(critical))
    check_sonar(kernels, scene, limit, rays, echoes=Reflectors(steep=steep))


@given(
    LONG_WALLS,
    ODD_BODIES,
    FINITE_LIMITS,
    st.tuples(st.sampled_from([2, 5]), st.sampled_from([0.7, 2.1]), st.sampled_from([0, 0.9, 1.1])),
)
@settings(max_examples=examples(100))
def test_edges_that_are_near_and_in_sight_echo(
    kernels: Kernels,
    walls: Float,
    bodies: list[tuple[float, ...]],
    limit: float,
    beam: tuple[int, float, float],
) -> None:
    rays, edge_range, steep = beam
    scene = scene_of(kernels, walls, bodies)
    echoes = Reflectors(steep=steep, edges=find_edges(scene.grid), edge_range=edge_range)
    check_sonar(kernels, scene, limit, rays, echoes=echoes)


@given(WALLS, ODD_BODIES, RAYS, FINITE_LIMITS)
@settings(max_examples=examples(100))
def test_cut_corners_and_hidden_robots_agree_with_the_reference(
    kernels: Kernels, walls: Float, bodies: list[tuple[float, ...]], rays: Float, limit: float
) -> None:
    scene = scene_of(kernels, walls, bodies)
    check_rays(kernels, scene, rays, limit)
    check_sonar(kernels, scene, limit, 1)
    check_fan(kernels, scene, (-pi, pi / 8, 17), limit)
    check_blocked(kernels, scene, scene.robots.poses.copy())


@given(ODD_BODIES)
@settings(max_examples=examples(50))
def test_an_octagon_is_a_rectangle_without_its_corners(
    kernels: Kernels, bodies: list[tuple[float, ...]]
) -> None:
    robots = scene_of(kernels, np.empty((0, 4)), bodies).robots
    for n in range(len(robots)):
        x, y, theta, front, rear, half, cut, hidden = robots.state[:, n].tolist()
        if hidden:
            continue
        ahead, left = front - cut, half - cut
        corners = [(front, left), (ahead, half), (cut - rear, half), (-rear, left)]
        corners += [(-rear, -left), (cut - rear, -half), (ahead, -half), (front, -left)]
        points = [Pose2(x, y, theta) @ Pose2(*corner) for corner in corners]
        placed = robots.outlines[n, :, :2]
        for point in points:
            assert np.hypot(*(placed - (point.x, point.y)).T).min() < 1e-9
        for px, py in placed.tolist():
            assert min(np.hypot(point.x - px, point.y - py) for point in points) < 1e-9


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
@settings(max_examples=examples(150))
def test_fans_agree_with_the_reference(
    kernels: Kernels,
    walls: Float,
    bodies: list[tuple[float, ...]],
    fan: tuple[float, float, int],
    limit: float,
) -> None:
    check_fan(kernels, scene_of(kernels, walls, bodies), fan, limit)


@given(WALLS, BODIES, st.tuples(COORDINATES, COORDINATES, ANGLES))
@settings(max_examples=examples(150))
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
@pytest.mark.parametrize(
    "name",
    [
        *("AMROffice", "office", "triangle"),
        pytest.param("columbia", marks=pytest.mark.thorough),  # with all its walls, four seconds
    ],
)
def test_every_map_agrees_with_the_reference(name: str) -> None:
    kernels = Kernels()
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
    steep = cos(np.radians(27))
    check_sonar(kernels, scene, 5.0, 1, echoes=Reflectors(steep=steep))
    edges = find_edges(scene.grid)
    check_sonar(kernels, scene, 5.0, 5, echoes=Reflectors(steep=steep, edges=edges, edge_range=1.0))
    check_fan(kernels, scene, (-pi / 2, pi / 60, 61), 8.0)
    check_blocked(kernels, scene, scene.robots.poses.copy())
