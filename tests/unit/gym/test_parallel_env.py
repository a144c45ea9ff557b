"""Robots in one map: they see each other, run into each other, and leave."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from pettingzoo.test.parallel_test import parallel_api_test
from pettingzoo.test.seed_test import parallel_seed_test

from pioneer3.errors import CommandError, ConfigError
from pioneer3.geometry import Pose2
from pioneer3.gym import GoalParallelEnv
from pioneer3.models import load_model
from pioneer3.sim.body import Body
from pioneer3.sim.realism import Realism
from pioneer3.sim.world import World
from tests.unit.gym.rooms import PILLARED, ROOM, rooms, towards

Float32 = NDArray[np.float32]

MODEL = load_model("p3dx-sh")
STILL = np.zeros(2, dtype=np.float32)
AHEAD = np.array([0.5, 0.0], dtype=np.float32)
CORRIDOR = rooms((0.0, 0.0, 8.0, 1.0))


@pytest.mark.parametrize("realism", [None, Realism()])
def test_pettingzoos_own_check_finds_nothing(realism: Realism | None) -> None:
    parallel_api_test(GoalParallelEnv(5, map=PILLARED, sensors="both", realism=realism), 300)


@pytest.mark.parametrize("realism", [None, Realism()])
def test_the_same_seed_gives_the_same_run(realism: Realism | None) -> None:
    check: Callable[..., None] = parallel_seed_test  # which has no types
    check(lambda: GoalParallelEnv(4, map=PILLARED, realism=realism), 200)


@pytest.fixture
def corridor() -> GoalParallelEnv:
    """Two robots where one does not get past the other."""
    return GoalParallelEnv(2, map=CORRIDOR, goal_distance=(0.5, 9.0))


def at_each_other(infos: dict[str, Any]) -> dict[str, Float32]:
    """Return what turns two robots towards each other, and then drives them on."""
    pairs = (("robot_0", "robot_1"), ("robot_1", "robot_0"))
    return {
        name: towards({"pose": infos[name]["pose"], "goal": infos[other]["pose"][:2]})
        for name, other in pairs
    }


def test_robots_start_apart_and_see_each_other(corridor: GoalParallelEnv) -> None:
    noticed = 0
    for seed in range(10):
        seen, infos = corridor.reset(seed=seed)
        bodies = [Body(MODEL, Pose2(*info["pose"])) for info in infos.values()]
        assert np.hypot(*(infos["robot_0"]["pose"] - infos["robot_1"]["pose"])[:2]) > 0.7
        ranges = World(CORRIDOR, bodies).sonars()
        np.testing.assert_allclose([5 * some[:16] for some in seen.values()], ranges, atol=1e-6)
        alone = [World(CORRIDOR, [Body(MODEL, body.robot_in_world)]).sonars() for body in bodies]
        noticed += int((abs(ranges - np.concatenate(alone)) > 0.1).any())
    assert noticed > 3


def test_robots_that_drive_at_each_other_collide(corridor: GoalParallelEnv) -> None:
    infos = corridor.reset(seed=1)[1]
    ended = {"robot_0": False}
    while not any(ended.values()):
        _, rewards, ended, _, infos = corridor.step(at_each_other(infos))
    crashed = [name for name in ended if ended[name]]
    assert all(infos[name]["collision"] for name in crashed)
    assert all(rewards[name] < -9 for name in crashed)
    assert np.hypot(*(infos["robot_0"]["pose"] - infos["robot_1"]["pose"])[:2]) < 0.7
    assert set(corridor.agents) == set(ended) - set(crashed)


def test_who_has_left_is_neither_seen_nor_in_the_way(corridor: GoalParallelEnv) -> None:
    infos = corridor.reset(seed=1)[1]
    while len(corridor.agents) == 2:
        infos = corridor.step(at_each_other(infos))[4]
    (left,) = corridor.agents
    (gone,) = {*infos} - {left}
    seen, _, _, _, after = corridor.step({left: STILL})
    assert seen.keys() == {left}
    pose, other = after[left]["pose"], infos[gone]["pose"]
    body = Body(MODEL, Pose2(*pose))
    np.testing.assert_allclose(5 * seen[left][:16], World(CORRIDOR, [body]).sonar(body), atol=1e-6)
    for _ in range(40):
        if corridor.agents:
            infos = corridor.step({left: AHEAD})[4]
    beyond = (infos[left]["pose"] - pose)[:2] @ (other - pose)[:2]
    assert beyond > ((other - pose)[:2] ** 2).sum()


def test_an_arrival_ends_the_episode_of_one_alone() -> None:
    env = GoalParallelEnv(2, map=ROOM, goal_distance=(1.5, 9.0))
    infos = env.reset(seed=3)[1]
    while len(env.agents) == 2:
        actions = {"robot_0": towards(infos["robot_0"]), "robot_1": STILL}
        _, rewards, ended, late, infos = env.step(actions)
    assert ended == {"robot_0": True, "robot_1": False}
    assert infos["robot_0"]["is_success"]
    assert rewards["robot_0"] > 9
    assert rewards["robot_1"] == pytest.approx(-0.01)
    assert not any(late.values())
    assert env.agents == ["robot_1"]


def test_time_is_up_for_all_at_once() -> None:
    env = GoalParallelEnv(3, map=ROOM, max_episode_steps=2)
    env.reset(seed=0)
    actions = dict.fromkeys(env.agents, STILL)
    assert not any(env.step(actions)[3].values())
    assert all(env.step(actions)[3].values())
    assert env.agents == []
    env.reset()
    assert len(env.agents) == 3


def test_an_action_that_is_missing_is_named() -> None:
    env = GoalParallelEnv(2, map=ROOM)
    env.reset(seed=0)
    with pytest.raises(CommandError, match="robot_1"):
        env.step({"robot_0": STILL})


def test_more_robots_than_fit_are_refused() -> None:
    env = GoalParallelEnv(60, map=ROOM)
    with pytest.raises(ConfigError, match="fewer robots"):
        env.reset(seed=0)


def test_a_picture_shows_those_who_are_left() -> None:
    env = GoalParallelEnv(3, map=ROOM, render_mode="rgb_array")
    env.reset(seed=0)
    picture = env.render()
    assert picture is not None
    assert len(np.unique(picture.reshape(-1, 3), axis=0)) == 2 + 3
