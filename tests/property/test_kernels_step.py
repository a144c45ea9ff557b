"""Both implementations move robots alike, and nothing ever stands in anything."""

from dataclasses import dataclass
from importlib.util import find_spec
from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.random import Generator, default_rng
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.sim.collision import footprint_hits
from pioneer3.sim.kernels import Drives, Grid, Kernels, Robots, build_grid, load_kernels
from pioneer3.sim.kernels.drives import (
    ACCELERATION,
    ANGULAR,
    BASE,
    DECELERATION,
    HARDEST,
    HELD,
    LINEAR,
    POWERED,
    REMAINING,
    TARGET,
    TOP,
    VELOCITY,
)
from pioneer3.sim.maps import read_map
from tests.property.scenes import MAPS, NAMES

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]

both = pytest.mark.skipif(not find_spec("numba"), reason="no numba")
STEPS = 50
FRONT, REAR, HALF = 0.21, 0.3, 0.2


@dataclass(frozen=True, slots=True)
class Run:
    """One implementation with its robots and their drives."""

    kernels: Kernels
    robots: Robots
    drives: Drives


def crowd(
    kernels: Kernels, grid: Grid, random: Generator, counts: tuple[int, int], spread: Float
) -> Robots:
    """Place so many robots, and after them things with cut corners, in a box x0, y0, x1, y1."""
    count = sum(counts)
    cut = np.repeat([0.0, HALF / 2], counts)
    front, rear, half = (random.uniform(0.7, 1.3, count) * size for size in (FRONT, REAR, HALF))
    robots = Robots(front, rear, half, cut)
    robots.theta[:] = random.uniform(-pi, pi, count)
    lost = np.ones(count, dtype=np.bool_)
    while lost.any():
        robots.poses[:2, lost] = random.uniform(spread[:2], spread[2:], (int(lost.sum()), 2)).T
        kernels.place(robots)
        lost = kernels.blocked(grid, robots, robots.poses)
    return robots


def drives_of(count: int, *, noisy: bool) -> Drives:
    drives = Drives.at_rest(count)
    drives.axes[[ACCELERATION, DECELERATION, TOP]] = np.array(
        [[[0.3], [1.7]], [[0.5], [2.0]], [[0.75], [1.7]]]
    )
    drives.flags[POWERED], drives.wheels[BASE] = 1, 0.4
    if noisy:
        drives.errors[:] = np.array([1.01, 0.02, 0.01, 0.95, 0.02, 0.03, 0.02])[:, None]
    return drives


def command(runs: list[Run], random: Generator) -> None:
    """Give every robot something to do: a velocity, a distance, the watchdog's hold, no power."""
    count = len(runs[0].drives)
    speeds, rates = random.uniform(-0.4, 0.9, count), random.uniform(-2.0, 2.0, count)
    covers, ways = random.random((2, count)) < 0.2, random.uniform(-1.0, 1.0, (2, count))
    held, powered = random.random(count) < 0.1, random.random(count) < 0.9
    for run in runs:
        axes, flags = run.drives.axes, run.drives.flags
        run.drives.go(speeds, rates)
        axes[TARGET][covers], axes[REMAINING][covers] = 0.0, ways[covers]
        axes[TARGET][:, ~powered], axes[REMAINING][:, ~powered] = 0.0, np.nan
        flags[HELD], flags[POWERED] = held, powered


def check_together(runs: list[Run]) -> None:
    one, other = runs
    np.testing.assert_allclose(one.robots.poses, other.robots.poses, rtol=0, atol=1e-9)
    np.testing.assert_allclose(one.robots.outlines, other.robots.outlines, rtol=0, atol=1e-9)
    np.testing.assert_allclose(one.drives.axes, other.drives.axes, rtol=0, atol=1e-9)
    np.testing.assert_allclose(one.drives.wheels, other.drives.wheels, rtol=1e-9, atol=1e-9)
    np.testing.assert_array_equal(one.drives.flags, other.drives.flags)


def check_apart(grid: Grid, robots: Robots, count: int) -> None:
    """Hold every robot against walls and others, plainly."""
    for n in range(count):
        others = np.delete(robots.outlines, n, axis=0).reshape(-1, 4)
        pose, (front, rear, half) = Pose2(*robots.poses[:, n].tolist()), robots.state[3:6, n]
        around = np.concatenate([grid.walls, others])
        assert not footprint_hits(pose, float(front), float(rear), float(half), around), n


