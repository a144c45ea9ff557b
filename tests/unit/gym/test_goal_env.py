"""One robot and its goal: the spaces, the reward, the ends, and that it all repeats."""

from dataclasses import replace
from itertools import islice
from math import atan2, cos, hypot, sin
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from pioneer3.errors import CommandError, ConfigError
from pioneer3.geometry import Pose2
from pioneer3.gym import GoalEnv, Reward
from pioneer3.gym.simulation import COMPILING
from pioneer3.gym.task import EPISODE, Sensors, Task, TaskOptions
from pioneer3.jit import KernelCache
from pioneer3.models import load_model
from pioneer3.sim.body import Body
from pioneer3.sim.realism import Realism
from pioneer3.sim.world import World
from tests.unit.gym.rooms import PILLARED, ROOM, towards

AHEAD = np.array([1.0, 0.0], dtype=np.float32)
STILL = np.zeros(2, dtype=np.float32)
MODEL = load_model("p3dx-sh")


def made(**options: Any) -> gymnasium.Env[Any, Any]:
    return gymnasium.make("pioneer3/Goal-v0", **options)


def run(env: GoalEnv, seed: int | None, steps: int) -> list[Any]:
    """Return all that an environment says while it goes where its seed takes it."""
    env.reset(seed=seed)
    env.action_space.seed(seed)
    said: list[Any] = []
    for _ in range(steps):
        seen, reward, ended, _, info = env.step(env.action_space.sample())
        said += [*seen.tolist(), reward, *info["pose"], *info["goal"]]
        if ended:
            env.reset()
    return said


@pytest.mark.parametrize("sensors", ["sonar", "laser", "both"])
@pytest.mark.parametrize("realism", [None, Realism()])
def test_gymnasiums_own_check_finds_nothing(sensors: Sensors, realism: Realism | None) -> None:
    check_env(made(map=PILLARED, sensors=sensors, realism=realism).unwrapped)


@pytest.mark.parametrize(("sensors", "size"), [("sonar", 21), ("laser", 24), ("both", 40)])
def test_an_observation_has_so_many_numbers(sensors: Sensors, size: int) -> None:
    env = GoalEnv(map=ROOM, sensors=sensors, beams=19)
    assert env.observation_space.shape == (size,)
    assert env.reset(seed=1)[0].shape == (size,)


def test_ranges_are_those_of_a_robot_at_that_place() -> None:
    env = GoalEnv(map=PILLARED, sensors="both", beams=19, laser_range=4.0)
    mount = MODEL.laser
    assert mount is not None
    for seed in range(20):
        seen, info = env.reset(seed=seed)
        body = Body(MODEL, Pose2(*info["pose"]))
        world = World(PILLARED, [body])
        laser = world.laser(body, Pose2(mount.x, mount.y), -np.pi / 2, np.pi / 18, 19)
        np.testing.assert_allclose(seen[:16] * 5, world.sonar(body), atol=1e-6)
        np.testing.assert_allclose(seen[16:35] * 4, laser.clip(max=4.0), atol=1e-6)


