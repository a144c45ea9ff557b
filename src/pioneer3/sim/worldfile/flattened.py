"""Worlds without their third dimension: in words, and as a map with a world file on top of it.

The world file holds all that the map's cannot. Robots, people and movable boxes are where a
simulation has them, and are left out.
"""

from collections import Counter
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np

from pioneer3.maps import LineMap
from pioneer3.maps.materials import MATERIALS
from pioneer3.sim.relief import Relief, Solid
from pioneer3.sim.relief.relief import sides_in, sides_of
from pioneer3.sim.worldfile.spec import Box, RobotSpec, Wall, WorldFile

_PLURALS = {"mesh": "meshes"}


def flattened(world: WorldFile) -> str:
    """Return the line for a person whose world has solids, but no physics; empty without solids.

    Such as `on a plane 1 ramp and 3 steps are flat floor, and 4 tables are their legs; --physics
    has them in three dimensions`.
    """
    said = []
    if ground := solids_in_words(solid for solid in world.solids if solid.is_ground):
        said.append(_joined(ground) + _are(ground) + "flat floor")
    upright = solids_in_words(solid for solid in world.solids if not solid.is_ground)
    tables = [words for words in upright if words.endswith(("table", "tables"))]
    outlines = [words for words in upright if words not in tables]
    if outlines:
        said.append(_joined(outlines) + _are(outlines) + "walls")
    if tables:
        said.append(f"{tables[0]}{_are(tables)}{'its' if _is_one(tables) else 'their'} legs")
    if not said:
        return ""
    return f"on a plane {_joined(said, ', and ')}; --physics has them in three dimensions"


def solids_in_words(solids: Iterable[Solid]) -> list[str]:
    """Return the number of solids of each kind, such as `3 steps`."""
    counts = Counter(solid.table for solid in solids)
    return [
        f"{count} {table if count == 1 else _PLURALS.get(table, table + 's')}"
        for table, count in counts.items()
    ]


def _joined(parts: list[str], last: str = " and ") -> str:
    return last.join([", ".join(parts[:-1])] * bool(parts[:-1]) + parts[-1:])


def _are(parts: list[str]) -> str:
    return " is " if _is_one(parts) else " are "


def _is_one(parts: list[str]) -> bool:
    return len(parts) == 1 and parts[0].startswith("1 ")


def split(line_map: LineMap, relief: Relief, file: Path) -> tuple[LineMap, WorldFile]:
    """Return a map of all plain walls of the usual height, and the world that adds the others.

    `file` is where the map that is returned will be.
    """
    boxes = tuple(solid for solid in relief.solids.values() if isinstance(solid, Box))
    of_solids = {side for solid in relief.solids.values() for side in sides_of(solid.walls)}
    heights = dict(zip(sides_in(line_map.walls), relief.heights_of(line_map).tolist(), strict=True))
    materials = dict(zip(sides_in(line_map.walls), line_map.materials.tolist(), strict=True))
    usual = (0.0, relief.wall_height)
    special = [
        side
        for side in sides_in(line_map.lines)
        if side not in of_solids
        and (heights.get(side, 0.0) not in usual or materials.get(side, 0) != 0)
    ]
    taken, corners = of_solids | set(special), {box.corners for box in boxes}
    kept, plain = (
        np.array([side not in taken for side in sides_in(walls)], dtype=np.bool_)
        for walls in (line_map.walls, line_map.lines)
    )
    base = replace(
        line_map,
        walls=line_map.walls[kept],
        materials=line_map.materials[kept],
        lines=line_map.lines[plain],
        objects=tuple(item for item in line_map.objects if item.outline not in corners),
    )
    before = _world_of(relief)
    world = WorldFile(
        name=line_map.name,
        map=file,
        physics=before.physics,
        physics_step=before.physics_step,
        wall_height=relief.wall_height,
        boxes=boxes,
        walls=tuple(
            Wall(
                points=(side[:2], side[2:]),
                material=MATERIALS[materials[side]],
                height=None if heights[side] in usual else heights[side],
            )
            for side in special
        ),
        solids=tuple(solid for solid in relief.solids.values() if not isinstance(solid, Box)),
    )
    return base, world


def not_on_map(relief: Relief) -> list[str]:
    """Return the robots, people and movable boxes of the world of a relief, such as `1 robot`.

    Robots of a command line do not count, nor one that is like that of a world without any.
    """
    world = _world_of(relief)
    robots = world.robots if world.source and world.robots != (RobotSpec(),) else ()
    kinds = (
        (len(robots), "robot", "robots"),
        (len(world.people), "person", "people"),
        (len(world.movable), "movable box", "movable boxes"),
    )
    return [f"{count} {one if count == 1 else more}" for count, one, more in kinds if count]


def _world_of(relief: Relief) -> WorldFile:
    return relief.origin if isinstance(relief.origin, WorldFile) else WorldFile(name="empty")
