"""Teach robots to find goals: of 512 ways to drive keep the best, vary them, try again."""

import numpy as np

from pioneer3.gym import GoalVectorEnv

ROBOTS, BEST, STEPS, ROUNDS = 512, 25, 120, 10
USED = [*range(8), *range(16, 21)]  # the sonars in front, the way to the goal, the own motion

env = GoalVectorEnv(ROBOTS, goal_distance=(1.0, 3.0))
rng = np.random.default_rng(0)
mean, spread = np.zeros((2, len(USED) + 1)), np.ones((2, len(USED) + 1))

for number in range(ROUNDS):
    weights = mean + spread * rng.standard_normal((ROBOTS, *mean.shape))
    seen = env.reset(seed=1000 * number)[0]
    total, driving, arrived = np.zeros(ROBOTS), np.ones(ROBOTS, dtype=bool), 0
    for _ in range(STEPS):
        inputs = np.column_stack([seen[:, USED], np.ones(ROBOTS)])
        actions = np.tanh(np.einsum("nai,ni->na", weights, inputs))
        seen, reward, over, late, info = env.step(actions)
        total += reward * driving
        arrived += int((info["is_success"] & driving).sum())
        driving &= ~(over | late)
    best = weights[np.argsort(total)[-BEST:]]
    mean, spread = best.mean(axis=0), best.std(axis=0) + 0.1
    print(f"round {number + 1}: {arrived} of {ROBOTS} arrived, mean reward {total.mean():.2f}")
