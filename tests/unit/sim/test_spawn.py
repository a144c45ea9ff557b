"""Who is in a world at the beginning."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.names import free_name
from pioneer3.sim.collision import stands_in
from pioneer3.sim.equipment import EquipmentOptions
from pioneer3.sim.placer import SpawnedRobot, obstacle_outlines, spawn_robots
from pioneer3.sim.worldfile import Box, Person, RobotSpec, WorldFile, load_world


def born(world: WorldFile) -> tuple[SpawnedRobot, ...]:
    return spawn_robots(world, world.line_map(), np.random.default_rng(1))


def test_the_robots_of_the_lab_are_where_it_says() -> None:
    alice, bob = born(load_world("lab"))
    assert (alice.name, alice.model.name, alice.pose) == ("alice", "p3dx-sh", Pose2(1.2, 1.2))
    assert (bob.name, bob.model.name) == ("bob", "p3at-sh")
    assert (bob.pose.x, bob.pose.y) == (9.8, 1.4)
    assert bob.pose.theta == pytest.approx(pi)
    assert (alice.equipment.gripper, bob.equipment.camera) == (True, "vcc4")
    assert not alice.in_the_way
    assert not bob.in_the_way


def test_robots_without_a_name_get_their_models_numbered() -> None:
    robots = [RobotSpec(model=model) for model in ("p3at", "p3dx", "p3at", "p3at")]
    world = WorldFile(name="w", robots=(*robots, RobotSpec(name="p3at-2")))
    names = [each.name for each in born(world)]
    assert names == ["p3at", "p3dx", "p3at-3", "p3at-4", "p3at-2"]


def test_one_name_for_two_robots_is_refused() -> None:
    world = WorldFile(name="w", robots=(RobotSpec(name="bob"),) * 2)
    with pytest.raises(ConfigError, match="robot bob: 2 robots have this name"):
        born(world)


@pytest.mark.parametrize("model", ["r2d2", "none.p", "none.toml"])
def test_a_model_that_is_none_is_refused(model: str) -> None:
    with pytest.raises(ConfigError, match=model):
        born(WorldFile(name="w", robots=(RobotSpec(model=model),)))


def test_robots_keep_off_boxes_and_people() -> None:
    crate = Box(pose=Pose2(0.0, 0.0), size=(1.0, 1.0), movable=True)
    person = Person(path=((1.5, 0.0), (9.0, 0.0)))
    world = WorldFile(name="w", robots=(RobotSpec(),), boxes=(crate,), people=(person,))
    (robot,) = born(world)
    assert [len(outline) for outline in obstacle_outlines(world)] == [4, 8]
    assert not any(
        stands_in(robot.model, robot.pose, outline) for outline in obstacle_outlines(world)
    )


def test_a_robot_that_is_put_into_a_wall_is_pointed_out() -> None:
    wall = Box(pose=Pose2(0.0, 0.0), size=(1.0, 1.0))
    inside = Box(pose=Pose2(9.0, 0.0), size=(2.0, 2.0))
    starts = (Pose2(0.4, 0.0), Pose2(3.0, 0.0), Pose2(9.0, 0.0))
    robots = tuple(RobotSpec(start=start) for start in starts)
    world = WorldFile(name="w", robots=robots, boxes=(wall, inside))
    assert [each.in_the_way for each in born(world)] == [True, False, True]
    moved = replace(world, boxes=tuple(replace(box, movable=True) for box in world.boxes))
    assert [each.in_the_way for each in born(moved)] == [True, False, True]


def test_a_peoplebot_keeps_its_table_sensors() -> None:
    robots = (RobotSpec(model="peoplebot-sh", equipment=EquipmentOptions(gripper=True)),)
    (robot,) = born(WorldFile(name="w", robots=robots))
    assert robot.equipment.table_ir == "new"
    assert robot.equipment.gripper


def test_new_names_are_free() -> None:
    assert free_name("bob", set(), "-") == "bob"
    assert free_name("bob", {"bob", "bob-2"}, "-") == "bob-3"
