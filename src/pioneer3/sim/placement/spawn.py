"""Who is in a world at the beginning: models read, names given, places found."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.models import RobotModel, load_model
from pioneer3.sim.equipment import Equipment
from pioneer3.sim.maps import LineMap
from pioneer3.sim.placement.free_space import Ground
from pioneer3.sim.placement.placer import Newcomer, place_all
from pioneer3.sim.worldfile import RobotSpec, WorldFile

Float = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Inhabitant:
    """A robot at the beginning.

    Attributes:
        name: What people call it; no two have the same.
        model: Its type.
        pose: Where it begins [m, rad].
        equipment: What is fitted to it.
        port: TCP port; `None` for the next free one.
        in_the_way: It begins in a wall or an obstacle: it cannot move.
    """

    name: str
    model: RobotModel
    pose: Pose2
    equipment: Equipment
    port: int | None = None
    in_the_way: bool = False


def populate(world: WorldFile, line_map: LineMap, rng: Generator) -> tuple[Inhabitant, ...]:
    """Return the robots of `world` in their order, each with a place of its own.

    Args:
        world: What is asked for.
        line_map: Its :meth:`WorldFile.line_map`.
        rng: Of the random places.

    Raises:
        ConfigError: A model or a name is wrong, or there is no room for a robot.
    """
    load = cache(load_model)
    models = [robot.equipment.to(load(robot.model)) for robot in world.robots]
    names = names_of(world.robots, models)
    obstacles = outlines(world)
    newcomers = [
        Newcomer(name, model, robot.start)
        for name, model, robot in zip(names, models, world.robots, strict=True)
    ]
    poses = place_all(line_map, newcomers, rng, obstacles)
    ground = Ground.of(line_map, obstacles)
    return tuple(
        Inhabitant(
            name=name,
            model=model,
            pose=pose,
            equipment=robot.equipment.on(model),
            port=robot.port,
            in_the_way=ground.blocks(model, pose),
        )
        for name, model, pose, robot in zip(names, models, poses, world.robots, strict=True)
    )


def outlines(world: WorldFile) -> list[Float]:
    """Return what stands in a world at the beginning and may move: the sides of each [m]."""
    boxes = [box.outline for box in world.movable]
    return boxes + [person.outline_at(0.0) for person in world.people]


def names_of(robots: Sequence[RobotSpec], models: Sequence[RobotModel]) -> list[str]:
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
        name = robot.name or new_name(model.name, used)
        used.add(name)
        names.append(name)
    return names


def new_name(wanted: str, used: set[str]) -> str:
    """Return `wanted`, with a number if it is among `used`."""
    name, number = wanted, 1
    while name in used:
        number += 1
        name = f"{wanted}-{number}"
    return name