def test_sonars_that_fire_in_turn_are_observed_as_they_were_last_known() -> None:
    exact = Realism.ideal()
    in_turn = replace(exact, sonar=replace(exact.sonar, cycle=0.04))
    env = GoalEnv(map=PILLARED, realism=in_turn)
    for seed in range(3):
        seen, info = env.reset(seed=seed)
        all_around = World(PILLARED, [Body(MODEL, Pose2(*info["pose"]))]).sonars()[0]
        np.testing.assert_allclose(seen[:16] * 5, all_around, atol=1e-6)
        before, beat, changed = seen[:16], 0, set[int]()
        for step in range(1, 9):
            seen, *_ = env.step(np.array([0.2, 1.0], dtype=np.float32))
            fired = {array + b % 8 for b in range(beat, 5 * step // 2) for array in (0, 8)}
            news = set(np.flatnonzero(seen[:16] != before).tolist())
            assert news <= fired
            before, beat, changed = seen[:16], 5 * step // 2, changed | news
        assert len(changed) > 8


def test_the_goal_is_seen_where_it_is() -> None:
    env = GoalEnv()
    for seed in range(20):
        seen, info = env.reset(seed=seed)
        (x, y, theta), (goal_x, goal_y) = info["pose"], info["goal"]
        bearing = atan2(goal_y - y, goal_x - x) - theta
        distance = min(hypot(goal_x - x, goal_y - y) / 10, 1.0)
        expected = [distance, cos(bearing), sin(bearing), 0.0, 0.0]
        np.testing.assert_allclose(seen[16:], expected, atol=1e-6)


def test_a_robot_speeds_up_to_what_was_asked_for() -> None:
    env = GoalEnv(map=ROOM, goal_distance=(4.0, 6.0))
    env.reset(seed=3)
    for _ in range(20):
        seen = env.step(np.array([0.2, 0.5], dtype=np.float32))[0]
    np.testing.assert_allclose(seen[-2:], [0.2, 0.5], atol=1e-6)


def test_an_action_beyond_the_limits_is_cut_off_there() -> None:
    ends = []
    for factor in (1.0, 50.0):
        env = GoalEnv(map=ROOM)
        env.reset(seed=0)
        ends.append([env.step(factor * AHEAD)[0].tolist() for _ in range(8)])
    assert ends[0] == ends[1]


@pytest.mark.parametrize("action", [[np.nan, 0.0], [0.0, np.inf], [0.0]])
def test_an_action_that_is_none_is_refused(action: list[float]) -> None:
    env = GoalEnv(map=ROOM)
    env.reset(seed=0)
    with pytest.raises(CommandError, match="actions"):
        env.step(np.array(action, dtype=np.float32))


def test_a_reward_is_progress_less_time() -> None:
    env = GoalEnv(map=ROOM, reward=Reward(progress=3.0, time=-0.5))
    info = env.reset(seed=2)[1]
    for _ in range(10):
        before = np.hypot(*(info["goal"] - info["pose"][:2]))
        _, reward, _, _, info = env.step(towards(info))
        after = np.hypot(*(info["goal"] - info["pose"][:2]))
        assert reward == pytest.approx(3.0 * (before - after) - 0.5)


def test_who_drives_to_the_goal_arrives() -> None:
    env = GoalEnv(map=ROOM, reward=Reward(arrival=100.0))
    for seed in range(5):
        info = env.reset(seed=seed)[1]
        for _ in range(EPISODE):
            _, reward, ended, truncated, info = env.step(towards(info))
            if ended:
                break
        assert info["is_success"]
        assert not info["collision"]
        assert not truncated
        assert np.hypot(*(info["goal"] - info["pose"][:2])) < 0.3
        assert reward == pytest.approx(100.0, abs=0.2)


def test_who_drives_into_a_wall_has_collided() -> None:
    env = GoalEnv(map=ROOM, goal_distance=(4.0, 9.0), reward=Reward(collision=-7.0))
    info = env.reset(seed=1)[1]
    while info["pose"][2] % (2 * np.pi) > 0.1:
        info = env.step(np.array([0.0, 0.3], dtype=np.float32))[4]
    for _ in range(EPISODE):
        _, reward, ended, _, info = env.step(AHEAD)
        if ended:
            break
    assert info["collision"]
    assert not info["is_success"]
    assert reward == pytest.approx(-7.0, abs=0.2)
    assert info["pose"][0] + MODEL.length_front * cos(info["pose"][2]) == pytest.approx(
        3.3, abs=0.1
    )


def first_collision(env: GoalEnv, steps: int) -> int:
    """Return after how many steps a robot that goes in a curve runs into something."""
    curve = np.array([0.6, 0.35], dtype=np.float32)
    return next((n for n in range(steps) if env.step(curve)[4]["collision"]), steps)


def test_a_long_step_misses_no_collision() -> None:
    short, long = GoalEnv(map=PILLARED), GoalEnv(map=PILLARED, dt=1.0)
    for seed in range(30):
        short.reset(seed=seed)
        long.reset(seed=seed)
        assert first_collision(long, 20) == first_collision(short, 200) // 10


def test_an_episode_ends_after_so_many_steps() -> None:
    env = made(map=ROOM, max_episode_steps=5)
    env.reset(seed=0)
    ends = [env.step(STILL)[2:4] for _ in range(5)]
    assert ends == [(False, False)] * 4 + [(False, True)]
    spec = gymnasium.spec("pioneer3/Goal-v0")
    assert spec.max_episode_steps == EPISODE


@pytest.mark.parametrize("realism", [None, Realism()])
def test_the_same_seed_gives_the_same_run_to_the_last_bit(realism: Realism | None) -> None:
    env, other = GoalEnv(map=PILLARED, realism=realism), GoalEnv(map=PILLARED, realism=realism)
    first = run(env, 7, 200)
    assert run(other, 7, 200) == first
    assert run(env, 7, 200) == first
    assert run(env, 8, 200) != first


def test_without_a_seed_every_episode_is_another() -> None:
    env = GoalEnv(map=ROOM)
    starts = {tuple(env.reset()[1]["pose"]) for _ in range(5)}
    assert len(starts) == 5


def test_realism_makes_ranges_wrong() -> None:
    exact, noisy = GoalEnv(map=ROOM), GoalEnv(map=ROOM, realism=Realism())
    difference = abs(exact.reset(seed=4)[0] - noisy.reset(seed=4)[0])
    assert difference[:16].max() > 1e-4
    assert difference[16:].max() == 0.0


def test_goals_are_as_far_away_as_asked_for() -> None:
    env = GoalEnv(goal_distance=(2.0, 3.0))
    infos = [env.reset(seed=seed)[1] for seed in range(50)]
    away = [np.hypot(*(info["goal"] - info["pose"][:2])) for info in infos]
    assert 2.0 <= min(away) < 2.3
    assert 2.7 < max(away) <= 3.0


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"sensors": "sonr"}, "sonar, laser, both"),
        ({"map": "offce"}, "office"),
        ({"model": "p3dxx"}, "p3dx"),
        ({"model": "amigo-sh", "sensors": "laser"}, "no laser"),
        ({"model": replace(MODEL, sonars=())}, "no sonars"),
        ({"dt": 0.0}, "dt"),
        ({"beams": 1}, "beams"),
        ({"threads": 0}, "threads"),
        ({"laser_range": np.inf}, "laser_range"),
        ({"goal_distance": (0.2, 1.0)}, "goal_distance"),
        ({"goal_distance": (2.0, 1.0)}, "goal_distance"),
        ({"render_mode": "ansi"}, "rgb_array"),
    ],
)
def test_a_wrong_option_is_named(options: dict[str, Any], says: str) -> None:
    with pytest.raises(ConfigError, match=says):
        GoalEnv(**options)


