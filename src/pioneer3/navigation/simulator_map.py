"""The map that a simulator in another program names, where it is known here too."""

import asyncio
from pathlib import Path

from pioneer3.arcos.commands import SimCtrl, SimOperation
from pioneer3.arcos.reports import MapChanged
from pioneer3.errors import ConfigError
from pioneer3.maps import LineMap, shipped_maps
from pioneer3.robot.identity import is_simulator
from pioneer3.runtime.robot import Robot
from pioneer3.sim.relief import Relief
from pioneer3.sim.worldfile import WorldFile, file_in, load_world, shipped_worlds

OF_SIMULATOR = "simulator"
"""In place of a map: the one that the simulator names."""
ENDINGS = (".map", ".toml", ".yaml")
MAP_PATIENCE = 2.0
"""Time within which a simulator names its map [s]."""
REMEDY = "give the map with --map (in Python: line_map=)"


async def map_of_simulator(robot: Robot) -> LineMap:
    """Return the map that the simulator at the other end of the link names.

    Raises:
        ConfigError: It is a robot, or names no map, or one that is not known here.
    """
    url = robot.info.url
    if not is_simulator(robot.info):
        raise ConfigError(f"{url}: a robot names no map: {REMEDY}")
    with robot.supervisor.reports.subscribe(MapChanged) as told:
        robot.send(SimCtrl(SimOperation.REQUEST_INFO))
        try:
            async with asyncio.timeout(MAP_PATIENCE):
                name = (await anext(aiter(told))).file_name
        except (TimeoutError, StopAsyncIteration):
            raise ConfigError(f"{url}: this simulator names no map: {REMEDY}") from None
    try:
        return (await asyncio.to_thread(known_map, name))[0]
    except ConfigError as error:
        raise ConfigError(f"the map of the simulator: {error}; {REMEDY}") from None


def known_map(name: str) -> tuple[LineMap, Relief]:
    """Return the map that ships under `name`, or lies in the working folder, and its heights.

    Raises:
        ConfigError: There is none, or it cannot be read.
    """
    stem = name.removesuffix(".map")
    if stem in {"empty", *shipped_maps(), *shipped_worlds()}:
        return _with_relief(load_world(stem))
    path = next((p for e in ENDINGS if (p := file_in(Path(), stem + e))), None)
    if path is None:
        raise ConfigError(f"there is no map {stem[:40]!r} here")
    return _with_relief(load_world(path))


def _with_relief(world: WorldFile) -> tuple[LineMap, Relief]:
    line_map = world.line_map()
    return line_map, world.relief(line_map)
