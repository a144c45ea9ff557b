"""Makes a world file of a map and its relief: what a map file cannot hold comes on top of it."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from pioneer3.maps import LineMap
from pioneer3.sim.relief import Relief
from pioneer3.sim.relief.relief import sides_in, sides_of
from pioneer3.sim.worldfile.spec import Box, Wall, WorldFile


def split(line_map: LineMap, relief: Relief, file: Path) -> tuple[LineMap, WorldFile]:
    """Return a map of all that has the usual height, and the world that adds the others to it.

    Args:
        line_map: Walls, places, grids.
        relief: Of this map.
        file: Where the map that is returned will be.
    """
    boxes = tuple(solid for solid in relief.solids.values() if isinstance(solid, Box))
    of_solids = {side for solid in relief.solids.values() for side in sides_of(solid.walls)}
    heights = dict(zip(sides_in(line_map.walls), relief.heights_of(line_map).tolist(), strict=True))
    usual = (0.0, relief.wall_height)
    special = [
        side
        for side in sides_in(line_map.lines)
        if side not in of_solids and heights.get(side, 0.0) not in usual
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
    world = WorldFile(
        name=line_map.name,
        map=file,
        wall_height=relief.wall_height,
        boxes=boxes,
        walls=tuple(
            Wall(points=((x0, y0), (x1, y1)), height=heights[x0, y0, x1, y1])
            for x0, y0, x1, y1 in special
        ),
        solids=tuple(solid for solid in relief.solids.values() if not isinstance(solid, Box)),
    )
    return base, world
