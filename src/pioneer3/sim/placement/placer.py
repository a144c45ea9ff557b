"""Where robots begin: at a home, at a given pose, beside the map, anywhere; never in each other."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import ceil, cos, hypot, pi, radians, sin, sqrt
from typing import NamedTuple

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from pioneer3.errors import ConfigError
from pioneer3.geometry import ORIGIN, Pose2, wrap
from pioneer3.models import RobotModel
from pioneer3.sim.maps import LineMap
from pioneer3.sim.placement.footprint import overlap, turning_circle
from pioneer3.sim.placement.free_space import (
    Circle,
    Ground,
    Room,
    room_around,
    room_inside,
    room_on_a_plane,
)
from pioneer3.sim.worldfile.spec import Start

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]

GAP = 0.1
"""Between the turning circles of robots where there is little room [m]."""
APART = 0.5
"""The same where there is enough [m]."""
AHEAD = 1.2
"""So far every robot can drive forward before it comes to a wall or a robot that stands [m]."""
TURNS = tuple(radians(angle) for angle in (0, 90, -90, 180))
"""Away from the heading that is wanted, where that leads nowhere."""
BESIDE = 0.5
"""Between robots that start outside the map [m]."""
CHUNK = 256
"""Places that are looked at together."""
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
                free = self._fits(model, home) and self._keeps_clear(model, home)
                pose = home if free else self._near(model, home)
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
        """Return the nearest place in reach of `wanted` where `model` can turn, else in the map.

        From there it can drive on, and it keeps clear of others, as far as there is room for that.
        """
        room = self._room(model, wanted)
        within = self._within_map(room.centres)
        for apart in (APART, GAP):
            for turn in TURNS:
                heading = wrap(wanted.theta + turn)
                roomy = within & room.leads_on(heading, AHEAD)
                order = room.nearest_first(wanted.x, wanted.y, roomy)
                for x, y in self._apart(model, room.centres[order], heading, apart):
                    if self._leads_on(model, pose := Pose2(x, y, heading)):
                        return pose
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
        places = room.centres + self._rng.uniform(-0.5, 0.5, room.centres.shape) * room.cell
        order = self._rng.permutation(np.flatnonzero(room.open))
        roomy = order[room.leads_on(heading, AHEAD)[order]]
        for x, y in self._apart(model, places[roomy], heading, APART):
            if self._leads_on(model, pose := Pose2(x, y, heading)):
                return pose
        for x, y in places[order].tolist():
            if self._is_clear(model, x, y):
                return Pose2(x, y, heading)
        return None

    def _beside(self, model: RobotModel) -> Pose2:
        """Return the next place in rows below the map, facing it."""
        bounds, reach = self._map.bounds, turning_circle(model)
        widest = 2 * max([reach, *(turning_circle(other) for other, _ in self._standing)])
        pitch, depth = widest + BESIDE, widest + AHEAD
        in_row = max(1, int((bounds.x_max - bounds.x_min) / pitch)) if self._map.walls.size else ROW
        place = 0
        while True:
            row, column = divmod(place, in_row)
            x = bounds.x_min + pitch * (column + 0.5)
            y = bounds.y_min - AHEAD - widest / 2 - depth * row
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

    def _within_map(self, places: Float) -> Bool:
        """Return which places are not beside the map, where it has walls, shape (N,)."""
        if not self._map.walls.size:
            return np.ones(len(places), dtype=np.bool_)
        low, high = np.reshape(self._map.bounds, (2, 2))
        x, y = ((places >= low) & (places <= high)).T
        within: Bool = x & y
        return within

    def _leads_on(self, model: RobotModel, pose: Pose2) -> bool:
        """Whether `model` can turn at `pose`, and drive on from there."""
        return self._is_clear(model, pose.x, pose.y) and not self._ground.blocks(
            replace(model, length_front=model.length_front + AHEAD), pose
        )

    def _keeps_clear(self, model: RobotModel, pose: Pose2) -> bool:
        """Whether neither `model` at `pose` nor those that stand are in each other's way."""
        return bool(self._clear_of_others(model, np.array([[pose.x, pose.y]]), pose.theta, 0.0)[0])

    def _apart(
        self, model: RobotModel, places: Float, heading: float, apart: float
    ) -> Iterator[list[float]]:
        """Yield those of `places` [m], shape (N, 2), that are `apart` from who stands, in order."""
        for first in range(0, len(places), CHUNK):
            some = places[first : first + CHUNK]
            yield from some[self._clear_of_others(model, some, heading, apart)].tolist()

    def _clear_of_others(
        self, model: RobotModel, places: Float, heading: float, apart: float
    ) -> Bool:
        """Return where nobody is before `model`, nor it before anybody, shape (N,)."""
        clear = np.ones(len(places), dtype=np.bool_)
        for other, there in self._standing:
            near = turning_circle(model) + turning_circle(other)
            offset = places - (there.x, there.y)
            clear &= np.hypot(*offset.T) >= near + apart
            clear &= _from_way(offset, there.theta) >= near
            clear &= _from_way(-offset, heading) >= near
        return clear

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


def _from_way(offset: Float, heading: float) -> Float:
    """Return how far points are from the way ahead, given from where it begins [m], shape (N,)."""
    along = np.array([cos(heading), sin(heading)])
    gone = (offset @ along).clip(0.0, AHEAD)
    away: Float = np.hypot(*(offset - gone[:, None] * along).T)
    return away


def _shown(start: Start) -> str:
    return start if isinstance(start, str) else f"{start.x:.2f} {start.y:.2f}"
