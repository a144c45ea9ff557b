"""The shapes that the solids of a world consist of, their outlines, and the keys of their tables.

Shapes are frozen, in the map frame, in SI. Where nothing else is said, `pose` is the middle of the
foot of a shape, and `z` its height. Seen from above they are segments `x0, y0, x1, y1` [m], shape
(S, 4).
"""

from dataclasses import dataclass
from functools import cached_property
from math import cos, sin
from pathlib import Path
from typing import Annotated, Final

import numpy as np
from msgspec import Meta

from pioneer3.arrays import Float
from pioneer3.geometry import Pose2, wrap
from pioneer3.sim.relief.mesh_file import Triangles
from pioneer3.tables import FieldForm, degrees_of
from pioneer3.units import DEGREE

Size3 = tuple[float, float, float]
"""Length, width and height along the x, y and z axes of a shape [m]."""
FARTHEST = 1e5
"""Farthest coordinate in a world [m]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Block:
    """An upright cuboid."""

    pose: Pose2
    z: float
    size: Size3


@dataclass(frozen=True, slots=True, kw_only=True)
class Wedge:
    """Half a cuboid: its upper side rises along its own x axis."""

    pose: Pose2
    z: float
    size: Size3

    @property
    def corners(self) -> Float:
        """Its six corners in its own frame [m], shape (6, 3)."""
        x, y, height = self.size[0] / 2, self.size[1] / 2, self.size[2]
        foot = [(-x, -y, 0.0), (-x, y, 0.0), (x, -y, 0.0), (x, y, 0.0)]
        return np.array([*foot, (x, -y, height), (x, y, height)])


@dataclass(frozen=True, slots=True, kw_only=True)
class UprightCylinder:
    """An upright cylinder."""

    pose: Pose2
    z: float
    radius: float
    height: float


@dataclass(frozen=True, kw_only=True, eq=False)
class Hull:
    """The convex hull of a mesh, which has its origin at `pose` and `z`; compares by identity."""

    pose: Pose2
    z: float
    triangles: Triangles

    @cached_property
    def points(self) -> Float:
        """Its corners in the map frame [m], shape (P, 3)."""
        c, s = cos(self.pose.theta), sin(self.pose.theta)
        x, y, z = self.triangles.points.T
        return np.column_stack(
            [self.pose.x + c * x - s * y, self.pose.y + s * x + c * y, self.z + z]
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Terrain:
    """A floor of many heights, 0 to 1, on a grid (rows, columns); compares by identity.

    Columns go along the x axis, rows along the y axis; the third number of the size is the height
    of 1 above the foot [m].
    """

    pose: Pose2
    z: float
    size: Size3
    heights: Float


Shape = Block | Wedge | UprightCylinder | Hull | Terrain


@dataclass(frozen=True, slots=True)
class SolidPart:
    """One shape of a solid; its name is empty where the solid has only one."""

    name: str
    shape: Shape


NONE: Float = np.empty((0, 4))
MANY = 200
"""Points of which most are looked at all at once."""


def rectangle(pose: Pose2, size: tuple[float, float]) -> Float:
    """Return the sides of a rectangle around `pose` [m], shape (4, 4)."""
    half = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]) * size / 2
    return ring(placed(half, pose))


def placed(points: Float, pose: Pose2) -> Float:
    """Return points (P, 2) of the frame of a pose in that of the map [m]."""
    c, s = cos(pose.theta), sin(pose.theta)
    moved: Float = points @ np.array([(c, s), (-s, c)]) + (pose.x, pose.y)
    return moved


def ring(corners: Float) -> Float:
    """Return the sides between corners (C, 2) and from the last to the first, shape (C, 4)."""
    return np.concatenate([corners, np.roll(corners, -1, axis=0)], axis=1)


def outer(points: Float) -> Float:
    """Return the corners of the convex hull of `points` (P, 2), counter-clockwise, (C, 2)."""
    rounded = points.round(9)
    rounded = rounded[np.lexsort(rounded.T[::-1])]
    differs = (rounded[1:] != rounded[:-1]).any(axis=1)
    ordered = np.concatenate([rounded[:1], rounded[1:][differs]])
    lower, upper = (_chain(way) for way in (ordered, ordered[::-1]))
    return np.array(lower[:-1] + upper[:-1])


def _chain(points: Float) -> list[list[float]]:
    """Return the right-hand side of the hull on the way along sorted points."""
    while len(points) > MANY:
        # what is not on the right of the line between its neighbours is no corner
        (ax, ay), (bx, by), (cx, cy) = points[:-2].T, points[1:-1].T, points[2:].T
        turns = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax) > 0
        if turns.mean() > 0.9:
            break
        points = points[np.concatenate([[True], turns, [True]])]
    kept: list[list[float]] = []
    for x, y in points.tolist():
        while len(kept) > 1:
            (ax, ay), (bx, by) = kept[-2:]
            if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0:
                break
            kept.pop()
        kept.append([x, y])
    return kept


Coordinate = Annotated[float, Meta(ge=-FARTHEST, le=FARTHEST)]
Point = Annotated[tuple[Coordinate, Coordinate], Meta(extra={"expected": "two numbers"})]
Side = Annotated[float, Meta(ge=0.01, le=1000)]
Size = Annotated[tuple[Side, Side], Meta(extra={"expected": "two numbers"})]
Angle = Annotated[float, Meta(ge=-360, le=360)]
"""[deg]."""
Height = Annotated[float, Meta(ge=0.001, le=100)]
Slope = Annotated[float, Meta(ge=0.001, le=10)]
"""Height of a step or ramp [m]."""
Elevation = Annotated[float, Meta(ge=0, le=100)]
Friction = Annotated[float, Meta(ge=0.01, le=3)]


@dataclass(frozen=True, slots=True)
class _Center:
    """The keys of a place."""

    center: Point


@dataclass(frozen=True, slots=True)
class _Placed:
    """The keys of a pose."""

    center: Point
    theta_deg: Angle = 0.0


def pose_of(x: float, y: float, theta_deg: float) -> Pose2:
    """Return the pose that the keys of a table say."""
    return Pose2(x, y, wrap(theta_deg * DEGREE))


CENTER: Final = FieldForm(
    type=_Center,
    read=lambda table: Pose2(*table.center),
    write=lambda pose: _Center((pose.x, pose.y)),
    spread=True,
)
PLACED: Final = FieldForm(
    type=_Placed,
    read=lambda table: pose_of(table.center[0], table.center[1], table.theta_deg),
    write=lambda pose: _Placed((pose.x, pose.y), degrees_of(pose.theta)),
    spread=True,
)
FILE: Final = FieldForm("file", str, Path, Path.as_posix)
