"""Maps for many episodes at once: copies side by side, and positions for starts and goals."""

from collections.abc import Sequence
from math import ceil, floor, hypot, inf, sqrt
from typing import NamedTuple

import numpy as np
from numpy.random import Generator

from pioneer3.arrays import Bool, Float
from pioneer3.errors import ConfigError
from pioneer3.maps import Extent, LineMap
from pioneer3.sim.free_space import FreeGrid, Obstructions, places_inside
from pioneer3.sim.kernels import build_grid

Point = tuple[float, float]

FENCE = 1
"""From the walls of a map to the fence around it [m]."""
GAP = 1
"""Between the fences of two copies [m]."""
BASE = 2.0**14
"""All copies lie between this and twice this in x and y [m].

There all numbers have the same spacing (3.6e-12 m), and copies are whole metres apart: sums and
differences round alike in each of them, so that all copies give the same numbers to the last bit.
"""
SPARE = 0.05
"""Between the turning circle of a robot and the nearest wall [m]."""
TRIES = 10_000
"""To find a position within the limits."""


class TiledMap:
    """Copies of a map with a fence around each, side by side, in which all numbers round alike.

    Attributes:
        bounds: Of the fence, in the frame of the map [m].
        walls: Of one copy, fence included, in the frame of the map [m], shape (W, 4).
        offsets: From the frame of the map to each copy [m], whole numbers, shape (count, 2).
        line_map: All copies as one map.

    Raises:
        ConfigError: So many do not fit.
    """

    def __init__(self, line_map: LineMap, count: int) -> None:
        x0, y0, x1, y1 = line_map.bounds
        self.bounds = Extent(x0 - FENCE, y0 - FENCE, x1 + FENCE, y1 + FENCE)
        self.walls = np.concatenate([line_map.walls, _sides(self.bounds)])
        left, bottom = floor(x0) - FENCE, floor(y0) - FENCE
        pitch = np.array([ceil(x1) + FENCE + GAP - left, ceil(y1) + FENCE + GAP - bottom])
        columns = ceil(sqrt(count))
        if columns * int(pitch.max()) > BASE:
            raise ConfigError(
                f"{count} copies of a map of {pitch[0]} m x {pitch[1]} m do not fit into "
                f"{BASE:g} m x {BASE:g} m; take fewer or a smaller map"
            )
        number = np.arange(count)
        places = np.stack([number % columns, number // columns], axis=1)
        self.offsets = BASE + places * pitch - np.array([left, bottom])
        moved = self.walls + np.tile(self.offsets, 2)[:, None, :]
        fence = np.zeros(len(self.walls) - len(line_map.walls), dtype=np.uint8)
        materials = np.tile(np.concatenate([line_map.materials, fence]), count)
        self.line_map = LineMap(name=line_map.name, walls=moved.reshape(-1, 4), materials=materials)


class Distance(NamedTuple):
    """Limits of the distance to each of some points [m]."""

    points: Sequence[Point]
    least: float
    most: float = inf


class FreeSpace:
    """Points (K, 2) in a map where a robot can turn, each of which can be reached from each other.

    The homes of `line_map` say which side of its walls is inside; `walls` are those of the map and
    the fence [m], shape (W, 4). The robot needs a circle of this `radius` to turn in [m].

    Raises:
        ConfigError: There are none.
    """

    def __init__(self, line_map: LineMap, walls: Float, radius: float) -> None:
        ground = Obstructions.of(line_map)
        floor = FreeGrid(ground.barriers, line_map.bounds, radius, ground.solids)
        points = _largest_part(floor, places_inside(line_map, ground, radius).centres)
        room = build_grid(walls).clearance(points, 2 * (radius + SPARE))
        self.points = points[room >= radius + SPARE]
        if not len(self.points):
            raise ConfigError(
                f"map {line_map.name}: nowhere is room for a robot that turns in a circle of "
                f"{radius:.2f} m; take another map or a smaller robot"
            )

    def sample(self, rng: Generator, *limits: Distance) -> Point:
        """Return a random position within all `limits`.

        Raises:
            ConfigError: None was found.
        """
        for _ in range(TRIES):
            x, y = self.points[rng.integers(len(self.points))].tolist()
            away = ((hypot(a - x, b - y), limit) for limit in limits for a, b in limit.points)
            if all(limit.least <= distance <= limit.most for distance, limit in away):
                return x, y
        raise ConfigError(
            f"no start or goal found in {TRIES} tries; take fewer robots, a larger map or a wider "
            "goal_distance"
        )


def _sides(bounds: Extent) -> Float:
    x0, y0, x1, y1 = bounds
    return np.array([[x0, y0, x1, y0], [x1, y0, x1, y1], [x1, y1, x0, y1], [x0, y1, x0, y0]])


def _largest_part(floor: FreeGrid, points: Float) -> Float:
    """Return those of `points` that can be reached from each other, as many as possible."""
    cells = [floor.cell_of((x, y)) for x, y in points.tolist()]
    rows, columns = np.array(cells, dtype=np.int64).reshape(-1, 2).T
    left, best = np.ones(len(points), dtype=np.bool_), np.zeros(len(points), dtype=np.bool_)
    while left.sum() > best.sum():
        x, y = points[left.argmax()].tolist()
        part: Bool = floor.reached_from([(x, y)])[rows, columns] & left
        left &= ~part
        best = max(part, best, key=np.sum)
    return points[best]
