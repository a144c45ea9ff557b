"""Starts of robots: a home, a given pose, beside the map or anywhere; never in another robot."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from math import ceil, cos, hypot, pi, radians, sin, sqrt
from typing import NamedTuple

import numpy as np
from numpy.random import Generator

from pioneer3.arrays import Bool, Float
from pioneer3.errors import ConfigError
from pioneer3.geometry import ORIGIN, Pose2, wrap
from pioneer3.maps import LineMap
from pioneer3.models import RobotModel, load_model
from pioneer3.names import free_name
from pioneer3.sim.collision import overlap, turning_circle
from pioneer3.sim.equipment import Equipment
from pioneer3.sim.free_space import (
    Circle,
    FreePlaces,
    Obstructions,
    places_around,
    places_inside,
    places_on_plane,
)
from pioneer3.sim.worldfile import RobotSpec, WorldFile
from pioneer3.sim.worldfile.spec import Start

GAP = 0.1
"""Between the turning circles of robots where there is little room [m]."""
APART = 0.5
"""Distance between robots where there is enough room [m]."""
AHEAD = 1.2
"""Free way in front of every robot, up to a wall or another robot [m]."""
TURNS = tuple(radians(angle) for angle in (0, 90, -90, 180))
"""Turns away from the wanted heading, for headings without a free way."""
BESIDE = 0.5
"""Between robots that start outside the map [m]."""
CHUNK = 256
"""Number of places that are checked together."""
ROW = 8
"""Robots in a row beside a map without walls."""


class PlacementRequest(NamedTuple):
    """A robot that needs a place to start."""

    name: str
    model: RobotModel
    start: Start


class _Standing(NamedTuple):
    model: RobotModel
    pose: Pose2


def place_all(
    line_map: LineMap,
    requests: Sequence[PlacementRequest],
    rng: Generator,
    obstacles: Sequence[Float] = (),
) -> list[Pose2]:
    """Return the start of each of `requests`, in their order.

    Given poses are served first and random ones last, so that no random start takes a given one.
    `obstacles` are the sides of the convex polygons that stand there [m], shape (S, 4) each.

    Raises:
        ConfigError: There is no room left for one of them.
    """
    placer = Placer(line_map, rng, obstacles, expected=len(requests))
    order = ("home", "outside", "random")
    ranks = [order.index(n.start) + 1 if isinstance(n.start, str) else 0 for n in requests]
    found: dict[int, Pose2] = {}
    for index in sorted(range(len(requests)), key=ranks.__getitem__):
        found[index] = placer.place(requests[index])
    return [found[index] for index in range(len(requests))]


class Placer:
    """Finds a place for one robot after another.

    `obstacles` are the sides of the convex polygons that stand there [m], shape (S, 4) each. The
    number of robots expected in the end decides how far they spread on a map without walls.
    """

    def __init__(
        self,
        line_map: LineMap,
        rng: Generator,
        obstacles: Sequence[Float] = (),
        expected: int = 1,
    ) -> None:
        self._map, self._rng, self._expected = line_map, rng, expected
        self._obstructions = Obstructions.of(line_map, obstacles)
        self._standing: list[_Standing] = []
        self._homes_used = 0
        self._places_for: dict[tuple[float, Pose2 | None], tuple[FreePlaces, int]] = {}

    def occupy(self, model: RobotModel, pose: Pose2) -> None:
        """Note that a robot stands at `pose`."""
        self._standing.append(_Standing(model, pose))

    def place(self, request: PlacementRequest) -> Pose2:
        """Return the start of a robot, which occupies it from now on.

        A given pose is taken as it is, even in a wall; only if another robot stands there, the
        next free place is taken. The other starts are places where the robot can turn.

        Raises:
            ConfigError: There is no room left.
        """
        model, start = request.model, request.start
        match start:
            case "random":
                pose = self._anywhere(model)
            case "outside":
                pose = self._beside(model)
            case "home":
                homes = self._map.starts or (self._middle(),)
                home = homes[self._homes_used % len(homes)]
                self._homes_used += 1
                at = np.array([[home.x, home.y]])
                clear = self._clear_of_others(model, at, home.theta, 0.0).all()
                free = clear and self._fits(model, home)
                pose = home if free else self._near(model, home)
                if pose is None and self._is_open(model, home):
                    pose = self._beside(model)
            case Pose2():
                pose = start if self._misses_robots(model, start) else self._near(model, start)
        if pose is None:
            raise ConfigError(
                f"{request.name}: no room left for a {model.name} with start "
                f"{_shown(start)}; take fewer robots, a larger map or another start"
            )
        self.occupy(model, pose)
        return pose

    def _middle(self) -> Pose2:
        """Return the start on a map without any: the origin, or the middle if it is beside it.

        A wall alone surrounds nothing.
        """
        low, high = np.reshape(self._map.bounds, (2, 2))
        if self._within_map(np.zeros((1, 2))).all() or not (high > low).all():
            return ORIGIN
        x, y = ((low + high) / 2).tolist()
        return Pose2(x, y)

    def _is_open(self, model: RobotModel, start: Pose2) -> bool:
        """Whether a robot can leave the map from a start, as no walls are around it."""
        return not self._within_map(self._free_places(model, start).centres).all()

    def _near(self, model: RobotModel, wanted: Pose2) -> Pose2 | None:
        """Return the nearest place in reach of `wanted` where `model` can turn, else in the map.

        If there is room, it can also drive on from there, and keeps clear of others.
        """
        free = self._free_places(model, wanted)
        within = self._within_map(free.centres)
        for apart in (APART, GAP):
            for turn in TURNS:
                heading = wrap(wanted.theta + turn)
                roomy = within & free.has_way_ahead(heading, AHEAD)
                order = free.nearest_first(wanted.x, wanted.y, roomy)
                for x, y in self._apart(model, free.centres[order], heading, apart):
                    if self._has_way_ahead(model, pose := Pose2(x, y, heading)):
                        return pose
        for origin in (wanted, None):
            free = self._free_places(model, origin)
            for index in free.nearest_first(wanted.x, wanted.y):
                x, y = free.centres[index].tolist()
                if self._is_clear(model, x, y):
                    return Pose2(x, y, wanted.theta)
                free.open[index] = False
        return wanted if not self._standing else None

    def _anywhere(self, model: RobotModel) -> Pose2 | None:
        """Return a random pose inside the map."""
        free = self._free_places(model, None)
        heading = float(self._rng.uniform(-pi, pi))
        places = free.centres + self._rng.uniform(-0.5, 0.5, free.centres.shape) * free.cell
        order = self._rng.permutation(np.flatnonzero(free.open))
        roomy = order[free.has_way_ahead(heading, AHEAD)[order]]
        for x, y in self._apart(model, places[roomy], heading, APART):
            if self._has_way_ahead(model, pose := Pose2(x, y, heading)):
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
        return self._misses_robots(model, pose) and not self._obstructions.blocks(model, pose)

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
        return self._obstructions.clears(x, y, reach)

    def _within_map(self, places: Float) -> Bool:
        """Return which places are not beside the map, where it has walls, shape (N,)."""
        if not self._map.walls.size:
            return np.ones(len(places), dtype=np.bool_)
        low, high = np.reshape(self._map.bounds, (2, 2))
        x, y = ((places >= low) & (places <= high)).T
        within: Bool = x & y
        return within

    def _has_way_ahead(self, model: RobotModel, pose: Pose2) -> bool:
        """Whether `model` can turn at `pose`, and drive on from there."""
        return self._is_clear(model, pose.x, pose.y) and not self._obstructions.blocks(
            replace(model, length_front=model.length_front + AHEAD), pose
        )

    def _apart(
        self, model: RobotModel, places: Float, heading: float, apart: float
    ) -> Iterator[list[float]]:
        """Yield those of `places` [m], shape (N, 2), that are `apart` from all robots, in order."""
        for first in range(0, len(places), CHUNK):
            some = places[first : first + CHUNK]
            yield from some[self._clear_of_others(model, some, heading, apart)].tolist()

    def _clear_of_others(
        self, model: RobotModel, places: Float, heading: float, apart: float
    ) -> Bool:
        """Return the places where no robot has another one in its way, shape (N,)."""
        clear = np.ones(len(places), dtype=np.bool_)
        for other, there in self._standing:
            near = turning_circle(model) + turning_circle(other)
            offset = places - (there.x, there.y)
            clear &= np.hypot(*offset.T) >= near + apart
            clear &= _from_way(offset, there.theta) >= near
            clear &= _from_way(-offset, heading) >= near
        return clear

    def _free_places(self, model: RobotModel, origin: Pose2 | None) -> FreePlaces:
        """Return the free places around `origin`, or inside the map."""
        reach = turning_circle(model)
        free, done = self._places_for.get((reach, origin)) or (self._new_places(reach, origin), 0)
        free.close(
            Circle(there.x, there.y, reach + turning_circle(other) + GAP)
            for other, there in self._standing[done:]
        )
        self._places_for[reach, origin] = free, len(self._standing)
        return free

    def _new_places(self, reach: float, origin: Pose2 | None) -> FreePlaces:
        if not self._map.walls.size:
            far = (2 * reach + GAP) * ceil(sqrt(self._expected)) + 2 * reach
            return places_on_plane(self._obstructions, reach, origin or ORIGIN, far)
        if origin:
            return places_around(self._map, self._obstructions, reach, origin)
        return places_inside(self._map, self._obstructions, reach)


def _from_way(offset: Float, heading: float) -> Float:
    """Return the distance of points from the way ahead, which begins at (0, 0) [m], shape (N,)."""
    along = np.array([cos(heading), sin(heading)])
    gone = (offset @ along).clip(0.0, AHEAD)
    away: Float = np.hypot(*(offset - gone[:, None] * along).T)
    return away


def _shown(start: Start) -> str:
    return start if isinstance(start, str) else f"{start.x:.2f} {start.y:.2f}"


@dataclass(frozen=True, slots=True, kw_only=True)
class SpawnedRobot:
    """A robot at the beginning of a simulation.

    No two robots have the same name; port and host are as in :class:`RobotSpec`. One that is
    `in_the_way` starts in a wall or an obstacle, so it cannot move.
    """

    name: str
    model: RobotModel
    pose: Pose2
    equipment: Equipment
    port: int | None = None
    host: str = ""
    in_the_way: bool = False


def spawn_robots(world: WorldFile, line_map: LineMap, rng: Generator) -> tuple[SpawnedRobot, ...]:
    """Return the robots of `world` in their order, each at a start of its own.

    Raises:
        ConfigError: A model or a name is wrong, or there is no room for a robot.
    """
    load = cache(load_model)
    models = [robot.equipment.model_with(load(robot.model)) for robot in world.robots]
    names = assign_names(world.robots, models)
    obstacles = obstacle_outlines(world)
    requests = [
        PlacementRequest(name, model, robot.start)
        for name, model, robot in zip(names, models, world.robots, strict=True)
    ]
    poses = place_all(line_map, requests, rng, obstacles)
    obstructions = Obstructions.of(line_map, obstacles)
    return tuple(
        SpawnedRobot(
            name=name,
            model=model,
            pose=pose,
            equipment=robot.equipment.equipment_of(model),
            port=robot.port,
            host=robot.host,
            in_the_way=obstructions.blocks(model, pose),
        )
        for name, model, pose, robot in zip(names, models, poses, world.robots, strict=True)
    )


def obstacle_outlines(world: WorldFile) -> list[Float]:
    """Return the sides of each box and person at the beginning that may move [m]."""
    boxes = [box.outline for box in world.movable]
    return boxes + [person.outline_at(0.0) for person in world.people]


def assign_names(robots: Sequence[RobotSpec], models: Sequence[RobotModel]) -> list[str]:
    """Return a name for each robot: its own, or its model's, numbered; ConfigError for doubles."""
    given = Counter(robot.name for robot in robots if robot.name)
    for name, count in given.items():
        if count > 1:
            raise ConfigError(f"robot {name}: {count} robots have this name; give each its own")
    names, used = [], set(given)
    for robot, model in zip(robots, models, strict=True):
        name = robot.name or free_name(model.name, used, "-")
        used.add(name)
        names.append(name)
    return names
