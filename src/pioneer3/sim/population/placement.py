"""Where robots begin: at a home, at a given pose, beside the map, anywhere; never in each other."""

from collections.abc import Sequence
from math import ceil, hypot, pi, sqrt
from typing import NamedTuple

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from pioneer3.errors import ConfigError
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.models import RobotModel
from pioneer3.sim.maps import LineMap
from pioneer3.sim.population.footprint import overlap, turning_circle
from pioneer3.sim.population.room import (
    Circle,
    Ground,
    Room,
    room_around,
    room_inside,
    room_on_a_plane,
)
from pioneer3.sim.worldfile.spec import Start

Float = NDArray[np.float64]

GAP = 0.1
"""Between the turning circles of robots that are put beside each other [m]."""
BESIDE = 0.5
"""Between the map and who starts outside it [m]."""
ROW = 8
"""Robots in a row beside a map without walls."""


class Newcomer(NamedTuple):
    """A robot that looks for a place to begin."""

    name: str
    model: RobotModel
    start: Start


class _Standing(NamedTuple):
    model: RobotModel
    pose: Pose2


def place_all(
    line_map: LineMap,
    newcomers: Sequence[Newcomer],
    rng: Generator,
    obstacles: Sequence[Float] = (),
) -> list[Pose2]:
    """Return where each of `newcomers` begins, in their order.

    Given poses go first and random ones last, so that chance takes nobody's place.

    Args:
        line_map: Walls and homes.
        newcomers: Who begins.
        rng: Of the random places.
        obstacles: What else stands there: the sides of convex polygons [m], shape (S, 4) each.

    Raises:
        ConfigError: There is no room left for one of them.
    """
    berths = Berths(line_map, rng, obstacles, expected=len(newcomers))
    order = ("home", "outside", "random")
    ranks = [order.index(n.start) + 1 if isinstance(n.start, str) else 0 for n in newcomers]
    found: dict[int, Pose2] = {}
    for index in sorted(range(len(newcomers)), key=ranks.__getitem__):
        found[index] = berths.find(newcomers[index])
    return [found[index] for index in range(len(newcomers))]


class Berths:
    """Gives places to one robot after another.

    Args:
        line_map: Walls and homes.
        rng: Of the random places.
        obstacles: What else stands there: the sides of convex polygons [m], shape (S, 4) each.
        expected: How many robots there will be; without walls that says how far they spread.
    """

    def __init__(
        self,
        line_map: LineMap,
        rng: Generator,
        obstacles: Sequence[Float] = (),
        expected: int = 1,
    ) -> None:
        self._map = line_map
        self._rng = rng
        self._ground = Ground.of(line_map, obstacles)
        self._expected = expected
        self._standing: list[_Standing] = []
        self._went_home = 0
        self._rooms: dict[tuple[float, Pose2 | None], tuple[Room, int]] = {}

    def take(self, model: RobotModel, pose: Pose2) -> None:
        """Note that a robot stands at `pose`."""
        self._standing.append(_Standing(model, pose))

    def find(self, newcomer: Newcomer) -> Pose2:
        """Return where `newcomer` begins; it stands there from now on.

        A given pose is taken as it is, even in a wall; only if another robot is there, the next
        free place is. The others get places where they can turn.

        Raises:
            ConfigError: There is no room left.
        """
        model, start = newcomer.model, newcomer.start
        match start:
            case "random":
                pose = self._anywhere(model)
            case "outside":
                pose = self._beside(model)
            case "home":
                homes = self._map.starts or (ORIGIN,)
                home = homes[self._went_home % len(homes)]
                self._went_home += 1
                pose = home if self._fits(model, home) else self._near(model, home)
            case Pose2():
                pose = start if self._misses_robots(model, start) else self._near(model, start)
        if pose is None:
            raise ConfigError(
                f"{newcomer.name}: no room left for a {model.name} with start "
                f"{_shown(start)}; take fewer robots, a larger map or another start"
            )
        self.take(model, pose)
        return pose

    def _near(self, model: RobotModel, wanted: Pose2) -> Pose2 | None:
        """Return the nearest place in reach of `wanted` where `model` can turn, else in the map."""
        for origin in (wanted, None):
            room = self._room(model, origin)
            for index in room.nearest_first(wanted.x, wanted.y):
                x, y = room.centres[index].tolist()
                if self._is_clear(model, x, y):
                    return Pose2(x, y, wanted.theta)
                room.open[index] = False
        return wanted if not self._standing else None

    def _anywhere(self, model: RobotModel) -> Pose2 | None:
        """Return a random place inside the map, looking anywhere."""
        room = self._room(model, None)
        heading = float(self._rng.uniform(-pi, pi))
        for index in self._rng.permutation(np.flatnonzero(room.open)).tolist():
            x, y = (room.centres[index] + self._rng.uniform(-0.5, 0.5, 2) * room.cell).tolist()
            if self._is_clear(model, x, y):
                return Pose2(x, y, heading)
        return None

    def _beside(self, model: RobotModel) -> Pose2:
        """Return the next place in rows below the map, facing it."""
        bounds, reach = self._map.bounds, turning_circle(model)
        pitch = 2 * max([reach, *(turning_circle(other) for other, _ in self._standing)]) + BESIDE
        in_row = max(1, int((bounds.x_max - bounds.x_min) / pitch)) if self._map.walls.size else ROW
        place = 0
        while True:
            row, column = divmod(place, in_row)
            x = bounds.x_min + pitch * (column + 0.5)
            y = bounds.y_min - BESIDE - pitch * (row + 0.5)
            if self._is_clear(model, x, y):
                return Pose2(x, y, pi / 2)
            place += 1

    def _fits(self, model: RobotModel, pose: Pose2) -> bool:
        return self._misses_robots(model, pose) and not self._ground.blocks(model, pose)

    def _misses_robots(self, model: RobotModel, pose: Pose2) -> bool:
        return not any(overlap(model, pose, other, there) for other, there in self._standing)

    def _is_clear(self, model: RobotModel, x: float, y: float) -> bool:
        """Whether `model` can turn at (x, y) [m] and touches nothing."""
        reach = turning_circle(model)
        if any(
            hypot(there.x - x, there.y - y) < reach + turning_circle(other) + GAP
            for other, there in self._standing
        ):
            return False
        return self._ground.clears(x, y, reach)

    def _room(self, model: RobotModel, origin: Pose2 | None) -> Room:
        """Return the floor left around `origin`, or inside the map."""
        reach = turning_circle(model)
        room, done = self._rooms.get((reach, origin)) or (self._new_room(reach, origin), 0)
        room.close(
            Circle(there.x, there.y, reach + turning_circle(other) + GAP)
            for other, there in self._standing[done:]
        )
        self._rooms[reach, origin] = room, len(self._standing)
        return room

    def _new_room(self, reach: float, origin: Pose2 | None) -> Room:
        if not self._map.walls.size:
            far = (2 * reach + GAP) * ceil(sqrt(self._expected)) + 2 * reach
            return room_on_a_plane(self._ground, reach, origin or ORIGIN, far)
        if origin:
            return room_around(self._map, self._ground, reach, origin)
        return room_inside(self._map, self._ground, reach)


def _shown(start: Start) -> str:
    return start if isinstance(start, str) else f"{start.x:.2f} {start.y:.2f}"
