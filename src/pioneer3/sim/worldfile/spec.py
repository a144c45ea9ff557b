"""The contents of a world file: map, robots, solids, places and people; frozen, in SI."""

from collections import Counter
from dataclasses import dataclass, field, replace
from itertools import pairwise
from math import cos, sin
from pathlib import Path
from typing import Annotated, ClassVar, Literal

import numpy as np
from msgspec import Meta

from pioneer3.arrays import Float
from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap, MapObject, empty_map, read_map, shipped_map
from pioneer3.maps.line_map import solid_walls
from pioneer3.maps.materials import Codes, Material, codes_of
from pioneer3.sim.equipment import NO_OPTIONS, EquipmentOptions
from pioneer3.sim.relief import SOLIDS, WALL_HEIGHT, Relief, Solid
from pioneer3.sim.relief.shapes import (
    PLACED,
    Angle,
    Block,
    Coordinate,
    Elevation,
    Friction,
    Height,
    Point,
    Size,
    SolidPart,
    pose_of,
)
from pioneer3.sim.relief.solids import SENSOR_HEIGHT
from pioneer3.sim.worldfile.person import Person
from pioneer3.tables import FieldForm, degrees_of

Start = Pose2 | Literal["random", "outside", "home"]
"""A pose in the map, somewhere free inside the map, beside the map, or a home of the map."""

BOX_KIND = "Sim.BoxObstacle"
BOX_HEIGHT = 0.5
"""Height of a movable box of which nothing is said [m]; an assumption."""
BOX_MASS = 5.0
"""Mass of such a box [kg]; an assumption."""
BOX_FRICTION = 0.4
"""Friction of such a box; an assumption."""
PHYSICS_STEP = 0.002
"""Step of physics [s]."""
Physics = Literal["planar", "mujoco"]
"""How robots move: on a plane, by numbers for slip; or with mass, motors and tires, by MuJoCo."""


@dataclass(frozen=True, slots=True)
class _At:
    """The pose that a robot starts at, in a file."""

    x: Coordinate
    y: Coordinate
    theta_deg: Angle = 0.0


_START = FieldForm(
    "start",
    Annotated[
        _At | Literal["random", "outside", "home"],
        Meta(extra={"expected": '{x, y, theta_deg} or "random" or "outside" or "home"'}),
    ],
    lambda at: pose_of(at.x, at.y, at.theta_deg) if isinstance(at, _At) else at,
    lambda start: (
        _At(start.x, start.y, degrees_of(start.theta)) if isinstance(start, Pose2) else start
    ),
)
_STEP = FieldForm(
    "physics_step_ms",
    Annotated[float, Meta(ge=0.5, le=2.5)],
    lambda milliseconds: round(milliseconds / 1000, 9),
    lambda seconds: round(seconds * 1000, 6),
)
_IN_NO_FILE = FieldForm()


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotSpec:
    """A robot of a world: its model's name or file, and its place on the network.

    Its name is for people; to programs it is `MobileSim`, by which ARIA knows a simulator
    (protocol.md 2.6), unless it has a laser with a port of its own. A TCP port of `None` is the
    next one, 0 a free one; an empty host is that of all robots.
    """

    model: str = "p3at-sh"
    name: str = ""
    start: Annotated[Start, _START] = "home"
    port: Annotated[int, Meta(ge=1, le=65535)] | None = None
    host: Annotated[str, _IN_NO_FILE] = ""
    equipment: EquipmentOptions = NO_OPTIONS


