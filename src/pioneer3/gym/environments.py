"""The environments: one robot, many robots apart from each other, several robots in one map."""

from collections.abc import Iterable, Sequence
from typing import Any, TypeVar, Unpack

import gymnasium
import numpy as np
from gymnasium.error import ResetNeeded
from gymnasium.spaces import Space
from gymnasium.utils.seeding import np_random
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.random import Generator
from pettingzoo import ParallelEnv

from pioneer3.arrays import Bool, Float, Float32
from pioneer3.errors import CommandError
from pioneer3.gym.rendering import METADATA, EnvironmentRenderer, Image, metadata_of
from pioneer3.gym.simulation import GoalSimulation, Infos, StepResult, info_of
from pioneer3.gym.task import EPISODE, Task, TaskOptions

Info = dict[str, Any]
Seeds = int | Sequence[int | None] | None
T = TypeVar("T")


class GoalEnv(gymnasium.Env[Float32, Float32]):
    """One robot. An episode ends at the goal or at the first collision.

    `gymnasium.make("pioneer3/Goal-v0")` makes it with a limit of 500 steps.

    Args:
        render_mode: `rgb_array` or `None`.
        options: The fields of :class:`Task`.

    Raises:
        ConfigError: The task cannot be done.
    """

    metadata = METADATA

    def __init__(self, *, render_mode: str | None = None, **options: Unpack[TaskOptions]) -> None:
        self._simulation = GoalSimulation(Task(**options))
        self.metadata = metadata_of(self._simulation, render_mode)
        self.render_mode = render_mode
        self._renderer = EnvironmentRenderer(self._simulation) if render_mode else None
        self.observation_space = self._simulation.observations.observation_space()
        self.action_space = self._simulation.observations.action_space()

    def reset(
        self, *, seed: int | None = None, options: Info | None = None
    ) -> tuple[Float32, Info]:
        """Begin an episode at a random position, which the seed decides if there is one."""
        super().reset(seed=seed)
        if seed is not None and self._simulation.noisy:
            self._simulation.rebuild(seed)
        self._simulation.reset(0, self.np_random)
        return self._simulation.observe()[0], info_of(self._simulation.infos(), 0)

    def step(self, action: Float32) -> tuple[Float32, float, bool, bool, Info]:
        """Let the robot act for one step."""
        result = self._simulation.step(np.asarray(action)[None], np.ones(1, dtype=np.bool_))
        info = info_of(self._simulation.infos(result), 0)
        terminated = info["is_success"] or info["collision"]
        return self._simulation.observe()[0], float(result.reward[0]), terminated, False, info

    def render(self) -> Image | None:
        """Return a picture, shape (H, W, 3), or `None` without a render mode."""
        return self._renderer.render() if self._renderer else None


class GoalVectorEnv(VectorEnv[Float32, Float32, Any]):
    """As many `GoalEnv` in one world, each with a copy of the map.

    Without realism, robot n gives the same numbers to the last bit as a `GoalEnv` with its seed.

    Args:
        num_envs: Number of robots.
        max_episode_steps: After so many an episode is truncated.
        autoreset_mode: What follows the end of an episode: a step that only resets (`NEXT_STEP`),
            the first observation of the next one together with the last reward (`SAME_STEP`), or
            an error until :meth:`reset` with `options={"reset_mask": ...}` (`DISABLED`).
        render_mode: `rgb_array` or `None`.
        options: The fields of :class:`Task`.

    Raises:
        ConfigError: The task cannot be done.
    """

    metadata = METADATA

    def __init__(
        self,
        num_envs: int = 1,
        *,
        max_episode_steps: int = EPISODE,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        render_mode: str | None = None,
        **options: Unpack[TaskOptions],
    ) -> None:
        self.num_envs, self._longest = num_envs, max_episode_steps
        self._mode = AutoresetMode(autoreset_mode)
        self._simulation = GoalSimulation(Task(**options), copies=num_envs)
        self.metadata = metadata_of(self._simulation, render_mode) | {"autoreset_mode": self._mode}
        self.render_mode = render_mode
        self._renderer = EnvironmentRenderer(self._simulation) if render_mode else None
        self.single_observation_space = self._simulation.observations.observation_space()
        self.single_action_space = self._simulation.observations.action_space()
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._rngs: list[Generator] = [np_random()[0] for _ in range(num_envs)]
        self._steps = np.zeros(num_envs, dtype=np.int64)
        self._done = np.ones(num_envs, dtype=np.bool_)

    def reset(self, *, seed: Seeds = None, options: Info | None = None) -> tuple[Float32, Info]:
        """Begin an episode with every robot, or with those of `options["reset_mask"]` (num_envs,).

        Seed n seeds robot 0 with n, robot 1 with n + 1 and so on; a list has one for each.
        """
        mask = (options or {}).get("reset_mask", np.ones(self.num_envs, dtype=np.bool_))
        seeds = _seeds(seed, self.num_envs)
        for n in np.flatnonzero(mask).tolist():
            if seeds[n] is not None:
                self._rngs[n], _ = np_random(seeds[n])
        if mask.all() and seeds[0] is not None and self._simulation.noisy:
            self._simulation.rebuild(seeds[0])
        self._begin(mask)
        return self._simulation.observe(), self._info()

    def step(self, actions: Float32) -> tuple[Float32, Float, Bool, Bool, Info]:
        """Let every robot act for one step; see `autoreset_mode` for those whose episode ended."""
        new = self._done
        if self._mode is AutoresetMode.DISABLED and new.any():
            raise ResetNeeded("an episode is over; call reset(options={'reset_mask': ...})")
        self._begin(new)
        result = self._simulation.step(actions, ~new)
        self._steps = self._steps + ~new
        terminated, truncated = result.arrived | result.collided, self._steps >= self._longest
        self._done = terminated | truncated
        observation, info = self._simulation.observe(), self._info(result)
        if self._mode is AutoresetMode.SAME_STEP and self._done.any():
            observation, info = self._go_on(observation, info)
        return observation, result.reward, terminated, truncated, info

    def render(self) -> tuple[Image, ...] | None:
        """Return a picture of each robot in its map, (H, W, 3), or `None` without a render mode."""
        return tuple(map(self._renderer.render, range(self.num_envs))) if self._renderer else None

    def _begin(self, who: Bool) -> None:
        for n in np.flatnonzero(who).tolist():
            self._simulation.reset(n, self._rngs[n])
        self._steps = np.where(who, 0, self._steps)
        self._done = self._done & ~who

    def _go_on(self, observation: Float32, info: Info) -> tuple[Float32, Info]:
        """Return the first observations of the next episodes; the info has the last ones."""
        done = self._done
        last = np.full(self.num_envs, None, dtype=np.object_)
        for n in np.flatnonzero(done).tolist():
            last[n] = observation[n]
        final = {key: done.copy() if key.startswith("_") else info[key] for key in info}
        self._begin(done)
        ends = {"final_obs": last, "_final_obs": done, "final_info": final, "_final_info": done}
        return self._simulation.observe(), self._info() | ends

    def _info(self, result: StepResult | None = None) -> Info:
        """Return the information of all robots; `_key` says which robots have `key`: all."""
        info: Info = {**self._simulation.infos(result)}
        return info | {f"_{key}": np.ones(self.num_envs, dtype=np.bool_) for key in info}