def test_an_unknown_option_is_refused() -> None:
    with pytest.raises(TypeError, match="sensor"):
        made(sensor="sonar")


def test_a_reward_without_end_is_refused() -> None:
    with pytest.raises(ConfigError, match="reward time"):
        Reward(time=-np.inf)


def test_options_and_tasks_have_the_same_fields() -> None:
    assert TaskOptions.__annotations__ == Task.__annotations__


def test_a_picture_shows_walls_the_robot_and_its_goal() -> None:
    env = GoalEnv(map=ROOM, render_mode="rgb_array")
    env.reset(seed=0)
    first = env.render()
    for _ in range(5):
        env.step(np.array([0.0, 1.0], dtype=np.float32))
    second = env.render()
    assert first is not None
    assert second is not None
    assert first.dtype == np.uint8
    assert max(first.shape[:2]) == 600
    assert first.shape[0] % 2 == 0
    assert len(np.unique(first.reshape(-1, 3), axis=0)) == 3
    assert (first != second).any()


def test_without_a_render_mode_there_is_no_picture() -> None:
    env = GoalEnv(map=ROOM)
    env.reset(seed=0)
    assert env.render() is None


@pytest.mark.parametrize(("dt", "rate"), [(0.1, 10), (0.05, 20), (0.25, 4)])
def test_films_run_at_the_pace_of_the_robot(dt: float, rate: int) -> None:
    assert GoalEnv(map=ROOM, dt=dt).metadata["render_fps"] == rate


def test_a_film_can_be_made_by_gymnasium() -> None:
    env = gymnasium.wrappers.RenderCollection(made(map=ROOM, render_mode="rgb_array"))
    env.reset(seed=0)
    for _ in islice(iter(int, 1), 3):
        env.step(STILL)
    frames = env.render()
    assert isinstance(frames, list)
    assert len(frames) == 4


def test_with_physics_an_episode_repeats_and_a_robot_arrives() -> None:
    pytest.importorskip("mujoco")
    env = GoalEnv(map=ROOM, physics="mujoco")
    runs = []
    for _ in range(2):
        env.reset(seed=3)
        env.action_space.seed(3)
        runs.append([env.step(AHEAD)[0].tolist() for _ in range(10)])
    assert runs[0] == runs[1]
    assert runs[0][0] != runs[0][-1]


def test_the_first_one_on_a_machine_says_that_it_compiles(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(KernelCache, "is_missing", property(lambda _: True))
    GoalEnv(map=ROOM)
    assert caplog.messages == [COMPILING]


def test_physics_that_are_none_are_refused() -> None:
    with pytest.raises(ConfigError, match="physics: 'bullet' is not one of planar, mujoco"):
        Task(physics="bullet")  # type: ignore[arg-type]
