"""The solids of a world file: steps, ramps, carpets, cylinders, tables, height fields, meshes.

Each is what one table of a world file says, in SI. Bodies with mass meet its parts; on a plane
there are only its walls, as if cut at the height of sensors. Where nothing else is said, `pose` is
its middle, `size` that along its x and y axes, and `z` the height of its foot.
"""

from dataclasses import dataclass
from functools import cached_property
from math import pi
from pathlib import Path
from typing import Annotated, ClassVar, Protocol

import numpy as np
from msgspec import Meta

from pioneer3.arrays import Float
from pioneer3.geometry import Pose2
from pioneer3.maps.image import read_image
from pioneer3.sim.relief.mesh_file import read_mesh, scaled
from pioneer3.sim.relief.shapes import (
    CENTER,
    FARTHEST,
    FILE,
    NONE,
    PLACED,
    Block,
    Elevation,
    Friction,
    Height,
    Hull,
    Size,
    Slope,
    SolidPart,
    Terrain,
    UprightCylinder,
    Wedge,
    outer,
    rectangle,
    ring,
)
from pioneer3.text import wrong

SENSOR_HEIGHT = 0.2
"""Where the plane cuts solids [m]: between the sonars of a P3-DX and of a P3-AT, below lasers."""
ROUND = 16
"""Sides of the polygon that a cylinder is on a plane."""
MOST_ROWS = 500
"""Most rows and columns of a height field; each cell costs time when a wheel is near."""
LEAST_VOLUME = 1e-9
"""A mesh with less has none [m3]."""
LEAST_THICKNESS = 0.001
"""Least thickness of a mesh [m]."""
LEAST_SHARE = 1e-6
"""Least share of thickness in a mesh's reach: MuJoCo keeps points in single precision."""