def both_of(
    grid: Grid, seed: int, counts: tuple[int, int], *, noisy: bool, spread: Float
) -> list[Run]:
    """Return the same crowd twice, once for each implementation."""
    runs = []
    for kernels in (load_kernels("numba"), load_kernels("numpy")):
        robots = crowd(kernels, grid, default_rng(seed), counts, spread)
        runs.append(Run(kernels, robots, drives_of(counts[0], noisy=noisy)))
    return runs


def drive(runs: list[Run], grid: Grid, random: Generator, *, dt: float, noisy: bool) -> None:
    count = len(runs[0].drives)
    for number in range(STEPS):
        if number % 7 == 0:
            command(runs, random)
        noise = random.standard_normal((3, count)) if noisy else None
        for run in runs:
            run.kernels.step(grid, run.robots, run.drives, dt, noise)
            assert not run.kernels.blocked(grid, run.robots, run.robots.poses)[:count].any()
        check_together(runs)


@both
@given(
    st.integers(0, 10**6),
    st.integers(1, 6),
    st.integers(0, 3),
    st.booleans(),
    st.sampled_from([0.02, 0.05, 0.1]),
)
@settings(max_examples=40, deadline=None)
def test_both_move_robots_alike_and_never_into_anything(
    seed: int, count: int, things: int, noisy: bool, dt: float
) -> None:
    random = default_rng(seed)
    box = np.array([[-2, -2, 2, -2], [2, -2, 2, 2], [2, 2, -2, 2], [-2, 2, -2, -2]])
    start = random.uniform(-2, 2, (4, 2))
    walls = np.concatenate([start, start + random.uniform(-0.5, 0.5, (4, 2))], axis=1)
    grid = build_grid(np.concatenate([box, walls]))
    spread = np.array([-3.0, -3.0, 3.0, 3.0])
    runs = both_of(grid, seed, (count, things), noisy=noisy, spread=spread)
    drive(runs, grid, random, dt=dt, noisy=noisy)
    check_apart(grid, runs[0].robots, count)


@pytest.mark.skipif(not MAPS.is_dir(), reason="no maps here")
@pytest.mark.parametrize("name", ["AMROffice", "columbia", "office", "triangle"])
@both
def test_both_move_robots_alike_on_every_map(name: str) -> None:
    walls = read_map(MAPS / f"{name}.map").walls
    points = walls.reshape(-1, 2)
    middle = np.median(points, axis=0)
    spread = np.concatenate([middle - 6.0, middle + 6.0])
    grid = build_grid(walls)
    runs = both_of(grid, 5, (20, 3), noisy=True, spread=spread)
    drive(runs, grid, default_rng(6), dt=0.1, noisy=True)
    check_apart(grid, runs[0].robots, 20)


@pytest.fixture(params=NAMES, scope="module")
def kernels(request: pytest.FixtureRequest) -> Kernels:
    return load_kernels(request.param)


def side_by_side(kernels: Kernels, gap: float, heading: float) -> Robots:
    size = np.array([0.25, 0.25])
    robots = Robots(size, size, 0.8 * size)
    robots.poses[:] = [[0.0, gap], [0.0, 0.0], [heading, heading]]
    kernels.place(robots)
    return robots


NOTHING = build_grid(np.empty((0, 4)))


@pytest.mark.parametrize("heading", np.linspace(0, pi / 2, 10).tolist())
def test_robots_that_turn_beside_each_other_stay_apart(kernels: Kernels, heading: float) -> None:
    for gap in np.linspace(0.45, 0.65, 41).tolist():
        robots, drives = side_by_side(kernels, gap, heading), drives_of(2, noisy=False)
        if kernels.blocked(NOTHING, robots, robots.poses).any():
            continue
        drives.axes[TOP, ANGULAR] = drives.axes[VELOCITY, ANGULAR] = 2.0
        drives.axes[TARGET, ANGULAR] = 2.0
        for _ in range(5):
            kernels.step(NOTHING, robots, drives, 0.1)
            assert not kernels.blocked(NOTHING, robots, robots.poses).any(), gap


@pytest.mark.parametrize("speed", [0.0, 0.5])
def test_without_power_a_robot_only_ever_slows_down(kernels: Kernels, speed: float) -> None:
    robots, drives = side_by_side(kernels, 5.0, pi / 2), drives_of(2, noisy=False)
    drives.go(np.array(0.7), np.array(0.0))
    drives.flags[POWERED, 1] = 0
    drives.axes[VELOCITY, LINEAR, 1] = speed
    for _ in range(5):
        kernels.step(NOTHING, robots, drives, 0.1)
    assert drives.axes[VELOCITY, LINEAR].tolist() == [pytest.approx(0.15), 0.0]
    assert robots.y[1] == pytest.approx(speed**2 / (2 * HARDEST), abs=1e-9)
