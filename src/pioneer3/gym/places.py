"""Where robots can start and goals can be."""

from collections.abc import Sequence
from math import hypot, inf
from typing import NamedTuple

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from pioneer3.errors import ConfigError
from pioneer3.sim.kernels import build_grid
from pioneer3.sim.maps import LineMap
from pioneer3.sim.placement.free_space import FreeGrid, Obstructions, places_inside

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]

SPARE = 0.05
"""Between the turning circle of a robot and the nearest wall [m]."""
TRIES = 10_000
"""To find a place that suits."""

Point = tuple[float, float]


class Ring(NamedTuple):
    """What is so far from each of some points [m]."""

    around: Sequence[Point]
    least: float
    most: float = inf


class Places:
    """Places of a map where a robot can turn, each of which can be reached from each.

    Args:
        line_map: Walls, and homes that say which side of them is inside.
        walls: All that stands there: segments [m], shape (W, 4).
        radius: Of the circle that the robot needs to turn in [m].

    Attributes:
        points: [m], shape (K, 2).

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

    def draw(self, rng: Generator, *rings: Ring) -> Point:
        """Return a random place within all of `rings`.

        Raises:
            ConfigError: None was found.
        """
        for _ in range(TRIES):
            x, y = self.points[rng.integers(len(self.points))].tolist()
            away = ((hypot(a - x, b - y), ring) for ring in rings for a, b in ring.around)
            if all(ring.least <= distance <= ring.most for distance, ring in away):
                return x, y
        raise ConfigError(
            f"no start or goal found in {TRIES} tries; take fewer robots, a larger map or a wider "
            "goal_distance"
        )


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
