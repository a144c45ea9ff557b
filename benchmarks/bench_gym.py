"""Steps of environments per second: robots with 16 sonars, each alone in an office."""

import time
from collections.abc import Iterator
from importlib.util import find_spec
from typing import Literal

import numpy as np

from benchmarks.table import Row
from pioneer3.gym import GoalEnv, GoalVectorEnv

SECONDS = 1.0
"""Of each of the measurements, the best of which counts."""
ROUNDS = 3
BARS = {
    "numba": {1: 8_000, 16: 60_000, 256: 100_000, 1024: 100_000},
    "numpy": {1: 1_500, 16: 8_000, 256: 15_000, 1024: 15_000},
}
"""Steps per second."""


def single(kernels: Literal["numba", "numpy"]) -> float:
    """Return the steps per second of one robot that goes ahead, and begins anew when it must."""
    env = GoalEnv(kernels=kernels)
    env.reset(seed=0)
    ahead, best = np.array([0.5, 0.1], dtype=np.float32), 0.0
    for _ in range(ROUNDS):
        steps, begin = 0, time.perf_counter()
        while time.perf_counter() - begin < SECONDS:
            if env.step(ahead)[2]:
                env.reset()
            steps += 1
        best = max(best, steps / (time.perf_counter() - begin))
    return best


def together(kernels: Literal["numba", "numpy"], count: int) -> float:
    """Return the same of so many robots, which go where chance takes them."""
    env = GoalVectorEnv(count, kernels=kernels)
    env.reset(seed=0)
    rng, best = np.random.default_rng(1), 0.0
    actions = rng.uniform(-1, 1, (64, count, 2)).astype(np.float32)
    actions[..., 0] = abs(actions[..., 0])
    for _ in range(ROUNDS):
        steps, begin = 0, time.perf_counter()
        while time.perf_counter() - begin < SECONDS:
            env.step(actions[steps % 64])
            steps += 1
        best = max(best, steps * count / (time.perf_counter() - begin))
    return best


def rows() -> Iterator[Row]:
    """Measure both implementations."""
    names: tuple[Literal["numba", "numpy"], ...] = ("numba", "numpy")
    for name in names:
        if name == "numba" and not find_spec("numba"):
            continue
        for count, bar in BARS[name].items():
            measured = single(name) if count == 1 else together(name, count)
            yield Row(f"{name}: environment, {count} robots", measured, "/s", bar, True)
