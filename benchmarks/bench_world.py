"""Real-time factors of whole worlds: wandering robots that see each other, at 10 Hz."""

import gc
import os
import time
import tracemalloc
from collections.abc import Callable, Iterator
from functools import cache
from importlib.util import find_spec
from math import pi
from statistics import median
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from benchmarks.bench_kernels import BEAMS, LASER_LIMIT, MODEL, office
from benchmarks.table import Row
from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap
from pioneer3.models import RobotModel
from pioneer3.sim.body import Body
from pioneer3.sim.dynamics import Dynamics
from pioneer3.sim.firmware import Firmware
from pioneer3.sim.kernels import Kernels, compiled_kernels, laser_fan
from pioneer3.sim.kernels.drives import STALLED
from pioneer3.sim.realism import Realism, SonarErrors
from pioneer3.sim.world import World

Float = NDArray[np.float64]
Flags = NDArray[np.uint8]
Control = Callable[[Float, Flags, Float, Float, Float], Any]

STEP = 0.1
COUNTS: tuple[int, ...] = (1, 10, 100, 1000)
FEW: tuple[int, ...] = (1, 10)
"""Robots that plain kernels are measured with."""
BARS: dict[tuple[str, bool], tuple[int, ...]] = {
    ("numba", False): (6000, 4000, 450, 40),
    ("numba", True): (5000, 1000, 100, 8),
    ("plain", False): (40, 4),
    ("plain", True): (10, 1),
}
"""Times real time with 16 sonars, then also with 181 beams; plain kernels are for few robots."""
IN_TURN, AT_ONCE = Realism(), Realism(sonar=SonarErrors(cycle=0.0))
NEAR, TOO_NEAR = 1.0, 0.5
"""Wandering robots slow down and turn where an echo is nearer, turn on the spot here [m]."""
CRUISE, SLOW, RATE = 0.4, 0.1, 1.0
ROOMY = 0.6
"""Nothing is nearer than this to a robot at the beginning, where there is room [m]."""
BACKING = 20
"""Steps of backing off after a collision."""


def wander(echoes: Float, stalled: Flags, backing: Float, speeds: Float, rates: Float) -> None:
    """Drive on, turn away from what is near, back off from what was hit."""
    for n in range(len(echoes)):
        left = right = 9.0
        for k in range(1, 4):
            left, right = min(left, echoes[n, k]), min(right, echoes[n, k + 3])
        nearest = min(left, right)
        speeds[n] = CRUISE if nearest > NEAR else (SLOW if nearest > TOO_NEAR else 0.0)
        rates[n] = (-RATE if left < right else RATE) if nearest < NEAR else 0.0
        backing[n] = BACKING if stalled[n] else max(backing[n] - 1, 0)
        if backing[n] > 0:
            speeds[n], rates[n] = -SLOW, RATE / 2 if backing[n] < BACKING / 2 else 0.0


def crowded(
    kernels: Kernels,
    count: int,
    copies: int,
    realism: Realism | None = None,
    seed: int = 1,
    *,
    model: RobotModel = MODEL,
    dynamics: Dynamics | None = None,
) -> World:
    """Return a world with so many robots at random free places of an office."""
    walls = office(copies)
    random = np.random.default_rng(seed)
    points = walls.reshape(-1, 2)
    low, high = points.min(axis=0), points.max(axis=0)
    world = World(
        LineMap(name="office", walls=walls),
        [Body(model) for _ in range(count)],
        kernels,
        realism=realism,
        dynamics=dynamics,
    )
    lost, room = np.ones(count, dtype=np.bool_), ROOMY
    world.outlines.theta[:] = random.uniform(-pi, pi, count)
    while lost.any():
        places = random.uniform(low, high, (int(lost.sum()), 2)).T
        for n, x, y in zip(np.flatnonzero(lost).tolist(), *places, strict=True):
            world.robots[n].robot_in_world = Pose2(x, y, float(world.outlines.theta[n]))
        lost &= world.sonars().min(axis=1) < room
        room *= 0.98  # a small office may not have so much for all
    for body in world.robots:
        body.enable_motors(on=True)
    return world


