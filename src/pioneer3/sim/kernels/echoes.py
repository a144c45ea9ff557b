"""Echoes of walls: the angles at which walls send sound back, and the edges that always do."""

from dataclasses import dataclass
from math import pi, tau

import numpy as np
from numpy.typing import NDArray

from pioneer3.arrays import Bool, Float, Int
from pioneer3.sim.kernels.walls import SLACK, TOGETHER, Grid, build_grid

Sectors = NDArray[np.uint64]

SHADE = 0.02
"""A wall hides an edge that is further behind it than this [m]: sound bends around less."""

RADII = 0.0971, 0.0083
"""So far from an end it is looked whether walls go on [m].

The first passes over gaps and the steps of pixels, the second over the pieces of a wall beside its
corner. Odd, as maps are in whole millimetres or centimetres.
"""

WIDE = 0.4
"""From this share of a radius on outwards, the ends of pieces count like walls that go on."""

CELL = 0.1
"""Side of the cells in which walls are looked for [m]."""

SECTORS = 64
"""Sectors of directions of walls."""
BEND = 5
"""Sectors by which a wall may bend that still goes straight on: 30 degrees."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Reflectors:
    """Walls and edges that send sound back; robots and other moving things always do.

    Attributes:
        steep: Sine of the smallest angle between a ray and a wall that sends it back.
        edges: Points that are heard in all directions, as walls without length, or `None`. One of
            them echoes if it lies between a transducer's outermost rays and no wall hides it.
        edge_range: As long as they are nearer than this [m].
    """

    steep: float = 0.0
    edges: Grid | None = None
    edge_range: float = 0.0


ALL = Reflectors()
"""Every wall is heard at any angle, and so no edge for itself."""


def find_edges(grid: Grid) -> Grid:
    """Return the ends of walls from where none goes straight on, as walls without length.

    Where two walls that meet run on in nearly the same direction is no edge, nor is a step or a gap
    of a few centimetres.
    """
    points = np.unique(grid.walls.reshape(-1, 2), axis=0)
    near = build_grid(grid.walls, CELL)
    for radius in RADII:
        blocks = range(0, len(points), TOGETHER)
        along = [_goes_on(near, points[b : b + TOGETHER], radius) for b in blocks]
        points = points[~np.concatenate([np.empty(0, dtype=np.bool_), *along])]
    return build_grid(np.tile(points, 2), grid.cell)


def _goes_on(near: Grid, points: Float, radius: float) -> Bool:
    """Return whether walls leave a circle around each point (N, 2) on opposite sides, (N,)."""
    point, walls = near.near(points, radius)
    ends = (near.walls[walls] - np.tile(points, 2)[point]).T
    extent = ends[2:] - ends[:2]
    squared, middle = (extent * extent).sum(axis=0), -(ends[:2] * extent).sum(axis=0)
    root = middle * middle - squared * ((ends[:2] * ends[:2]).sum(axis=0) - radius * radius)
    close = np.flatnonzero(root >= 0)
    point, squared, middle = point[close], squared[close], middle[close]
    root, ends, extent = np.sqrt(root[close]), ends[:, close], extent[:, close]
    crossed = np.zeros(len(points), dtype=np.uint64)
    with np.errstate(divide="ignore", invalid="ignore"):
        for share in ((middle - root) / squared, (middle + root) / squared):
            # NaN meets nothing
            meets = np.flatnonzero((share >= -SLACK) & (share <= 1 + SLACK))
            way = share[meets] * extent[:, meets]
            _mark(crossed, point[meets], ends[:2, meets] + way)
    for end in (ends[:2], ends[2:]):
        apart = np.hypot(*end)
        beside = np.flatnonzero((apart >= WIDE * radius) & (apart <= radius))
        _mark(crossed, point[beside], end[:, beside])
    opposite = [_turned(crossed, SECTORS // 2 + bend) for bend in range(-BEND, BEND + 1)]
    goes_on: Bool = (crossed & np.bitwise_or.reduce(opposite)) != 0
    return goes_on


def _mark(crossed: Sectors, point: Int, to: Float) -> None:
    """Add the directions `to` (2, P) to the sets of the points beside them (P,)."""
    sector = ((np.arctan2(to[1], to[0]) + pi) * (SECTORS / tau)).astype(np.uint64)
    np.bitwise_or.at(crossed, point, np.uint64(1) << sector % np.uint64(SECTORS))


def _turned(sectors: Sectors, count: int) -> Sectors:
    """Return each set of sectors turned by so many."""
    turned: Sectors = sectors << np.uint64(count) | sectors >> np.uint64(SECTORS - count)
    return turned
