"""Several robots in one map, each with a goal of its own: a PettingZoo environment."""

from collections.abc import Iterable
from typing import Any, TypeVar, Unpack

import numpy as np
from gymnasium.spaces import Space
from gymnasium.utils.seeding import np_random
from numpy.typing import NDArray
from pettingzoo import ParallelEnv

from pioneer3.errors import CommandError
from pioneer3.gym.arena import Arena, Facts, row
from pioneer3.gym.picture import METADATA, Artist, Image, metadata_of
from pioneer3.gym.task import EPISODE, Options, Task

Float32 = NDArray[np.float32]
Info = dict[str, Any]
T = TypeVar("T")


class GoalParallelEnv(ParallelEnv[str, Float32, Float32]):
    """Robots that see each other, are in each other's way, and have a goal each.

    Who arrives or runs into something leaves the map; the others go on. Of two robots that meet
    the one that drives has run into the other; if both drive, perhaps only one has.

    Args:
        robots: How many; they are called `robot_0` and so on.
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
        **options: Unpack[Options],
    ) -> None:
        self._arena = Arena(Task(**options), robots=robots)
        self.metadata = metadata_of(self._arena, render_mode) | {"name": "pioneer3_goal_v0"}
        self.render_mode, self._longest = render_mode, max_episode_steps
        self._artist = Artist(self._arena) if render_mode else None
        self.possible_agents = [f"robot_{n}" for n in range(robots)]
        self.agents: list[str] = []
        senses, names = self._arena.senses, self.possible_agents
        self.observation_spaces = {name: senses.observation_space() for name in names}
        self.action_spaces = {name: senses.action_space() for name in names}
        self._rng, _ = np_random()
        self._steps = 0

    def observation_space(self, agent: str) -> Space[Float32]:
        """Return what `agent` can observe."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> Space[Float32]:
        """Return what `agent` can do."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: Info | None = None
    ) -> tuple[dict[str, Float32], dict[str, Info]]:
        """Begin an episode with all robots, at places that the seed, or chance, decides."""
        if seed is not None:
            self._rng, _ = np_random(seed)
            if self._arena.noisy:
                self._arena.renew(seed)
        self._arena.begin(0, self._rng)
        self.agents, self._steps = self.possible_agents[:], 0
        return self._by_name(self._arena.observe()), self._infos(self._arena.facts())

    def step(
        self, actions: dict[str, Float32]
    ) -> tuple[
        dict[str, Float32], dict[str, float], dict[str, bool], dict[str, bool], dict[str, Info]
    ]:
        """Let every robot that is left act for one step.

        Raises:
            CommandError: One of them has no action, or one that is not finite.
        """
        missing = [name for name in self.agents if name not in actions]
        if missing:
            raise CommandError(f"actions: there is none for {', '.join(missing)}")
        nothing = np.zeros(2)
        wanted = [actions.get(name, nothing) for name in self.possible_agents]
        live = np.array([name in self.agents for name in self.possible_agents])
        outcome = self._arena.step(np.array(wanted, dtype=np.float64), live)
        self._steps += 1
        over, late = outcome.arrived | outcome.collided, self._steps >= self._longest
        results = (
            self._by_name(self._arena.observe()),
            self._by_name(outcome.reward.tolist()),
            self._by_name(over.tolist()),
            dict.fromkeys(self.agents, late),
            self._infos(self._arena.facts(outcome)),
        )
        self._arena.leave(np.flatnonzero(over))
        self.agents = [] if late else [name for name in self.agents if not results[2][name]]
        return results

    def render(self) -> Image | None:
        """Return a picture, shape (H, W, 3), or `None` without a render mode."""
        return self._artist.draw() if self._artist else None

    def _by_name(self, values: Iterable[T]) -> dict[str, T]:
        """Return the values of those who are left."""
        named = zip(self.possible_agents, values, strict=True)
        return {name: value for name, value in named if name in self.agents}

    def _infos(self, facts: Facts) -> dict[str, Info]:
        return self._by_name(row(facts, n) for n in range(len(self.possible_agents)))
