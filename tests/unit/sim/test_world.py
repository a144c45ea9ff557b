"""Robots among walls: what stops them, what they see of each other, and that it all repeats."""

from dataclasses import replace

import numpy as np
import pytest

from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.maps import LineMap
from pioneer3.models import load_model
from pioneer3.sim.body import Body
from pioneer3.sim.realism import Realism
from pioneer3.sim.sensing import PlanarSensing
from pioneer3.sim.sensors import LASER_RANGE, SONAR_MIN, SONAR_RANGE
from pioneer3.sim.world import World
from pioneer3.sim.worldfile import Box, Person, load_map
from tests.support import wall_at

MODEL = load_model("p3at-sh")
AHEAD = replace(MODEL, sonars=(replace(MODEL.sonars[0], x=0.1, y=0.0, theta=0.0),))


def driving(home: Pose2 = ORIGIN, speed: float = 0.5) -> Body:
    body = Body(AHEAD, home)
    body.enable_motors(on=True)
    body.drive.linear.go(speed)
    return body


def pass_time(world: World, seconds: float, dt: float = 0.02) -> None:
    for _ in range(round(seconds / dt)):
        world.step(dt)


def test_a_wall_stops_a_robot_that_then_pushes() -> None:
    body = driving()
    world = World(wall_at(1.0), [body])
    pass_time(world, 5)
    touching = 1.0 - MODEL.length_front
    assert touching - 0.001 < body.robot_in_world.x <= touching
    assert body.robot_in_odom == body.robot_in_world  # blocked wheels do not roll
    assert body.stalled
    assert world.is_free(body, body.robot_in_world)


@pytest.mark.parametrize("act", ["stop", "reverse", "off"])
def test_a_stall_ends_when_it_does_not_push_any_more(act: str) -> None:
    body = driving()
    world = World(wall_at(1.0), [body])
    pass_time(world, 5)
    match act:
        case "stop":
            body.drive.stop()
        case "reverse":
            body.drive.linear.go(-0.2)
        case "off":
            body.enable_motors(on=False)
    pass_time(world, 0.1)
    assert not body.stalled


def test_a_robot_at_a_wall_may_turn_as_far_as_it_has_room() -> None:
    body = Body(MODEL, Pose2(1.0 - MODEL.length_front - 0.01, 0.0, 0.0))
    body.enable_motors(on=True)
    body.drive.angular.go(1.0)
    world = World(wall_at(1.0), [body])
    pass_time(world, 5)
    assert body.stalled
    assert 0 < body.robot_in_world.theta < 0.5


def test_robots_stop_each_other() -> None:
    first, second = driving(), driving(Pose2(3.0, 0.0, np.pi))
    world = World(None, [first, second])
    pass_time(world, 10)
    assert first.stalled
    assert second.stalled
    gap = second.robot_in_world.x - first.robot_in_world.x
    assert gap == pytest.approx(2 * MODEL.length_front, abs=0.002)


@pytest.mark.parametrize(
    ("distance", "reading"),
    [(2.0, 2.0), (0.5, 0.5), (0.02, SONAR_MIN), (5.5, SONAR_RANGE)],
)
def test_a_sonar_measures_from_where_it_sits(distance: float, reading: float) -> None:
    body = Body(AHEAD)
    assert World(wall_at(0.1 + distance), [body]).sonar(body)[0] == pytest.approx(reading)


def test_robots_see_each_other_and_not_themselves() -> None:
    body, other = Body(AHEAD), Body(AHEAD, Pose2(3.0, 0.0, np.pi))
    world = World(None, [body, other])
    assert world.sonar(body)[0] == pytest.approx(3.0 - MODEL.length_front - 0.1)
    ahead, left = world.laser(body, ORIGIN, 0.0, np.pi / 2, 2)
    assert ahead == pytest.approx(3.0 - MODEL.length_front)
    assert left == LASER_RANGE


def test_far_walls_change_nothing() -> None:
    far = np.column_stack((np.full((3000, 2), 500.0), np.full((3000, 2), 501.0)))
    many = LineMap(name="many", walls=np.concatenate((wall_at(2.0).walls, far)))
    few_body, many_body = Body(AHEAD), Body(AHEAD)
    np.testing.assert_allclose(
        World(many, [many_body]).laser(many_body, Pose2(0.2), -1.0, 0.1, 21),
        World(wall_at(2.0), [few_body]).laser(few_body, Pose2(0.2), -1.0, 0.1, 21),
    )


def test_a_robot_without_sonars_hears_nothing() -> None:
    body = Body(replace(MODEL, sonars=()))
    assert World(wall_at(1.0), [body]).sonar(body).shape == (0,)


def test_the_same_steps_give_the_same_world_to_the_last_bit() -> None:
    ends = []
    for _ in range(2):
        body = driving(Pose2(0.1, 0.2, 0.3))
        body.drive.angular.go(0.7)
        world = World(wall_at(2.0), [body])
        pass_time(world, 12, 0.05)
        ends.append((body.robot_in_world, body.battery.energy, world.time))
    assert ends[0] == ends[1]


def test_a_long_step_is_as_good_as_many_short_ones() -> None:
    short, long = driving(), driving()
    pass_time(World(wall_at(1.0), [short]), 2.0, 0.02)
    World(wall_at(1.0), [long]).step(2.0)
    assert long.robot_in_world.x == pytest.approx(short.robot_in_world.x, abs=1e-9)


def test_what_is_kept_of_a_still_world_changes_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    def readings() -> list[object]:
        model = load_model("p3at-sh")
        world = World(
            load_map("office"),
            [Body(model), Body(model, Pose2(1.6, 0.3))],
            seed=3,
            realism=Realism(),
        )
        person = world.add_obstacle(Person(path=((1.0, 1.2), (1.0, -1.2)), radius=0.25))
        box = world.add_obstacle(Box(pose=Pose2(-1.0, 0.0), size=(0.3, 0.3)))
        told: list[object] = []
        for number in range(120):
            if number == 30:
                world.robots[0].enable_motors(on=True)
                world.robots[0].drive.linear.go(-0.3)
            elif number == 70:
                world.remove_obstacle(person)
            elif number == 90:
                world.move_obstacle(box, Pose2(1.0, 1.0))
            world.step(0.02)
            told += [world.sonar(body).tolist() for body in world.robots]
            told += [world.robots[0].front_bumpers, world.robots[0].rear_bumpers]
            told += [world.robots[0].robot_in_world]
        return told

    kept = readings()
    forget = PlanarSensing.forget

    def forget_all(sensing: PlanarSensing) -> None:
        sensing._places = None
        forget(sensing)

    monkeypatch.setattr(PlanarSensing, "forget", forget_all)
    assert kept == readings()