class GoalParallelEnv(ParallelEnv[str, Float32, Float32]):
    """Robots that see each other, are in each other's way, and have a goal each.

    A robot that arrives or collides is removed from the map; the others go on. If two robots meet,
    the one that drives has collided with the other; if both drive, perhaps only one has.

    Args:
        robots: Number of robots; they are called `robot_0` and so on.
        max_episode_steps: After so many the episode is truncated for all.
        render_mode: `rgb_array` or `None`.
        options: The fields of :class:`Task`.

    Raises:
        ConfigError: The task cannot be done.
    """

    metadata = METADATA

    def __init__(
        self,
        robots: int = 4,
        *,
        max_episode_steps: int = EPISODE,
        render_mode: str | None = None,
        **options: Unpack[TaskOptions],
    ) -> None:
        self._simulation = GoalSimulation(Task(**options), robots=robots)
        self.metadata = metadata_of(self._simulation, render_mode) | {"name": "pioneer3_goal_v0"}
        self.render_mode, self._longest = render_mode, max_episode_steps
        self._renderer = EnvironmentRenderer(self._simulation) if render_mode else None
        self.possible_agents = [f"robot_{n}" for n in range(robots)]
        self.agents: list[str] = []
        observations, names = self._simulation.observations, self.possible_agents
        self.observation_spaces = {name: observations.observation_space() for name in names}
        self.action_spaces = {name: observations.action_space() for name in names}
        self._rng, _ = np_random()
        self._steps = 0

    def observation_space(self, agent: str) -> Space[Float32]:
        """Return the space of observations of `agent`."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> Space[Float32]:
        """Return the space of actions of `agent`."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: Info | None = None
    ) -> tuple[dict[str, Float32], dict[str, Info]]:
        """Begin an episode with all robots at random positions, which a seed decides."""
        if seed is not None:
            self._rng, _ = np_random(seed)
            if self._simulation.noisy:
                self._simulation.rebuild(seed)
        self._simulation.reset(0, self._rng)
        self.agents, self._steps = self.possible_agents[:], 0
        return self._by_name(self._simulation.observe()), self._infos(self._simulation.infos())

    def step(
        self, actions: dict[str, Float32]
    ) -> tuple[
        dict[str, Float32], dict[str, float], dict[str, bool], dict[str, bool], dict[str, Info]
    ]:
        """Let every remaining robot act for one step.

        Raises:
            CommandError: One of them has no action, or one that is not finite.
        """
        missing = [name for name in self.agents if name not in actions]
        if missing:
            raise CommandError(f"actions: there is none for {', '.join(missing)}")
        nothing = np.zeros(2)
        wanted = [actions.get(name, nothing) for name in self.possible_agents]
        active = np.array([name in self.agents for name in self.possible_agents])
        result = self._simulation.step(np.array(wanted, dtype=np.float64), active)
        self._steps += 1
        done, truncated = result.arrived | result.collided, self._steps >= self._longest
        results = (
            self._by_name(self._simulation.observe()),
            self._by_name(result.reward.tolist()),
            self._by_name(done.tolist()),
            dict.fromkeys(self.agents, truncated),
            self._infos(self._simulation.infos(result)),
        )
        self._simulation.remove(np.flatnonzero(done))
        self.agents = [] if truncated else [name for name in self.agents if not results[2][name]]
        return results

    def render(self) -> Image | None:
        """Return a picture, shape (H, W, 3), or `None` without a render mode."""
        return self._renderer.render() if self._renderer else None

    def _by_name(self, values: Iterable[T]) -> dict[str, T]:
        """Return the values of the remaining robots by name."""
        named = zip(self.possible_agents, values, strict=True)
        return {name: value for name, value in named if name in self.agents}

    def _infos(self, infos: Infos) -> dict[str, Info]:
        return self._by_name(info_of(infos, n) for n in range(len(self.possible_agents)))


def _seeds(seed: Seeds, count: int) -> Sequence[int | None]:
    if seed is None:
        return [None] * count
    seeds = [seed + n for n in range(count)] if isinstance(seed, int) else seed
    if len(seeds) != count:
        raise CommandError(f"seeds: {len(seeds)}, but there are {count} robots")
    return seeds
