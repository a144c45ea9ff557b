"""Sweep parameters over all cores: how sharply and how fast to turn towards a goal."""

from itertools import product
from multiprocessing import get_context

import numpy as np

from pioneer3.gym import GoalVectorEnv

ROBOTS, STEPS = 20, 200
GAINS, SPEEDS = (0.3, 1.0, 3.0), (0.3, 0.6, 1.0)


def arrivals(task: tuple[int, tuple[float, float]]) -> tuple[float, float, int]:
    """Return gain, speed and the robots that arrive; the number of the task seeds it."""
    number, (gain, speed) = task
    env = GoalVectorEnv(ROBOTS, goal_distance=(1.0, 3.0))
    seen, driving, arrived = env.reset(seed=1000 * number)[0], np.ones(ROBOTS, bool), 0
    for _ in range(STEPS):
        ahead, aside = seen[:, -4], seen[:, -3]  # cosine and sine of the goal's bearing
        actions = np.column_stack([speed * ahead.clip(0.0), gain * np.arctan2(aside, ahead)])
        seen, _, over, late, info = env.step(actions.astype(np.float32))
        arrived += int((info["is_success"] & driving).sum())
        driving &= ~(over | late)
    return gain, speed, arrived


if __name__ == "__main__":
    GoalVectorEnv(1)  # compiles, if nobody has on this machine: the processes then load
    tasks = enumerate(product(GAINS, SPEEDS))
    with get_context("spawn").Pool() as pool:
        found = sorted(pool.imap_unordered(arrivals, tasks))
    for gain, speed, arrived in found:
        print(f"gain {gain:g}, speed {speed:g}: {arrived} of {ROBOTS} arrived")
