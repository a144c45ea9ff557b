"""Sonars that fire one after the other."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap
from pioneer3.models import load_model
from pioneer3.sim.body import Body
from pioneer3.sim.kernels import Kernels
from pioneer3.sim.realism import Realism, SonarErrors
from pioneer3.sim.sensors import SONAR_RANGE
from pioneer3.sim.world import World
from tests.support import wall_at

DX, AMIGO = load_model("p3dx-sh"), load_model("amigo-sh")
IN_TURN = replace(Realism.ideal(), sonar=replace(Realism.ideal().sonar, cycle=0.04))
"""Exact, but for the time."""
ROOM = LineMap(
    name="room", walls=np.array([[-3.0, -2, 3, -2], [3, -2, 3, 2], [3, 2, -3, 2], [-3, 2, -3, -2]])
)


def driving(realism: Realism = IN_TURN, *, models: tuple[str, ...] = ("p3dx-sh",)) -> World:
    bodies = [Body(load_model(model), Pose2(0.0, 1.2 * n)) for n, model in enumerate(models)]
    for body in bodies:
        body.enable_motors(on=True)
        body.drive.linear.go(0.2)
        body.drive.angular.go(0.4)
    world = World(ROOM, bodies, Kernels(), realism=realism)
    for body in bodies:
        world.fresh_sonar(body)
    return world


def alike(body: Body) -> Body:
    return Body(body.model, body.robot_in_world)


def fresh(world: World, number: int = 0) -> list[int]:
    numbers, _ = world.fresh_sonar(world.robots[number])
    return [int(each) for each in numbers]


def test_each_array_fires_one_after_the_other() -> None:
    world = driving()
    for beat in range(20):
        world.step(0.02)
        assert not fresh(world)
        world.step(0.02)
        assert fresh(world) == [beat % 8, 8 + beat % 8]


@pytest.mark.parametrize("dt", [0.1, 0.02, 0.03, 0.007, 0.25])
def test_every_transducer_fires_as_often_however_time_is_cut(dt: float) -> None:
    world, fired = driving(), Counter[int]()
    for _ in range(round(16 / dt)):
        world.step(dt)
        fired.update(fresh(world))
    # a full turn takes 320 ms
    assert all(abs(fired[n] - 50) <= 1 for n in range(16))
    assert abs(fired.total() - 800) <= 16 if dt <= 0.1 else True


def test_all_of_a_long_silence_are_told_once() -> None:
    world = driving()
    for _ in range(10):
        world.step(0.1)
    assert fresh(world) == list(range(16))
    assert fresh(world) == []


def test_a_reading_is_of_the_place_where_the_transducer_fired() -> None:
    world = driving()
    body, known = world.robots[0], world.sonar(world.robots[0])
    for _ in range(40):
        world.step(0.04)
        numbers, ranges = world.fresh_sonar(body)
        there = World(ROOM, [Body(DX, body.robot_in_world)]).sonars()[0]
        known[numbers] = there[numbers]
        np.testing.assert_allclose(ranges, there[numbers], rtol=0, atol=1e-9)
        np.testing.assert_allclose(world.sonar(body), known, rtol=0, atol=1e-9)
        np.testing.assert_array_equal(world.sonars()[0], world.sonar(body))


def test_asking_changes_nothing() -> None:
    asked, other = driving(Realism()), driving(Realism())
    for _ in range(20):
        for world in (asked, other):
            world.step(0.1)
        asked.sonar(asked.robots[0])
        asked.sonars()
    np.testing.assert_array_equal(asked.sonars(), other.sonars())


def test_who_is_put_elsewhere_has_listened_all_around() -> None:
    world = driving()
    body = world.robots[0]
    world.step(0.1)
    fresh(world)
    body.robot_in_world = Pose2(1.0, 0.5, 1.0)
    np.testing.assert_allclose(
        world.sonar(body), World(ROOM, [Body(DX, body.robot_in_world)]).sonars()[0]
    )
    assert fresh(world) == list(range(16))
    world.change_map(wall_at(2.0))
    assert world.sonar(body).max() == SONAR_RANGE


def test_who_comes_and_goes_changes_nothing_for_the_others() -> None:
    world = driving(models=("p3dx-sh", "amigo-sh"))
    first, second = world.robots
    world.step(0.1)
    before = world.sonar(second)
    world.remove(first)
    assert fresh(world) == [0, 1]
    np.testing.assert_array_equal(world.sonar(second), before)
    third = Body(DX, Pose2(-2, -1))
    world.add(third)
    assert world.sonars().shape == (2, 16)
    np.testing.assert_array_equal(world.sonar(second), before)
    np.testing.assert_array_equal(world.sonars()[0], [*before, *[SONAR_RANGE] * 8])
    assert fresh(world, 1) == list(range(16))


def test_who_is_put_elsewhere_while_others_come_has_listened_all_around() -> None:
    world = driving()
    body = world.robots[0]
    body.robot_in_world = Pose2(1.0, 0.5, 1.0)
    world.is_free(body, body.robot_in_world)
    world.add(Body(AMIGO, Pose2(-2, -1)))
    np.testing.assert_allclose(world.sonar(body), World(ROOM, map(alike, world.robots)).sonars()[0])


def test_robots_of_several_types_measure_what_each_alone_would() -> None:
    world = driving(models=("p3dx-sh", "amigo-sh", "p3dx-sh"))
    world.fire(world.robots[2], ((5, 5, 1), ()))
    world.step(0.12)
    assert [fresh(world, n) for n in range(3)] == [[0, 1, 2, 8, 9, 10], [0, 1, 2], [1, 5]]
    true, heard = World(ROOM, map(alike, world.robots)).sonars(), world.sonars()
    for n, numbers in enumerate(([0, 1, 8], [0, 1], [1, 5])):
        np.testing.assert_allclose(heard[n, numbers], true[n, numbers], rtol=0, atol=0.2)


def test_what_is_off_stays_as_it_was_and_is_not_told() -> None:
    world = driving()
    body = world.robots[0]
    world.fire(body, ((), tuple(range(8, 16))))
    before = world.sonar(body)
    for _ in range(10):
        world.step(0.1)
    assert fresh(world) == list(range(8, 16))
    np.testing.assert_array_equal(world.sonar(body)[:8], before[:8])
    assert (world.sonar(body)[8:] != before[8:]).all()


def test_an_echo_may_be_that_of_the_one_that_fired_before() -> None:
    always = replace(IN_TURN, sonar=replace(IN_TURN.sonar, cross_talk=1.0))
    body = Body(DX)
    world = World(ROOM, [body], realism=always)
    true = World(ROOM, [Body(DX)]).sonars()[0]
    world.sonar(body)
    heard = world.sonar(body)
    for beat in range(16):
        world.step(0.04)
        for array in (0, 8):
            fires, before = array + beat % 8, array + (beat - 1) % 8
            heard[fires] = min(true[fires], heard[before])
        np.testing.assert_allclose(world.sonar(body), heard, rtol=0, atol=1e-9)


def test_mistakes_and_noise_are_as_frequent_as_all_at_once() -> None:
    errors = SonarErrors(noise=0.01, drop_out=0.05, cross_talk=0.0, rays=1, width=0.0)
    bodies = [Body(DX, Pose2(100.0 * n, 0.0)) for n in range(40)]
    walls = np.array([[100.0 * n + 2, -50.0, 100.0 * n + 2, 50] for n in range(40)])
    world = World(
        LineMap(name="walls", walls=walls), bodies, realism=replace(IN_TURN, sonar=errors)
    )
    heard = []
    for _ in range(100):
        for _ in range(4):
            world.step(0.08)
        heard.append(world.sonars()[:, 3])
    ranges = np.array(heard)
    echoes = ranges[ranges < SONAR_RANGE]
    assert 1 - len(echoes) / ranges.size == pytest.approx(0.05, abs=0.01)
    assert echoes.std() / echoes.mean() == pytest.approx(0.01, rel=0.06)


def test_steps_shorter_than_rounding_do_not_stop_the_beat() -> None:
    world = driving(replace(IN_TURN, sonar=replace(IN_TURN.sonar, cycle=0.001)))
    world.step(0.1)
    assert fresh(world) == list(range(16))
