"""One robot, one goal: a Gymnasium environment."""

from typing import Any, Unpack

import gymnasium
import numpy as np
from numpy.typing import NDArray

from pioneer3.gym.arena import Arena, row
from pioneer3.gym.picture import METADATA, Artist, Image, metadata_of
from pioneer3.gym.task import Options, Task

Float32 = NDArray[np.float32]
Info = dict[str, Any]


class GoalEnv(gymnasium.Env[Float32, Float32]):
    """A robot that is to drive to a goal; ends there, or at the first thing it runs into.

    `gymnasium.make("pioneer3/Goal-v0")` makes it with a limit of 500 steps.

    Args:
        render_mode: `rgb_array` or `None`.
        options: The fields of :class:`Task`.

    Raises:
        ConfigError: The task cannot be done.
    """

    metadata = METADATA

    def __init__(self, *, render_mode: str | None = None, **options: Unpack[Options]) -> None:
        self._arena = Arena(Task(**options))
        self.metadata = metadata_of(self._arena, render_mode)
        self.render_mode = render_mode
        self._artist = Artist(self._arena) if render_mode else None
        self.observation_space = self._arena.senses.observation_space()
        self.action_space = self._arena.senses.action_space()

    def reset(
        self, *, seed: int | None = None, options: Info | None = None
    ) -> tuple[Float32, Info]:
        """Begin an episode at a place that the seed, or chance, decides."""
        super().reset(seed=seed)
        if seed is not None and self._arena.noisy:
            self._arena.renew(seed)
        self._arena.begin(0, self.np_random)
        return self._arena.observe()[0], row(self._arena.facts(), 0)

    def step(self, action: Float32) -> tuple[Float32, float, bool, bool, Info]:
        """Let the robot act for one step."""
        outcome = self._arena.step(np.asarray(action)[None], np.ones(1, dtype=np.bool_))
        seen, info = self._arena.observe()[0], row(self._arena.facts(outcome), 0)
        ends = info["is_success"] or info["collision"]
        return seen, float(outcome.reward[0]), ends, False, info

    def render(self) -> Image | None:
        """Return a picture, shape (H, W, 3), or `None` without a render mode."""
        return self._artist.draw() if self._artist else None
