"""Steps of environments per second: robots with 16 sonars, each alone in an office."""

import time
from collections.abc import Iterator
from importlib.util import find_spec

import numpy as np

from benchmarks.table import Row
from pioneer3.gym import GoalEnv, GoalVectorEnv

SECONDS = 1.0
"""Of each of the measurements, the best of which counts."""
ROUNDS = 3
BARS = {1: 8_000, 16: 60_000, 256: 100_000, 1024: 100_000}
"""Steps per second with numba; without it one robot is measured, without a bar."""


def single() -> float:
    """Return the steps per second of one robot that goes ahead, and begins anew when it must."""
    env = GoalEnv()
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


def together(count: int) -> float:
    """Return the same of so many robots, which go where chance takes them."""
    env = GoalVectorEnv(count)
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
    """Measure everything of this file."""
    if not find_spec("numba"):
        yield Row("plain: environment, 1 robot", single(), "/s", None, True)
        return
    for count, bar in BARS.items():
        measured = single() if count == 1 else together(count)
        yield Row(f"numba: environment, {count} robots", measured, "/s", bar, True)
