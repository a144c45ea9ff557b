"""However robots are driven, nothing ever stands in anything; with and without numba alike."""

from math import cos, pi, sqrt

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numpy.random import Generator, default_rng
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.maps import read_map
from pioneer3.sim.collision import footprint_hits
from pioneer3.sim.kernels import DriveArrays, Grid, Kernels, RobotArrays, build_grid
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
from tests.combinations import examples
from tests.property.scenes import MAPS

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]

STEPS = 50
FRONT, REAR, HALF = 0.21, 0.3, 0.2


def crowd(
    kernels: Kernels, grid: Grid, random: Generator, counts: tuple[int, int], spread: Float
) -> RobotArrays:
    """Place so many robots, and after them things with cut corners, in a box x0, y0, x1, y1."""
    count = sum(counts)
    cut = np.repeat([0.0, HALF / 2], counts)
    front, rear, half = (random.uniform(0.7, 1.3, count) * size for size in (FRONT, REAR, HALF))
    robots = RobotArrays(front, rear, half, cut)
    robots.theta[:] = random.uniform(-pi, pi, count)
    lost = np.ones(count, dtype=np.bool_)
    while lost.any():
        robots.poses[:2, lost] = random.uniform(spread[:2], spread[2:], (int(lost.sum()), 2)).T
        kernels.place(robots)
        lost = kernels.blocked(grid, robots, robots.poses)
    return robots


def drives_of(count: int, *, noisy: bool) -> DriveArrays:
    drives = DriveArrays.at_rest(count)
    drives.axes[[ACCELERATION, DECELERATION, TOP]] = np.array(
        [[[0.3], [1.7]], [[0.5], [2.0]], [[0.75], [1.7]]]
    )
    drives.flags[POWERED], drives.wheels[BASE] = 1, 0.4
    if noisy:
        drives.errors[:] = np.array([1.01, 0.02, 0.01, 0.95, 0.02, 0.03, 0.02])[:, None]
    return drives


def command(drives: DriveArrays, random: Generator) -> None:
    """Give every robot something to do: a velocity, a distance, the watchdog's hold, no power."""
    count = len(drives)
    speeds, rates = random.uniform(-0.4, 0.9, count), random.uniform(-2.0, 2.0, count)
    covers, ways = random.random((2, count)) < 0.2, random.uniform(-1.0, 1.0, (2, count))
    held, powered = random.random(count) < 0.1, random.random(count) < 0.9
    drives.go(speeds, rates)
    drives.axes[TARGET][covers], drives.axes[REMAINING][covers] = 0.0, ways[covers]
    drives.axes[TARGET][:, ~powered], drives.axes[REMAINING][:, ~powered] = 0.0, np.nan
    drives.flags[HELD], drives.flags[POWERED] = held, powered


def check_apart(grid: Grid, robots: RobotArrays, count: int) -> None:
    """Hold every robot against walls and others, plainly."""
    for n in range(count):
        others = np.delete(robots.outlines, n, axis=0).reshape(-1, 4)
        pose, (front, rear, half) = Pose2(*robots.poses[:, n].tolist()), robots.state[3:6, n]
        around = np.concatenate([grid.walls, others])
        assert not footprint_hits(pose, float(front), float(rear), float(half), around), n


def drive(
    kernels: Kernels, grid: Grid, robots: RobotArrays, random: Generator, *, count: int, noisy: bool
) -> None:
    """Drive the first `count` robots about for a while."""
    drives = drives_of(count, noisy=noisy)
    for number in range(STEPS):
        if number % 7 == 0:
            command(drives, random)
        noise = random.standard_normal((3, count)) if noisy else None
        kernels.step(grid, robots, drives, random.choice([0.02, 0.05, 0.1]), noise)
        assert not kernels.blocked(grid, robots, robots.poses)[:count].any()
    check_apart(grid, robots, count)


@pytest.fixture(scope="module", params=["compiled", "plain"])
def kernels(request: pytest.FixtureRequest) -> Kernels:
    return Kernels(compiled=request.param == "compiled")


@given(st.integers(0, 10**6), st.integers(1, 6), st.integers(0, 3), st.booleans())
@example(415, 4, 0, False)  # a corner came to rest against the side of another
@settings(max_examples=examples(40))
def test_robots_never_drive_into_anything(
    kernels: Kernels, seed: int, count: int, things: int, noisy: bool
) -> None:
    random = default_rng(seed)
    box = np.array([[-2, -2, 2, -2], [2, -2, 2, 2], [2, 2, -2, 2], [-2, 2, -2, -2]])
    start = random.uniform(-2, 2, (4, 2))
    walls = np.concatenate([start, start + random.uniform(-0.5, 0.5, (4, 2))], axis=1)
    grid = build_grid(np.concatenate([box, walls]))
    robots = crowd(kernels, grid, random, (count, things), np.array([-3.0, -3.0, 3.0, 3.0]))
    drive(kernels, grid, robots, random, count=count, noisy=noisy)


@pytest.mark.skipif(not MAPS.is_dir(), reason="no maps here")
@pytest.mark.parametrize("name", ["AMROffice", "columbia", "office", "triangle"])
def test_robots_never_drive_into_anything_on_any_map(kernels: Kernels, name: str) -> None:
    walls = read_map(MAPS / f"{name}.map").walls
    middle = np.median(walls.reshape(-1, 2), axis=0)
    grid, random = build_grid(walls), default_rng(6)
    spread = np.concatenate([middle - 6.0, middle + 6.0])
    robots = crowd(kernels, grid, random, (20, 3), spread)
    drive(kernels, grid, robots, random, count=20, noisy=True)


def side_by_side(kernels: Kernels, gap: float, heading: float) -> RobotArrays:
    size = np.array([0.25, 0.25])
    robots = RobotArrays(size, size, 0.8 * size)
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


@pytest.mark.parametrize("depth", np.linspace(0.1, 2.0, 20).tolist())
def test_a_corner_against_a_side_only_touches_for_both_robots(
    kernels: Kernels, depth: float
) -> None:
    way, size = 0.001, np.array([0.2, 0.2])
    robots, drives = RobotArrays(size, size, size), drives_of(2, noisy=False)
    beside = 0.2 + 0.2 * sqrt(2) - depth * 1e-9 + way * cos(pi / 4)
    robots.poses[:] = [[0.0, beside], [0.0, 0.0], [0.0, 3 * pi / 4]]
    kernels.place(robots)
    drives.axes[TOP, LINEAR] = 1.0
    drives.axes[VELOCITY, LINEAR, 1] = drives.axes[TARGET, LINEAR, 1] = way / 0.02
    kernels.step(NOTHING, robots, drives, 0.02)
    assert robots.x[1] < beside
    assert not kernels.blocked(NOTHING, robots, robots.poses).any()


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
