"""Many robots at once do exactly what each of them does alone."""

from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.error import ResetNeeded
from gymnasium.vector import AutoresetMode, SyncVectorEnv

from pioneer3.errors import CommandError, ConfigError
from pioneer3.gym import GoalEnv, GoalVectorEnv
from pioneer3.gym.task import Sensors
from pioneer3.sim.realism import Realism
from tests.support import STAYED
from tests.unit.gym.rooms import PILLARED, ROOM, towards

STEPS = 60
NEAR = (0.5, 1.5)
"""Goals that can be reached in so many steps [m]."""


def both(
    count: int, mode: AutoresetMode = AutoresetMode.NEXT_STEP, **options: Any
) -> tuple[GoalVectorEnv, SyncVectorEnv]:
    """Return robots in one world, and as many worlds with a robot each."""

    def one() -> gymnasium.Env[Any, Any]:
        return gymnasium.make("pioneer3/Goal-v0", max_episode_steps=STEPS, **options)

    together = GoalVectorEnv(count, max_episode_steps=STEPS, autoreset_mode=mode, **options)
    return together, SyncVectorEnv([one] * count, autoreset_mode=mode)


def assert_same(one: Any, other: Any) -> None:
    """Fail unless both are the same to the last bit, types included."""
    if isinstance(one, dict):
        assert one.keys() == other.keys()
        for key in one:
            assert_same(one[key], other[key])
    elif one.dtype == np.object_:
        for a, b in zip(one, other, strict=True):
            assert (a is None) == (b is None)
            if a is not None:
                assert_same(a, b)
    else:
        assert one.dtype == other.dtype
        np.testing.assert_array_equal(one, other)


def told(info: dict[str, Any]) -> dict[str, Any]:
    """Return what is said of those whom it concerns."""
    kept: dict[str, Any] = {}
    for key, value in info.items():
        if isinstance(value, dict):
            kept[key] = told(value)
        elif not key.startswith("_") and value.dtype != np.object_:
            mask = info[f"_{key}"].reshape(-1, *[1] * (value.ndim - 1))
            kept[key] = np.where(mask, value, 0)
        else:
            kept[key] = value
    return kept


@pytest.mark.planar("to the last bit; MuJoCo solves the contacts of one world together")
@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
@pytest.mark.parametrize("sensors", ["sonar", "laser"])
def test_robots_in_one_world_are_exactly_robots_in_worlds_of_their_own(
    mode: AutoresetMode, sensors: Sensors
) -> None:
    options = {"sensors": sensors, "beams": 19, "goal_distance": NEAR}
    together, apart = both(7, mode, map=PILLARED, **options)
    one, other = together.reset(seed=11), apart.reset(seed=11)
    assert_same(one[0], other[0])
    assert_same(one[1], other[1])
    together.action_space.seed(1)
    ends, info = np.zeros(3, dtype=np.int64), one[1]
    for _ in range(3 * STEPS):
        actions = together.action_space.sample()
        actions[:, 0] = abs(actions[:, 0])
        actions[:3] = [towards({key: info[key][n] for key in ("pose", "goal")}) for n in range(3)]
        stepped, expected = together.step(actions), apart.step(actions)
        for a, b in zip(stepped[:4], expected[:4], strict=True):
            assert_same(a, b)
        info = stepped[4]
        assert_same(told(info), told(expected[4]))
        last = info.get("final_info", info)
        ends += last["is_success"].sum(), last["collision"].sum(), stepped[3].sum()
    assert ends.all(), "the run has to come across arrivals, collisions and truncations"


def test_robots_far_off_in_a_large_world_are_no_less_exact() -> None:
    many, alone = GoalVectorEnv(300, map=PILLARED), GoalEnv(map=PILLARED)
    many.reset(seed=[None] * 299 + [5])
    alone.reset(seed=5)
    many.action_space.seed(2)
    for _ in range(30):
        actions = many.action_space.sample()
        one, other = many.step(actions), alone.step(actions[-1])
        assert_same(one[0][-1], other[0])
        assert one[1][-1] == other[1]
        assert one[2][-1] == other[2]
        if other[2]:
            break