@dataclass(frozen=True, slots=True, kw_only=True)
class Box:
    """A box: size along its x and y axis, height, and that of its foot [m].

    If it is movable, people and programs may move it, so it is not a wall of the map: then it has a
    mass [kg] and friction. A height of `None` is :data:`BOX_HEIGHT` then, else that of walls.
    """

    table: ClassVar[str] = "box"
    is_ground: ClassVar[bool] = False
    pose: Annotated[Pose2, PLACED]
    size: Size
    movable: bool = False
    name: str = ""
    material: Material = Material.PLAIN
    height: Height | None = None
    z: Elevation = 0.0
    mass: Annotated[float, Meta(ge=0.01, le=1000)] = BOX_MASS
    friction: Friction = BOX_FRICTION

    @property
    def block(self) -> Block:
        """Its shape."""
        usual = BOX_HEIGHT if self.movable else WALL_HEIGHT
        height = usual if self.height is None else self.height
        return Block(pose=self.pose, z=self.z, size=(*self.size, height))

    @property
    def parts(self) -> tuple[SolidPart, ...]:
        """One block."""
        return (SolidPart("", self.block),)

    @property
    def walls(self) -> Float:
        """Its sides, if it stands still and does not hang above the sensors."""
        return self.outline if self.is_wall else np.empty((0, 4))

    @property
    def is_wall(self) -> bool:
        """Whether its sides are walls of the map."""
        return not self.movable and self.z < SENSOR_HEIGHT

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
    """A wall of some material along points `(x, y)` [m]; if `closed`, back to the first.

    Its height [m] is the world's where none is given.
    """

    points: Annotated[
        tuple[Point, ...],
        Meta(min_length=2, extra={"expected": "a list of 2 or more points [x, y]"}),
    ]
    closed: bool = False
    material: Material = Material.PLAIN
    height: Height | None = None

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
    """A map with robots, boxes, walls, solids, places and people, in file order.

    Attributes:
        map: A shipped map's name, `empty`, the path of a map file, or the map itself.
        seed: Of all random numbers; `None` for another one each time.
        keep_session: Whether a program that vanishes from the network leaves its session behind, as
            on a serial line.
        physics_step: Of MuJoCo [s].
        wall_height: Of walls of which nothing else is said [m].
        solids: By kind in the order of :data:`~pioneer3.sim.relief.SOLIDS`.
        source: Its file, for messages; empty without.
    """

    name: str
    map: Annotated[str | Path | LineMap, FieldForm("map", str)] = "empty"
    seed: Annotated[int, Meta(ge=0, le=2**63 - 1)] | None = None
    keep_session: bool = False
    physics: Physics = "planar"
    physics_step: Annotated[float, _STEP] = PHYSICS_STEP
    wall_height: Height = WALL_HEIGHT
    robots: Annotated[tuple[RobotSpec, ...], _IN_NO_FILE] = ()
    boxes: Annotated[tuple[Box, ...], _IN_NO_FILE] = ()
    walls: Annotated[tuple[Wall, ...], _IN_NO_FILE] = ()
    places: Annotated[tuple[Place, ...], _IN_NO_FILE] = ()
    people: Annotated[tuple[Person, ...], _IN_NO_FILE] = ()
    solids: Annotated[tuple[Solid, ...], _IN_NO_FILE] = ()
    source: Annotated[str, _IN_NO_FILE] = field(default="", compare=False)

    def __post_init__(self) -> None:
        """Sort the solids as a file has them."""
        kinds = [kind.table for kind in SOLIDS]
        ordered = sorted(self.solids, key=lambda solid: kinds.index(solid.table))
        object.__setattr__(self, "solids", tuple(ordered))

    def base_map(self) -> LineMap:
        """Return the map that the world builds on."""
        if isinstance(self.map, LineMap):
            return self.map
        if self.map == "empty":
            return empty_map()
        if isinstance(self.map, Path):
            return replace(read_map(self.map), file=self.map)
        return shipped_map(self.map)

    def line_map(self) -> LineMap:
        """Return all fixed parts on a plane: the map, walls, boxes, solids, homes and places.

        Movable boxes and people are left out: they are :attr:`boxes` and :attr:`people`.

        Raises:
            ConfigError: The map or the file of a solid cannot be read.
        """
        base = self.base_map()
        fixed = tuple(box.as_object() for box in self._fixed)
        places = tuple(MapObject(kind=p.kind, name=p.name, pose=p.pose) for p in self.places)
        added = [*(wall.segments for wall in self.walls), solid_walls(fixed)]
        added += [solid.walls for solid in self.solids]
        homes = tuple(place.pose for place in self.places if place.kind == "RobotHome")
        walls = np.concatenate([base.walls, *added])
        materials = np.zeros(len(walls), dtype=np.uint8)
        own = self._materials()
        materials[: len(base.walls)] = base.materials
        materials[len(base.walls) : len(base.walls) + len(own)] = own
        return LineMap(
            name=self.name,
            walls=walls,
            homes=homes + base.homes,
            objects=base.objects + places + fixed,
            grids=base.grids,
            lines=np.concatenate([base.lines, *added]),
            materials=materials,
            file=base.file if not (self.walls or fixed or self.solids or places) else None,
        )

    def relief(self, line_map: LineMap) -> Relief:
        """Return the heights of all that stands still; files of solids are not needed later."""
        heights = [self._height(wall.height) for wall in self.walls for _ in wall.segments]
        # a box on the floor is four walls around a block, as walls have materials
        for box in self._fixed:
            heights += [0.0 if box.z > 0 else self._height(box.height)] * len(box.outline)
        heights += [0.0] * sum(len(solid.walls) for solid in self.solids)
        base = [self.wall_height] * (len(line_map.walls) - len(heights))
        solids: dict[str, Solid] = {
            f"box_{number}": replace(box, height=self._height(box.height))
            for number, box in enumerate(self.boxes)
            if not box.movable
        }
        counts = Counter[str]()
        for solid in self.solids:
            _ = solid.parts  # reads its file, if it has one
            solids[f"{solid.table}_{counts[solid.table]}"] = solid
            counts[solid.table] += 1
        return Relief(
            wall_height=self.wall_height,
            heights=np.array(base + heights, dtype=np.float64),
            solids=solids,
            origin=self,
        )

    def _height(self, own: float | None) -> float:
        return self.wall_height if own is None else own

    @property
    def _fixed(self) -> tuple[Box, ...]:
        """The boxes whose sides are walls."""
        return tuple(box for box in self.boxes if box.is_wall)

    def _materials(self) -> Codes:
        """Return the materials of the walls and boxes that :meth:`line_map` adds, in its order."""
        walls = [wall.material for wall in self.walls for _ in wall.segments]
        return codes_of(walls + [box.material for box in self._fixed for _ in box.corners])

    @property
    def movable(self) -> tuple[Box, ...]:
        """The boxes that can be moved."""
        return tuple(box for box in self.boxes if box.movable)
