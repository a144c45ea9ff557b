"""A copy of an environment goes on as the original does, wherever and however it was made."""

import pickle
from collections.abc import Callable
from copy import deepcopy
from importlib.util import find_spec
from multiprocessing import get_context
from typing import Any

import cloudpickle  # type: ignore[import-untyped]
import gymnasium
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.random import Generator, default_rng

from pioneer3.gym import GoalEnv, GoalParallelEnv, GoalVectorEnv
from pioneer3.sim.realism import Realism
from pioneer3.sim.worldfile.spec import Physics
from tests.combinations import examples
from tests.unit.gym.rooms import PILLARED

STEPS = 100
LONGEST = 40
"""Steps of an episode: several begin and end after a copy is made."""
ROBOTS = 3


def lent(env: Any) -> Any:
    """Copy as Ray does: its arrays are in memory that processes share, and cannot be written to."""
    buffers: list[pickle.PickleBuffer] = []
    rest = cloudpickle.dumps(env, protocol=5, buffer_callback=buffers.append)
    return cloudpickle.loads(rest, buffers=[bytes(each.raw()) for each in buffers])


MADE: dict[str, Callable[..., Any]] = {
    "alone": lambda **options: gymnasium.make(
        "pioneer3/Goal-v0", max_episode_steps=LONGEST, **options
    ),
    "NextStep": lambda **options: vector("NextStep", **options),
    "SameStep": lambda **options: vector("SameStep", **options),
    "together": lambda **options: GoalParallelEnv(ROBOTS, max_episode_steps=LONGEST, **options),
}
COPIED: dict[str, Callable[[Any], Any]] = {
    "pickle": lambda env: pickle.loads(pickle.dumps(env)),
    "deepcopy": deepcopy,
    "cloudpickle": lambda env: cloudpickle.loads(cloudpickle.dumps(env)),
    "lent": lent,
}


def vector(mode: str, **options: Any) -> GoalVectorEnv:
    return GoalVectorEnv(ROBOTS, max_episode_steps=LONGEST, autoreset_mode=mode, **options)


def step(env: Any, rng: Generator) -> Any:
    """Take a random action of each robot; begin another episode where one is over."""
    if isinstance(env, GoalParallelEnv):
        said = env.step({name: rng.uniform(-1, 1, 2).astype(np.float32) for name in env.agents})
        return said if env.agents else (said, env.reset())
    said = env.step(rng.uniform(-1, 1, env.action_space.shape))
    if isinstance(env, GoalVectorEnv):
        return said
    return (said, env.reset()) if said[2] or said[3] else said


def played(env: Any, seed: int, steps: int) -> list[Any]:
    """Return all that an environment says, to the last bit."""
    rng = default_rng(seed)
    return [bits(step(env, rng)) for _ in range(steps)]


def bits(said: Any) -> Any:
    if isinstance(said, dict):
        return {key: bits(value) for key, value in said.items()}
    if said is None or isinstance(said, str):
        return said
    if isinstance(said, tuple) or np.asarray(said).dtype == np.object_:
        return [bits(value) for value in said]
    return np.asarray(said).tobytes()


@pytest.mark.parametrize(
    ("physics", "number"), [("planar", 60), pytest.param("mujoco", 12, marks=pytest.mark.thorough)]
)
def test_a_copy_goes_on_as_its_original_and_neither_changes_the_other(
    physics: Physics, number: int
) -> None:
    if physics == "mujoco":
        pytest.importorskip("mujoco")

    @settings(max_examples=examples(number))
    @given(
        kind=st.sampled_from(sorted(MADE)),
        way=st.sampled_from(sorted(COPIED)),
        sensors=st.sampled_from(["sonar", "laser", "both"]),
        realism=st.sampled_from([None, Realism()]),
        seed=st.integers(0, 1 << 16),
        before=st.integers(0, 2 * LONGEST),
    )
    def check(
        *, kind: str, way: str, sensors: str, realism: Realism | None, seed: int, before: int
    ) -> None:
        env = MADE[kind](
            map=PILLARED,
            physics=physics,
            sensors=sensors,
            beams=19,
            realism=realism,
            goal_distance=(0.5, 1.5),
        )
        env.reset(seed=seed)
        played(env, seed, before)
        copy = COPIED[way](env)
        assert played(copy, seed + 1, STEPS) == played(env, seed + 1, STEPS)
        assert bits(copy.reset(seed=seed)) == bits(env.reset(seed=seed))

    check()


@pytest.fixture
def driven() -> GoalEnv:
    """An environment in the middle of an episode."""
    env = GoalEnv(map=PILLARED, realism=Realism())
    env.reset(seed=1)
    played(env, 1, 10)
    return env


def test_a_copy_goes_on_in_another_process(driven: GoalEnv) -> None:
    with get_context("spawn").Pool(1) as pool:
        there = pool.apply(played, (driven, 2, STEPS))
    assert there == played(driven, 2, STEPS)


@pytest.mark.thorough
@pytest.mark.skipif(find_spec("ray") is None, reason="no ray here: python -m pip install ray")
def test_a_copy_goes_on_in_an_actor_of_ray(
    driven: GoalEnv, monkeypatch: pytest.MonkeyPatch
) -> None:
    import ray

    class Actor:
        def __init__(self, env: GoalEnv) -> None:
            self.env = env

        def go_on(self) -> list[Any]:
            return played(self.env, 2, STEPS)

    monkeypatch.setenv("RAY_USAGE_STATS_ENABLED", "0")
    monkeypatch.delenv("RAY_ADDRESS", raising=False)
    ray.init(num_cpus=1, include_dashboard=False)
    try:
        there = ray.get(ray.remote(Actor).remote(driven).go_on.remote())
    finally:
        ray.shutdown()
    assert there == played(driven, 2, STEPS)