def test_processes_of_gymnasium_say_the_same() -> None:
    together = GoalVectorEnv(2, map=PILLARED)
    apart = gymnasium.make_vec(
        "pioneer3/Goal-v0",
        num_envs=2,
        vectorization_mode="async",
        vector_kwargs={"context": "spawn"},
        map=PILLARED,
    )
    assert_same(together.reset(seed=3)[0], apart.reset(seed=3)[0])
    together.action_space.seed(3)
    for _ in range(20):
        actions = together.action_space.sample()
        for one, other in zip(together.step(actions)[:4], apart.step(actions)[:4], strict=True):
            assert_same(one, other)
    apart.close()


def test_make_vec_makes_it() -> None:
    env = gymnasium.make_vec("pioneer3/Goal-v0", num_envs=3, map=ROOM)
    assert isinstance(env.unwrapped, GoalVectorEnv)
    assert env.metadata["autoreset_mode"] is AutoresetMode.NEXT_STEP
    assert env.observation_space.shape == (3, 21)
    assert env.action_space.shape == (3, 2)
    seen, _ = env.reset(seed=0)
    assert seen in env.observation_space
    assert env.step(env.action_space.sample())[0] in env.observation_space


def test_a_disabled_autoreset_waits_for_a_reset_of_those_who_are_done() -> None:
    env = GoalVectorEnv(3, map=ROOM, max_episode_steps=2, autoreset_mode="Disabled")
    before = env.reset(seed=[1, 2, 3])[1]["pose"]
    still = np.zeros((3, 2), dtype=np.float32)
    env.step(still)
    assert env.step(still)[3].all()
    with pytest.raises(ResetNeeded):
        env.step(still)
    mask = np.array([True, False, True])
    after = env.reset(options={"reset_mask": mask})[1]["pose"]
    assert (abs(before - after) > STAYED).any(axis=1).tolist() == mask.tolist()
    with pytest.raises(ResetNeeded):
        env.step(still)


def test_who_is_never_reset_begins_by_itself() -> None:
    env = GoalVectorEnv(2, map=ROOM)
    _, reward, ended, late, info = env.step(np.ones((2, 2), dtype=np.float32))
    assert reward.tolist() == [0.0, 0.0]
    assert not (ended | late).any()
    assert (abs(info["pose"][:, :2]) < 3.3).all()


@pytest.mark.parametrize("seed", [5, [5, 6]])
def test_the_same_seeds_give_the_same_noise(seed: int | list[int | None]) -> None:
    runs = []
    for _ in range(2):
        env = GoalVectorEnv(2, map=ROOM, realism=Realism())
        env.reset()
        seen = [env.reset(seed=seed)[0]]
        seen += [env.step(np.full((2, 2), 0.3, dtype=np.float32))[0] for _ in range(20)]
        runs.append(np.array(seen))
    np.testing.assert_array_equal(runs[0], runs[1])


def test_seeds_must_be_as_many_as_robots() -> None:
    with pytest.raises(CommandError, match="seeds: 3"):
        GoalVectorEnv(2, map=ROOM).reset(seed=[1, 2, 3])


@pytest.mark.parametrize(("count", "says"), [(0, "positive"), (4_000_000, "do not fit")])
def test_there_can_be_too_few_or_too_many_robots(count: int, says: str) -> None:
    with pytest.raises(ConfigError, match=says):
        GoalVectorEnv(count, map=ROOM)


def test_there_is_a_picture_of_each() -> None:
    env = GoalVectorEnv(2, map=ROOM, render_mode="rgb_array")
    env.reset(seed=0)
    pictures = env.render()
    assert pictures is not None
    first, second = pictures
    assert first.shape == second.shape
    alone = GoalEnv(map=ROOM, render_mode="rgb_array")
    alone.reset(seed=1)
    np.testing.assert_array_equal(second, alone.render())
