"""Saving maps of simulated worlds: what a world keeps, and what is said to be left out."""

from dataclasses import replace
from pathlib import Path

import pytest

from pioneer3.geometry import Pose2
from pioneer3.maps.materials import Material
from pioneer3.navigation.map_files import left_out, save_map
from pioneer3.sim.worldfile import Box, Person, RobotSpec, Wall, WorldFile, load_world

GLASS_DOOR = Wall(points=((0.0, 0.0), (1.0, 0.0)), material=Material.GLASS, height=2.2)
BLACK_WALL = Wall(points=((0.0, 1.0), (1.0, 1.0)), material=Material.BLACK)
PLAIN_WALL = Wall(points=((0.0, 2.0), (1.0, 2.0)))
COUNTER = Box(pose=Pose2(5.0, 5.0), size=(1.0, 1.0), material=Material.BLACK, height=1.1)
CRATE = Box(pose=Pose2(7.0, 7.0), size=(1.0, 1.0), movable=True)
WORLD = WorldFile(
    name="w",
    physics="mujoco",
    physics_step=0.001,
    robots=(RobotSpec(model="p3dx"), RobotSpec()),
    walls=(GLASS_DOOR, BLACK_WALL, PLAIN_WALL),
    boxes=(COUNTER, CRATE),
    people=(Person(path=((3.0, 3.0),)),),
    source="w.toml",
)


def test_a_saved_world_keeps_physics_and_the_materials_of_walls(tmp_path: Path) -> None:
    line_map = WORLD.line_map()
    save_map(line_map, tmp_path / "lab.toml", WORLD.relief(line_map))
    saved = load_world(tmp_path / "lab.toml")
    assert (saved.physics, saved.physics_step) == ("mujoco", 0.001)
    assert set(saved.walls) == {GLASS_DOOR, BLACK_WALL}
    assert saved.boxes == (COUNTER,)
    assert sorted(saved.line_map().materials.tolist()) == sorted(line_map.materials.tolist())


@pytest.mark.parametrize(
    ("world", "name", "said"),
    [
        (WORLD, "a.toml", "2 robots, 1 person, 1 movable box"),
        (WORLD, "a.map", "6 materials of walls, 2 robots, 1 person, 1 movable box"),
        (replace(WORLD, robots=(RobotSpec(),), boxes=(), people=()), "a.toml", ""),
        (replace(WORLD, source="", boxes=(), people=()), "a.toml", ""),
    ],
)
def test_what_a_saved_map_does_not_have_is_said(world: WorldFile, name: str, said: str) -> None:
    line_map = world.line_map()
    assert left_out(line_map, Path(name), world.relief(line_map)) == said