class Solid(Protocol):
    """Something that stands still and has a height."""

    table: ClassVar[str]
    """Its table in a world file."""
    is_ground: ClassVar[bool]
    """Whether robots drive over it or upon it: on a plane it is flat floor."""

    @property
    def pose(self) -> Pose2:
        """Where it is [m, rad]."""

    @property
    def z(self) -> float:
        """Height of its foot, or of the origin of a mesh [m]."""

    @property
    def parts(self) -> tuple[SolidPart, ...]:
        """Its shapes; ConfigError if its file cannot be read, or holds no solid."""

    @property
    def walls(self) -> Float:
        """The walls that it is on a plane [m], shape (S, 4)."""

    @property
    def outline(self) -> Float:
        """Its sides as seen from above [m], shape (S, 4)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class GroundSolid:
    """A rectangle that robots drive on: flat floor on a plane."""

    is_ground: ClassVar[bool] = True
    pose: Annotated[Pose2, PLACED]
    size: Size
    height: Slope
    z: Elevation = 0.0

    @property
    def parts(self) -> tuple[SolidPart, ...]:
        return (SolidPart("", Block(pose=self.pose, z=self.z, size=(*self.size, self.height))),)

    @property
    def walls(self) -> Float:
        return NONE

    @property
    def outline(self) -> Float:
        return rectangle(self.pose, self.size)


@dataclass(frozen=True, slots=True, kw_only=True)
class Step(GroundSolid):
    """A low block with a flat top: a door sill, a platform."""

    table: ClassVar[str] = "step"


@dataclass(frozen=True, slots=True, kw_only=True)
class Ramp(GroundSolid):
    """A wedge that rises along its own x axis, from its foot to `height`."""

    table: ClassVar[str] = "ramp"

    @property
    def parts(self) -> tuple[SolidPart, ...]:
        return (SolidPart("", Wedge(pose=self.pose, z=self.z, size=(*self.size, self.height))),)


@dataclass(frozen=True, slots=True, kw_only=True)
class Carpet(GroundSolid):
    """A part of the floor with a friction of its own, which holds for all that touches it.

    Attributes:
        friction: Coulomb's coefficient, of rubber on a short pile; an assumption.
        height: More than 4 mm, as deep as a P3-AT's tire sinks, else it would stand on the floor
            below [m].
    """

    table: ClassVar[str] = "carpet"
    friction: Friction = 0.8
    height: Annotated[float, Meta(ge=0.006, le=0.05)] = 0.008


@dataclass(frozen=True, slots=True, kw_only=True)
class Cylinder:
    """An upright column."""

    table: ClassVar[str] = "cylinder"
    is_ground: ClassVar[bool] = False
    pose: Annotated[Pose2, CENTER]
    radius: Annotated[float, Meta(ge=0.005, le=500)]
    height: Height
    z: Elevation = 0.0

    @property
    def parts(self) -> tuple[SolidPart, ...]:
        column = UprightCylinder(pose=self.pose, z=self.z, radius=self.radius, height=self.height)
        return (SolidPart("", column),)

    @property
    def walls(self) -> Float:
        """A regular polygon; none where it hangs above the sensors."""
        return self.outline if self.z < SENSOR_HEIGHT else NONE

    @property
    def outline(self) -> Float:
        angles = 2 * pi / ROUND * np.arange(ROUND)
        around = np.column_stack([np.cos(angles), np.sin(angles)])
        return ring(self.radius * around + (self.pose.x, self.pose.y))


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """A top on four square legs; with a back it is a chair, which faces along its own x axis.

    The upper side of the top is at `height`, from which the back rises [m]; 0 is none. The back is
    as thick as the legs.
    """

    table: ClassVar[str] = "table"
    is_ground: ClassVar[bool] = False
    pose: Annotated[Pose2, PLACED]
    size: Size
    height: Height
    thickness: Annotated[float, Meta(ge=0.002, le=1)] = 0.03
    leg_width: Annotated[float, Meta(ge=0.005, le=1)] = 0.05
    back: Annotated[float, Meta(ge=0, le=10)] = 0.0
    z: Elevation = 0.0

    @property
    def parts(self) -> tuple[SolidPart, ...]:
        """The top, four legs, and the back if there is one."""
        length, width = self.size
        below = self.height - self.thickness
        top = Block(pose=self.pose, z=self.z + below, size=(length, width, self.thickness))
        leg = (self.leg_width, self.leg_width, below)
        legs = [Block(pose=pose, z=self.z, size=leg) for pose in self.legs]
        found = [SolidPart("top", top)]
        found += [SolidPart(f"leg_{number}", block) for number, block in enumerate(legs)]
        if self.back > 0:
            rear = self.pose @ Pose2((self.leg_width - length) / 2, 0.0)
            size = (self.leg_width, width, self.back)
            found.append(SolidPart("back", Block(pose=rear, z=self.z + self.height, size=size)))
        return tuple(found)

    @property
    def legs(self) -> tuple[Pose2, ...]:
        """The middles of the legs [m, rad]."""
        x, y = ((side - self.leg_width) / 2 for side in self.size)
        return tuple(self.pose @ Pose2(*at) for at in ((-x, -y), (x, -y), (x, y), (-x, y)))

    @property
    def walls(self) -> Float:
        """The legs; the sides of a top that is as low as sensors."""
        if self.z >= SENSOR_HEIGHT:
            return NONE
        if self.z + self.height - self.thickness <= SENSOR_HEIGHT:
            return self.outline
        sides = (self.leg_width, self.leg_width)
        return np.concatenate([rectangle(leg, sides) for leg in self.legs])

    @property
    def outline(self) -> Float:
        return rectangle(self.pose, self.size)


@dataclass(frozen=True, kw_only=True)
class HeightField(GroundSolid):
    """A floor whose heights a picture seen from above tells, from black at `z` to white above it.

    Its file is read once: a world that runs does not change with it.
    """

    table: ClassVar[str] = "heightfield"
    file: Annotated[Path, FILE]

    @cached_property
    def parts(self) -> tuple[SolidPart, ...]:
        """One terrain; ConfigError for a picture that is damaged, too large, or of one shade."""
        shades = read_image(self.file).shades
        if max(shades.shape) > MOST_ROWS or min(shades.shape) < 2:
            rows, columns = shades.shape
            problem = f"is {columns} x {rows} pixels: expected 2 to {MOST_ROWS} a side"
            raise wrong(self.file, f" {problem}")
        if shades.min() == shades.max():
            raise wrong(self.file, " is of one shade: take a [[step]] for a flat floor")
        heights = shades[::-1].astype(np.float64) / 255
        size = (*self.size, self.height)
        return (SolidPart("", Terrain(pose=self.pose, z=self.z, size=size, heights=heights)),)


@dataclass(frozen=True, kw_only=True)
class Mesh:
    """A mesh of a file; what it touches meets its convex hull.

    Its file, STL or OBJ with z upwards, is read once: a world that runs does not change with it.
    The origin of the mesh is at `pose` and `z` [m]; the scale is that of the file's unit, 0.001 for
    millimetres.
    """

    table: ClassVar[str] = "mesh"
    is_ground: ClassVar[bool] = False
    file: Annotated[Path, FILE]
    pose: Annotated[Pose2, PLACED]
    z: Annotated[float, Meta(ge=-100.0, le=100.0)] = 0.0
    scale: Annotated[float, Meta(ge=1e-6, le=1e6)] = 1.0

    @cached_property
    def hull(self) -> Hull:
        """Hull of the mesh in the map frame.

        Raises:
            ConfigError: The file cannot be read, holds no volume, or is too large or too thin.
        """
        mesh = read_mesh(self.file)
        if mesh.reach * self.scale > FARTHEST:
            far = f"reaches farther than {FARTHEST / 1000:g} km from its origin"
            raise wrong(self.file, f" {far}: see key scale")
        triangles = scaled(mesh, self.scale)
        if abs(triangles.volume) < LEAST_VOLUME:
            raise wrong(self.file, " has no volume: close its surface, and see key scale")
        least = max(LEAST_THICKNESS, LEAST_SHARE * triangles.reach)
        if triangles.thickness < least:
            thin = f"is {triangles.thickness:.3g} m thick: expected {least:g} m or more"
            raise wrong(self.file, f" {thin}; see key scale")
        return Hull(pose=self.pose, z=self.z, triangles=triangles)

    @property
    def parts(self) -> tuple[SolidPart, ...]:
        return (SolidPart("", self.hull),)

    @property
    def walls(self) -> Float:
        """Its outline, if it is in the way of sensors; errors are those of :attr:`hull`."""
        z = self.hull.points[:, 2]
        return self.outline if z.min() <= SENSOR_HEIGHT <= z.max() else NONE

    @property
    def outline(self) -> Float:
        """The hull as seen from above; errors are those of :attr:`hull`."""
        return ring(outer(self.hull.points[:, :2]))


SOLIDS = (Step, Ramp, Carpet, Cylinder, Table, HeightField, Mesh)
"""The kinds of solids, in the order of their tables in a file."""
