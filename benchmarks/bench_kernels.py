"""Rays and beams per second, how they grow, and how long compiled kernels take to start."""

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from importlib.util import find_spec
from math import ceil, pi, sqrt
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

from benchmarks.table import Row
from pioneer3.maps import shipped_map
from pioneer3.models import load_model
from pioneer3.sim.kernels import (
    Grid,
    Kernels,
    RobotArrays,
    build_grid,
    compiled_kernels,
    laser_fan,
    sonar_mounts,
)
from tests.rays import cast_rays

Float = NDArray[np.float64]

AMR_OFFICE = Path(__file__).parents[2] / "shared/maps/AMROffice.map"
MODEL = load_model("p3dx-sh")
SONAR_LIMIT, LASER_LIMIT, BEAMS = 5.0, 8.0, 181
MANY_RAYS = 20_000
PIECE, WAVE, LASER_REACH = 0.03, 0.01, 32.0
"""Length of the pieces of a scanned wall, how far it waves, range of the simulator's laser [m]."""
PLACES = 1000
"""Places that are looked from in turn: a processor soon knows by heart where ten robots look."""
RAYS_BARS = {1: 1.5, 10: 3.0, 100: 3.0, 1000: 3.0}
"""Million per second, by robots; the 16 rays of one take no longer than their call."""
BEAMS_BARS = {1: 15.0, 10: 25.0, 100: 15.0, 1000: 15.0}
"""Million per second, by robots."""
WARM = (
    "from time import perf_counter as now; import numba; from pioneer3.sim import kernels;"
    "begin = now(); kernels.compiled_kernels(); print(now() - begin)"
)


