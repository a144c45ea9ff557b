"""Thousands of robots, each alone with a goal in a copy of the map: a vector environment."""

from collections.abc import Sequence
from typing import Any, Unpack

import numpy as np
from gymnasium.error import ResetNeeded
from gymnasium.utils.seeding import np_random
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.random import Generator
from numpy.typing import NDArray

from pioneer3.errors import CommandError
from pioneer3.gym.arena import Arena, Outcome
from pioneer3.gym.picture import METADATA, Artist, Image, metadata_of
from pioneer3.gym.task import EPISODE, Options, Task

Float = NDArray[np.float64]
Float32 = NDArray[np.float32]
Bool = NDArray[np.bool_]
Info = dict[str, Any]
Seeds = int | Sequence[int | None] | None


class GoalVectorEnv(VectorEnv[Float32, Float32, Any]):
    """What so many `GoalEnv` do, all in one world.

    Without realism, robot n does to the last bit what a `GoalEnv` does that is seeded like it.

    Args:
        num_envs: Robots.
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
        **options: Unpack[Options],
    ) -> None:
        self.num_envs, self._longest = num_envs, max_episode_steps
        self._mode = AutoresetMode(autoreset_mode)
        self._arena = Arena(Task(**options), copies=num_envs)
        self.metadata = metadata_of(self._arena, render_mode) | {"autoreset_mode": self._mode}
        self.render_mode = render_mode
        self._artist = Artist(self._arena) if render_mode else None
        self.single_observation_space = self._arena.senses.observation_space()
        self.single_action_space = self._arena.senses.action_space()
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._rngs: list[Generator] = [np_random()[0] for _ in range(num_envs)]
        self._steps = np.zeros(num_envs, dtype=np.int64)
        self._over = np.ones(num_envs, dtype=np.bool_)

    def reset(self, *, seed: Seeds = None, options: Info | None = None) -> tuple[Float32, Info]:
        """Begin an episode with every robot, or with those of a mask.

        Args:
            seed: n seeds robot 0 with n, robot 1 with n + 1 and so on; a list has one for each.
            options: `reset_mask`, shape (num_envs,), says who begins; without it all do.
        """
        mask = (options or {}).get("reset_mask", np.ones(self.num_envs, dtype=np.bool_))
        seeds = _seeds(seed, self.num_envs)
        for n in np.flatnonzero(mask).tolist():
            if seeds[n] is not None:
                self._rngs[n], _ = np_random(seeds[n])
        if mask.all() and seeds[0] is not None and self._arena.noisy:
            self._arena.renew(seeds[0])
        self._begin(mask)
        return self._arena.observe(), self._info()

    def step(self, actions: Float32) -> tuple[Float32, Float, Bool, Bool, Info]:
        """Let every robot act for one step; see `autoreset_mode` for who has none left."""
        begins = self._over
        if self._mode is AutoresetMode.DISABLED and begins.any():
            raise ResetNeeded("an episode is over; call reset(options={'reset_mask': ...})")
        self._begin(begins)
        outcome = self._arena.step(actions, ~begins)
        self._steps += ~begins
        terminated, truncated = outcome.arrived | outcome.collided, self._steps >= self._longest
        self._over = terminated | truncated
        seen, info = self._arena.observe(), self._info(outcome)
        if self._mode is AutoresetMode.SAME_STEP and self._over.any():
            seen, info = self._go_on(seen, info)
        return seen, outcome.reward, terminated, truncated, info

    def render(self) -> tuple[Image, ...] | None:
        """Return a picture of each robot in its map, (H, W, 3), or `None` without a render mode."""
        return tuple(map(self._artist.draw, range(self.num_envs))) if self._artist else None

    def _begin(self, who: Bool) -> None:
        for n in np.flatnonzero(who).tolist():
            self._arena.begin(n, self._rngs[n])
        self._steps[who] = 0
        self._over = self._over & ~who

    def _go_on(self, seen: Float32, info: Info) -> tuple[Float32, Info]:
        """Return the first observations of the episodes that follow, and the last of those over."""
        over = self._over
        last = np.full(self.num_envs, None, dtype=np.object_)
        for n in np.flatnonzero(over).tolist():
            last[n] = seen[n]
        final = {key: over.copy() if key.startswith("_") else info[key] for key in info}
        self._begin(over)
        ends = {"final_obs": last, "_final_obs": over, "final_info": final, "_final_info": over}
        return self._arena.observe(), self._info() | ends

    def _info(self, outcome: Outcome | None = None) -> Info:
        """Return the information of all robots; of each key `_key` says who has it: everybody."""
        info: Info = {**self._arena.facts(outcome)}
        return info | {f"_{key}": np.ones(self.num_envs, dtype=np.bool_) for key in info}


def _seeds(seed: Seeds, count: int) -> Sequence[int | None]:
    if seed is None:
        return [None] * count
    seeds = [seed + n for n in range(count)] if isinstance(seed, int) else seed
    if len(seeds) != count:
        raise CommandError(f"seeds: {len(seeds)}, but there are {count} robots")
    return seeds
