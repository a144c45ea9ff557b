"""Robots at the beginning of a simulation: their models, names and starts."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap
from pioneer3.models import RobotModel, load_model
from pioneer3.sim.equipment import Equipment
from pioneer3.sim.placement.free_space import Obstructions
from pioneer3.sim.placement.placer import PlacementRequest, place_all
from pioneer3.sim.worldfile import RobotSpec, WorldFile

Float = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class SpawnedRobot:
    """A robot at the beginning of a simulation.

    Attributes:
        name: For people; no two robots have the same.
        pose: Its start [m, rad].
        port: TCP port; `None` for the next free one.
        host: Address to listen at; empty for that of all robots.
        in_the_way: It starts in a wall or an obstacle, so it cannot move.
    """

    name: str
    model: RobotModel
    pose: Pose2
    equipment: Equipment
    port: int | None = None
    host: str = ""
    in_the_way: bool = False


def spawn_robots(world: WorldFile, line_map: LineMap, rng: Generator) -> tuple[SpawnedRobot, ...]:
    """Return the robots of `world` in their order, each at a start of its own.

    Raises:
        ConfigError: A model or a name is wrong, or there is no room for a robot.
    """
    load = cache(load_model)
    models = [robot.equipment.model_with(load(robot.model)) for robot in world.robots]
    names = assign_names(world.robots, models)
    obstacles = obstacle_outlines(world)
    requests = [
        PlacementRequest(name, model, robot.start)
        for name, model, robot in zip(names, models, world.robots, strict=True)
    ]
    poses = place_all(line_map, requests, rng, obstacles)
    obstructions = Obstructions.of(line_map, obstacles)
    return tuple(
        SpawnedRobot(
            name=name,
            model=model,
            pose=pose,
            equipment=robot.equipment.equipment_of(model),
            port=robot.port,
            host=robot.host,
            in_the_way=obstructions.blocks(model, pose),
        )
        for name, model, pose, robot in zip(names, models, poses, world.robots, strict=True)
    )


def obstacle_outlines(world: WorldFile) -> list[Float]:
    """Return the sides of each box and person at the beginning that may move [m]."""
    boxes = [box.outline for box in world.movable]
    return boxes + [person.outline_at(0.0) for person in world.people]


def assign_names(robots: Sequence[RobotSpec], models: Sequence[RobotModel]) -> list[str]:
    """Return a name for each robot: its own, or its model's, numbered where several have it.

    Raises:
        ConfigError: Two robots have been given one name.
    """
    given = Counter(robot.name for robot in robots if robot.name)
    for name, count in given.items():
        if count > 1:
            raise ConfigError(f"robot {name}: {count} robots have this name; give each its own")
    names, used = [], set(given)
    for robot, model in zip(robots, models, strict=True):
        name = robot.name or unique_name(model.name, used)
        used.add(name)
        names.append(name)
    return names


def unique_name(wanted: str, used: set[str]) -> str:
    """Return `wanted`, with a number if it is among `used`."""
    name, number = wanted, 1
    while name in used:
        number += 1
        name = f"{wanted}-{number}"
    return name
