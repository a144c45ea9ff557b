"""Learn with Ray: two workers here, or with RAY_ADDRESS=auto on machines of your cluster."""

import os

import numpy as np
import ray

from pioneer3.gym import GoalVectorEnv

WORKERS, ROBOTS, BEST, STEPS, ROUNDS = 2, 256, 25, 120, 10


class Worker:
    """Drives robots, each in its own way, in a process on one of the machines."""

    def __init__(self) -> None:
        self.env = GoalVectorEnv(ROBOTS, goal_distance=(1.0, 3.0))

    def drive(self, ways: np.ndarray, seed: int) -> np.ndarray:
        """Return the sum of rewards of each way."""
        seen, total, driving = self.env.reset(seed=seed)[0], np.zeros(ROBOTS), np.ones(ROBOTS, bool)
        for _ in range(STEPS):
            speeds = np.tanh(np.einsum("nai,ni->na", ways, seen))
            seen, reward, over, late, _ = self.env.step(speeds)
            total, driving = total + reward * driving, driving & ~(over | late)
        return total


ray.init(num_cpus=None if "RAY_ADDRESS" in os.environ else WORKERS)
workers = [ray.remote(num_cpus=1)(Worker).remote() for _ in range(WORKERS)]
mean, spread, rng = np.zeros((2, 21)), np.ones((2, 21)), np.random.default_rng(0)
for number in range(ROUNDS):
    ways = mean + spread * rng.standard_normal((WORKERS, ROBOTS, *mean.shape))
    shares = [workers[i].drive.remote(ways[i], 1000 * number + i) for i in range(WORKERS)]
    total = np.concatenate(ray.get(shares))
    best = np.concatenate(ways)[np.argsort(total)[-BEST:]]
    mean, spread = best.mean(axis=0), best.std(axis=0) + 0.1
    print(f"round {number + 1}: mean reward {total.mean():.2f} of {len(total)} ways")
