"""Learning and evaluation: Gymnasium and PettingZoo environments over the simulated world.

============  ===================================================================================
module        contents
============  ===================================================================================
environments  the environments
rendering     pictures of robots in their map
simulation    the simulation that all environments share: robots on their way to goals, as arrays
maps          maps for many episodes at once
task          the task of an environment: the map, the sensors, the reward
============  ===================================================================================

Importing this package registers `pioneer3/Goal-v0`, for `gymnasium.make` and
`gymnasium.make_vec`. It needs the extra `gym`.
"""

from pioneer3.distribution import how_to_get

try:
    import gymnasium
    import pettingzoo  # noqa: F401
except ImportError as error:
    raise ImportError(f"{error}: {how_to_get('gym')}", name=error.name) from error

from pioneer3.gym.environments import GoalEnv, GoalParallelEnv, GoalVectorEnv
from pioneer3.gym.task import EPISODE, Reward, Task

__all__ = ["GoalEnv", "GoalParallelEnv", "GoalVectorEnv", "Reward", "Task"]

gymnasium.register(
    "pioneer3/Goal-v0",
    entry_point="pioneer3.gym:GoalEnv",
    vector_entry_point="pioneer3.gym:GoalVectorEnv",
    max_episode_steps=EPISODE,
)