def office(copies: int = 1) -> Float:
    """Return the lines of an office with a boundary, side by side, shape (W, 4)."""
    if AMR_OFFICE.exists():
        text = AMR_OFFICE.read_text(encoding="ascii", errors="replace")
        lines = text.partition("LINES\n")[2].partition("DATA")[0].split()
        walls = np.array(lines, dtype=np.float64).reshape(-1, 4) / 1000
    else:
        walls = shipped_map("office").walls
    points = walls.reshape(-1, 2)
    (x0, y0), (x1, y1) = points.min(axis=0) - 0.1, points.max(axis=0) + 0.1
    box = [[x0, y0, x1, y0], [x1, y0, x1, y1], [x1, y1, x0, y1], [x0, y1, x0, y0]]
    walls, side = np.concatenate([walls, box]), ceil(sqrt(copies))
    shifts = [(k % side * (x1 - x0 + 1), k // side * (y1 - y0 + 1)) * 2 for k in range(copies)]
    return np.concatenate([walls + shift for shift in shifts])


def scanned() -> Float:
    """Return the office as a scan of it looks: walls of thousands of short pieces, not straight."""
    random, pieces = np.random.default_rng(4), []
    for x0, y0, x1, y1 in office().tolist():
        count = ceil(np.hypot(x1 - x0, y1 - y0) / PIECE)
        points = np.linspace((x0, y0), (x1, y1), count + 1)
        points += random.uniform(-WAVE, WAVE, points.shape)
        pieces.append(np.concatenate([points[:-1], points[1:]], axis=1))
    return np.concatenate(pieces)


def scan_time(kernels: Kernels) -> float:
    """Return the time of a laser's scan in a scanned map [s], the mean of some places."""
    grid = build_grid(scanned())
    robots = crowd(kernels, build_grid(office()), 10)
    kernels.place(robots)
    fan = laser_fan((0.02, 0.0, 0.0), -pi / 2, pi / (BEAMS - 1), BEAMS)
    return seconds(lambda: kernels.cast_fans(grid, robots, fan, LASER_REACH)) / len(robots)


def crowd(kernels: Kernels, grid: Grid, count: int, seed: int = 1) -> RobotArrays:
    """Return so many robots at random free places, where the kernels find them."""
    sizes = (MODEL.length_front, MODEL.length_rear, MODEL.width / 2)
    robots, random = (
        RobotArrays(*(np.full(count, size) for size in sizes)),
        np.random.default_rng(seed),
    )
    points = grid.walls.reshape(-1, 2)
    low, high = points.min(axis=0), points.max(axis=0)
    robots.theta[:] = random.uniform(-pi, pi, count)
    lost = np.ones(count, dtype=np.bool_)
    while lost.any():
        robots.poses[:2, lost] = random.uniform(low, high, (int(lost.sum()), 2)).T
        kernels.place(robots)
        lost = kernels.blocked(grid, robots, robots.poses)
    return robots


def seconds(call: Callable[[], object]) -> float:
    """Return what one call takes at best [s]."""
    call()
    times = []
    for _ in range(15):
        begin = time.perf_counter()
        call()
        times.append(time.perf_counter() - begin)
    repeats = max(1, int(0.01 / min(times)))
    for _ in range(7):
        begin = time.perf_counter()
        for _ in range(repeats):
            call()
        times.append((time.perf_counter() - begin) / repeats)
    return min(times)


def speeds(kernels: Kernels, copies: int, count: int) -> tuple[float, float]:
    """Return rays and beams per second of `count` robots that see each other."""
    grid = build_grid(office(copies))
    crowds = [crowd(kernels, grid, count, seed) for seed in range(ceil(PLACES / count))]
    transducers = np.array([(s.x, s.y, s.theta) for s in MODEL.sonars])
    mounts = sonar_mounts([transducers], [0] * count)
    fan = laser_fan((0.02, 0.0, 0.0), -pi / 2, pi / (BEAMS - 1), BEAMS)
    heard, seen = np.empty((count, mounts.most)), np.empty((count, BEAMS))

    def hear() -> None:
        for robots in crowds:
            kernels.sonar(grid, robots, mounts, SONAR_LIMIT, out=heard)

    def look() -> None:
        for robots in crowds:
            kernels.cast_fans(grid, robots, fan, LASER_LIMIT, out=seen)

    return len(crowds) * heard.size / seconds(hear), len(crowds) * seen.size / seconds(look)


def seconds_per_ray(kernels: Kernels, copies: int) -> float:
    """Return what a ray from a random place among walls takes [s]."""
    grid, random = build_grid(office(copies)), np.random.default_rng(2)
    nobody = np.empty(0)
    robots, points = RobotArrays(nobody, nobody, nobody), grid.walls.reshape(-1, 2)
    kernels.place(robots)
    origins = random.uniform(points.min(axis=0), points.max(axis=0), (MANY_RAYS, 2))
    angles, owner = random.uniform(-pi, pi, MANY_RAYS), np.full(MANY_RAYS, -1, dtype=np.int32)
    took = seconds(
        lambda: cast_rays(kernels, grid, robots, origins, angles, owner=owner, limit=SONAR_LIMIT)
    )
    return took / MANY_RAYS


def compiled_rows() -> Iterator[Row]:
    """Measure compiled kernels on one thread."""
    kernels = compiled_kernels()
    for count, copies in ((1, 1), (10, 1), (100, 1), (1000, 16)):
        rays, beams = speeds(kernels, copies, count)
        yield Row(f"numba: sonar, {count} robots", rays / 1e6, "M/s", RAYS_BARS[count], True)
        yield Row(f"numba: 181 beams, {count} robots", beams / 1e6, "M/s", BEAMS_BARS[count], True)
    few, many = speeds(kernels, 1, 10), speeds(kernels, 100, 1000)
    for what, one, other in zip(("sonar", "beams"), few, many, strict=True):
        yield Row(f"numba: {what} per robot, 1000 as against 10", one / other, "times", 2.2)
    growth = seconds_per_ray(kernels, 405) / seconds_per_ray(kernels, 1)
    yield Row("numba: ray among 100 000 segments as against 247", growth, "times", 2)
    yield Row("numba: 181 beams in a scanned map", 1000 * scan_time(kernels), "ms", 0.5)


def start_rows() -> Iterator[Row]:
    """Measure compiling, then loading what was compiled, each in a new process."""
    with TemporaryDirectory() as cache:
        for what, bar in (("compile", 15.0), ("load from cache", 0.6)):
            command = [sys.executable, "-c", WARM]
            environment = {**os.environ, "NUMBA_CACHE_DIR": cache}
            done = subprocess.run(command, check=True, capture_output=True, env=environment)
            yield Row(f"numba: {what}, without importing numba", float(done.stdout), "s", bar)


def rows() -> Iterator[Row]:
    """Measure everything of this file."""
    if find_spec("numba"):
        yield from start_rows()
        yield from compiled_rows()
    kernels = Kernels(compiled=False)
    rays, beams = speeds(kernels, 1, 1)
    yield Row("plain: sonar, 1 robot", rays / 1e6, "M/s", None)
    yield Row("plain: 181 beams, 1 robot", beams / 1e6, "M/s", None)
    yield Row("plain: 181 beams in a scanned map", 1000 * scan_time(kernels), "ms", 50)
