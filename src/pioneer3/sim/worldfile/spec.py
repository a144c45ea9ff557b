"""The contents of a world file: map, robots, boxes, walls, places, people; frozen, in SI."""

from dataclasses import dataclass
from itertools import pairwise
from math import cos, sin
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap, MapObject, empty_map, read_map, shipped_map
from pioneer3.maps.line_map import solid_walls
from pioneer3.maps.materials import Codes, Material, codes_of
from pioneer3.sim.equipment import NO_OPTIONS, EquipmentOptions
from pioneer3.sim.worldfile.person import Person, Point

Float = NDArray[np.float64]
Start = Pose2 | Literal["random", "outside", "home"]
"""A pose in the map, somewhere free inside the map, beside the map, or a home of the map."""

FARTHEST = 1e5
"""Of a coordinate [m]."""
BOX_KIND = "Sim.BoxObstacle"
Physics = Literal["planar", "mujoco"]
"""How robots move: on a plane, by numbers for slip; or with mass, motors and tires, by MuJoCo."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotSpec:
    """A robot of a world.

    Attributes:
        model: A model's name, or the path of its file.
        name: For people; empty for its model's name. To programs the robot is `MobileSim`, by
            which ARIA knows a simulator (protocol.md 2.6). One that has a laser with a port of
            its own tells its own name.
        start: Its place at the beginning.
        port: TCP port; `None` for the next one, 0 for a free one.
        host: Address of this machine to listen at; empty for that of all robots.
        equipment: Its accessories.
    """

    model: str = "p3at-sh"
    name: str = ""
    start: Start = "home"
    port: int | None = None
    host: str = ""
    equipment: EquipmentOptions = NO_OPTIONS


@dataclass(frozen=True, slots=True, kw_only=True)
class Box:
    """A box on the floor.

    Attributes:
        pose: Its middle.
        size: Length along its x axis, width along its y axis [m].
        movable: People and programs may move it, so it is not a wall of the map.
        name: On screen.
        material: Of its sides.
    """

    pose: Pose2
    size: tuple[float, float]
    movable: bool = False
    name: str = ""
    material: Material = Material.PLAIN

    @property
    def corners(self) -> tuple[Point, ...]:
        """The four corners, in order [m]."""
        c, s = cos(self.pose.theta), sin(self.pose.theta)
        length, width = self.size[0] / 2, self.size[1] / 2
        around = ((-length, -width), (length, -width), (length, width), (-length, width))
        return tuple((self.pose.x + c * x - s * y, self.pose.y + s * x + c * y) for x, y in around)

    @property
    def outline(self) -> Float:
        """The four sides [m], shape (4, 4)."""
        return solid_walls([self.as_object()])

    def as_object(self) -> MapObject:
        """Return it as an object of a map, solid."""
        return MapObject(
            kind=BOX_KIND, name=self.name, pose=self.pose, outline=self.corners, solid=True
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Wall:
    """A wall of some material along points `(x, y)` [m]; if `closed`, back to the first."""

    points: tuple[Point, ...]
    closed: bool = False
    material: Material = Material.PLAIN

    @property
    def segments(self) -> Float:
        """Its segments [m], shape (S, 4)."""
        corners = self.points + (self.points[:1] if self.closed else ())
        return np.array([(*a, *b) for a, b in pairwise(corners)])


@dataclass(frozen=True, slots=True, kw_only=True)
class Place:
    """A named pose: `kind` is ARIA's type, such as Goal, GoalWithHeading, Dock or RobotHome."""

    kind: str
    pose: Pose2
    name: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class WorldFile:
    """A map with robots, boxes, walls, places and people.

    Attributes:
        name: On screen.
        map: A shipped map's name, `empty`, or the path of a map file.
        seed: Of all random numbers; `None` for another one each time.
        keep_session: Whether a program that vanishes from the network leaves its session behind, as
            on a serial line.
        physics: How robots and boxes move.
        robots: In file order.
        boxes: In file order; only the fixed ones become walls.
        walls: In addition to the map's.
        places: In addition to the map's.
        people: In file order.
    """

    name: str
    map: str | Path = "empty"
    seed: int | None = None
    keep_session: bool = False
    physics: Physics = "planar"
    robots: tuple[RobotSpec, ...] = ()
    boxes: tuple[Box, ...] = ()
    walls: tuple[Wall, ...] = ()
    places: tuple[Place, ...] = ()
    people: tuple[Person, ...] = ()

    def base_map(self) -> LineMap:
        """Return the map that the world builds on.

        Raises:
            ConfigError: It cannot be read.
        """
        if self.map == "empty":
            return empty_map()
        return read_map(self.map) if isinstance(self.map, Path) else shipped_map(self.map)

    def line_map(self) -> LineMap:
        """Return all fixed parts: the map, walls, boxes, homes and places.

        Movable boxes and people are left out: they are :attr:`boxes` and :attr:`people`.

        Raises:
            ConfigError: The map cannot be read.
        """
        base = self.base_map()
        fixed = tuple(box.as_object() for box in self.boxes if not box.movable)
        places = tuple(MapObject(kind=p.kind, name=p.name, pose=p.pose) for p in self.places)
        added = [*(wall.segments for wall in self.walls), solid_walls(fixed)]
        homes = tuple(place.pose for place in self.places if place.kind == "RobotHome")
        return LineMap(
            name=self.name,
            walls=np.concatenate([base.walls, *added]),
            homes=homes + base.homes,
            objects=base.objects + places + fixed,
            grids=base.grids,
            lines=np.concatenate([base.lines, *added]),
            materials=np.concatenate([base.materials, self._materials()]),
        )

    def _materials(self) -> Codes:
        """Return the materials of the segments that :meth:`line_map` adds, in its order."""
        walls = [wall.material for wall in self.walls for _ in wall.segments]
        fixed = [box for box in self.boxes if not box.movable]
        return codes_of(walls + [box.material for box in fixed for _ in box.corners])

    @property
    def movable(self) -> tuple[Box, ...]:
        """The boxes that can be moved."""
        return tuple(box for box in self.boxes if box.movable)
