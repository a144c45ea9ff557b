"""Solids and heights of walls as pages are told of them."""

import numpy as np
from numpy.typing import NDArray

from pioneer3.maps import LineMap
from pioneer3.sim.relief import Relief, Solid
from pioneer3.sim.relief.relief import sides_in
from pioneer3.sim.relief.shapes import Block, Hull, Shape, Terrain, UprightCylinder, Wedge, outer
from pioneer3.web.messages import MapShape, MapSolid

Float = NDArray[np.float64]

MOST_TRIANGLES = 3000
"""Most triangles of a drawn mesh; of one with more, a prism around it is drawn."""
MOST_ROWS = 100
"""Most rows and columns of a drawn terrain."""


def heights_of_lines(line_map: LineMap, relief: Relief) -> tuple[float, ...]:
    """Return the height of each line of a map [m]; nothing where all are `relief.wall_height`."""
    known = relief.heights_of(line_map)
    if (known == relief.wall_height).all():
        return ()
    by_side = dict(zip(sides_in(line_map.walls), known.round(3).tolist(), strict=True))
    return tuple(by_side.get(side, relief.wall_height) for side in sides_in(line_map.lines))


def solids_of(relief: Relief) -> tuple[MapSolid, ...]:
    """Return the solids, except for boxes that stand on the floor: these are walls."""
    return tuple(
        _solid(solid) for solid in relief.solids.values() if solid.table != "box" or solid.z > 0
    )


def _solid(solid: Solid) -> MapSolid:
    return MapSolid(
        kind=solid.table,
        ground=solid.is_ground,
        outline=tuple((x, y) for x, y, _, _ in solid.outline.round(3).tolist()),
        shapes=tuple(_shape(part.shape) for part in solid.parts),
    )


def _shape(shape: Shape) -> MapShape:
    pose = shape.pose
    at = (round(pose.x, 3), round(pose.y, 3), round(shape.z, 3), round(pose.theta, 4))
    match shape:
        case Block(size=size):
            return MapShape("block", at, size)
        case Wedge(size=size):
            return MapShape("wedge", at, size)
        case UprightCylinder(radius=radius, height=height):
            return MapShape("column", at, (2 * radius, 2 * radius, height))
        case Terrain(size=size):
            kept = np.ix_(*map(_spread, shape.heights.shape))
            heights = (shape.heights[kept] * size[2]).round(3)
            numbers = tuple(heights.ravel().tolist())
            return MapShape("terrain", at, size, numbers, columns=heights.shape[1])
        case Hull():
            points, corners = shape.triangles.points, shape.triangles.corners
            if len(corners) > MOST_TRIANGLES:
                points, corners = _prism(points)
            numbers = tuple(points.round(3).ravel().tolist())
            return MapShape("mesh", at, numbers=numbers, corners=tuple(corners.ravel().tolist()))


def _spread(count: int) -> NDArray[np.int64]:
    """Return at most `MOST_ROWS` of `count` rows, from the first to the last."""
    return np.linspace(0, count - 1, min(count, MOST_ROWS)).round().astype(np.int64)


def _prism(points: Float) -> tuple[Float, NDArray[np.int64]]:
    """Return points (2C, 3) and triangles (T, 3) of the upright prism around `points` (P, 3)."""
    around = outer(points[:, :2])
    count = len(around)
    levels = [np.full(count, z) for z in (points[:, 2].min(), points[:, 2].max())]
    both = np.concatenate([np.column_stack([around, level]) for level in levels])
    after = (np.arange(count) + 1) % count
    low = np.arange(count)
    sides = [(low, after, low + count), (after, after + count, low + count)]
    top = np.array([(count, count + k, count + k + 1) for k in range(1, count - 1)])
    return both, np.concatenate([*map(np.column_stack, sides), top])