def factor(
    world: World,
    control: Control,
    *,
    laser: bool,
    seconds: float = 0.6,
    clock: Callable[[], float] = time.perf_counter,
) -> float:
    """Return how many times faster than real time, as `clock` has it, the robots wander."""
    fan = laser_fan((0.02, 0.0, 0.0), -pi / 2, pi / (BEAMS - 1), BEAMS)
    count = len(world.robots)
    speeds, rates, backing = np.zeros(count), np.zeros(count), np.zeros(count)
    stalled = world.drives.flags[STALLED]

    def turn() -> None:
        world.step(STEP)
        control(world.sonars(), stalled, backing, speeds, rates)
        world.drives.go(speeds, rates)
        if laser:
            world.lasers(fan, LASER_LIMIT)

    for _ in range(20):
        turn()
    factors = []
    for _ in range(7):
        steps, begin = 0, clock()
        while clock() - begin < seconds / 7:
            for _ in range(max(1, 200 // count)):
                turn()
                steps += 1
        factors.append(steps * STEP / (clock() - begin))
    return median(factors)


@cache
def compiled_wander() -> Control:
    """Return the loop over robots, compiled."""
    import numba  # type: ignore[import-not-found, import-untyped, unused-ignore]

    compile_: Any = numba.njit
    compiled: Control = compile_(wander)
    return compiled


def rows_of(name: Literal["numba", "plain"]) -> Iterator[Row]:
    """Measure the kernels compiled or plain."""
    kernels, counts = Kernels(compiled=False), FEW
    control: Control = wander
    if name == "numba":
        kernels, control = compiled_kernels(min(2, os.cpu_count() or 1)), compiled_wander()
        counts = COUNTS
    for laser in (False, True):
        for count, bar in zip(counts, BARS[name, laser], strict=True):
            world = crowded(kernels, count, 16 if count == 1000 else 1)
            what = "sonars and 181 beams" if laser else "16 sonars"
            measured = factor(world, control, laser=laser)
            yield Row(f"{name}: {count} robots, {what}", measured, "x", bar, True)
    for count in counts:
        copies = 16 if count == 1000 else 1
        plain = factor(crowded(kernels, count, copies), control, laser=False)
        real = factor(crowded(kernels, count, copies, IN_TURN), control, laser=False)
        yield Row(f"{name}: {count} robots, realism costs", plain / real, "times", 3)
        real = factor(crowded(kernels, count, copies, AT_ONCE), control, laser=False)
        yield Row(f"{name}: {count} robots, all sonars at once cost", plain / real, "times", None)
    if name == "plain":
        return
    few = factor(crowded(kernels, 10, 1), control, laser=True)
    many = factor(crowded(kernels, 1000, 100), control, laser=True)
    yield Row(f"{name}: a robot among 1000 as against 10", few / many / 100, "times", 1.5)


def kilobytes(count: int) -> float:
    """Return the memory of so many robots with their firmware, in a world of their own [KB]."""
    gc.collect()
    tracemalloc.start()
    bodies = [Body(MODEL, Pose2(3.0 * (n % 40), 3.0 * (n // 40))) for n in range(count)]
    world = World(None, bodies, realism=Realism())
    firmwares = [Firmware(world, body) for body in bodies]
    world.step(STEP)
    world.sonars()
    used = tracemalloc.get_traced_memory()[0] / 1024
    tracemalloc.stop()
    return used if firmwares else 0.0


def rows() -> Iterator[Row]:
    """Measure everything of this file."""
    kilobytes(10)
    each = (kilobytes(1000) - kilobytes(200)) / 800
    yield Row("memory of a robot with its firmware", each, "KB", 20)
    if find_spec("numba"):
        yield from rows_of("numba")
    yield from rows_of("plain")
