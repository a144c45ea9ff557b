"""Refuses solids of a world file that cannot be there, with file, line and key."""

from collections import Counter

import numpy as np

from pioneer3.arrays import Float
from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.sim.relief import Cylinder, HeightField, Mesh, Ramp, Solid, Step, Table
from pioneer3.sim.relief.shapes import NONE, Hull, Shape, Terrain
from pioneer3.sim.worldfile.spec import WorldFile
from pioneer3.tables import Source

TOUCHING = 0.005
"""A wall that goes no farther into a ramp or step touches it [m]."""
MOST_SOLIDS = 500
MOST_FACES = 2_000_000
"""Cells of height fields and triangles of meshes in a world: each is memory and time."""


def check_solids(source: Source, world: WorldFile) -> None:
    """Refuse solids that cannot be there.

    Raises:
        ConfigError: A file cannot be read, legs do not fit, a ramp or step is in a wall, or the
            solids are too many in sum.
    """
    counts, barriers, faces = Counter[str](), None, 0
    for solid in world.solids:
        place = f"{solid.table}[{counts[solid.table]}]"
        counts[solid.table] += 1
        if counts.total() > MOST_SOLIDS:
            raise source.wrong(place, f"a world has no more than {MOST_SOLIDS} solids")
        match solid:
            case HeightField() | Mesh():
                try:
                    faces += sum(_faces(part.shape) for part in solid.parts)
                except ConfigError as error:
                    raise source.wrong(f"{place}.file", str(error)) from None
                if faces > MOST_FACES:
                    problem = f"with it this world has more than {MOST_FACES / 1e6:g} million cells"
                    raise source.wrong(f"{place}.file", f"{problem} and triangles; reduce it")
            case Table():
                _check_legs(source, place, solid)
            case Step() | Ramp():
                barriers = barriers or _Barriers(world)
                if at := barriers.inside(solid):
                    problem = f"a wall goes through it at {at[0]:.2f} {at[1]:.2f}; move either"
                    raise source.wrong(f"{place}.center", problem)


def _faces(shape: Shape) -> int:
    """Return the number of cells of a terrain, or of triangles of a mesh."""
    match shape:
        case Terrain(heights=heights):
            return heights.size
        case Hull(triangles=triangles):
            return len(triangles.corners)
        case _:
            return 0


def _check_legs(source: Source, place: str, table: Table) -> None:
    if 2 * table.leg_width > min(table.size):
        problem = f"two legs are wider than the top, {min(table.size):g} m"
        raise source.wrong(f"{place}.leg_width", problem)
    if table.thickness >= table.height:
        problem = f"no room for legs below the top, which is {table.height:g} m high"
        raise source.wrong(f"{place}.thickness", problem)


class _Barriers:
    """The upright sides of all that stands still: segments, from `foot` to `top` [m]."""

    def __init__(self, world: WorldFile) -> None:
        upright = [(world.base_map().walls, 0.0, world.wall_height)]
        for wall in world.walls:
            height = world.wall_height if wall.height is None else wall.height
            upright.append((wall.segments, 0.0, height))
        upright += [
            (box.outline, box.z, box.z + box.block.size[2])
            for box in world.boxes
            if not box.movable
        ]
        upright += [(s.walls, s.z, _top(s)) for s in world.solids if not s.is_ground]
        self._walls = np.concatenate([NONE, *(walls for walls, _, _ in upright)])
        lengths = [len(walls) for walls, _, _ in upright]
        self._foot = np.repeat([foot for _, foot, _ in upright], lengths)
        self._top = np.repeat([top for _, _, top in upright], lengths)

    def inside(self, solid: Step | Ramp) -> tuple[float, float] | None:
        """Return where [m] a wall is deeper in a solid than touching it, or `None`."""
        level = (self._foot < solid.z + solid.height) & (self._top > solid.z)
        near = self._walls[level]
        start, end = (_seen_from(solid.pose, near[:, columns]) for columns in ([0, 1], [2, 3]))
        half = (np.array(solid.size) / 2 - TOUCHING).clip(min=TOUCHING / 10)
        first, last = _within(start, end, half)
        hits = np.flatnonzero(first < last)
        if not len(hits):
            return None
        hit = hits[0]
        share = (first[hit] + last[hit]) / 2
        x, y = near[hit, :2] + share * (near[hit, 2:] - near[hit, :2])
        return float(x), float(y)


def _top(solid: Solid) -> float:
    match solid:
        case Cylinder():
            return solid.z + solid.height
        case Table():
            return solid.z + solid.height + solid.back
        case _:
            return np.inf


def _seen_from(pose: Pose2, points: Float) -> Float:
    """Return points (N, 2) of the map in the frame of `pose`."""
    c, s = np.cos(pose.theta), np.sin(pose.theta)
    seen: Float = (points - (pose.x, pose.y)) @ np.array([(c, -s), (s, c)])
    return seen


def _within(start: Float, end: Float, half: Float) -> tuple[Float, Float]:
    """Return the shares of segments where they enter and leave the box from -half to half."""
    extent = end - start
    with np.errstate(divide="ignore", invalid="ignore"):
        ways = np.stack([(-half - start) / extent, (half - start) / extent])
    parallel = extent == 0
    outside = parallel & (abs(start) >= half)
    low = np.where(parallel, -np.inf, ways.min(axis=0)).max(axis=1).clip(min=0)
    high = np.where(parallel, np.inf, ways.max(axis=0)).min(axis=1).clip(max=1)
    return np.where(outside.any(axis=1), np.inf, low), high
