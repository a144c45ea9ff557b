"""Ranges of lengths and angles in a world file, and the keys of poses."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Final

from msgspec import Meta

from pioneer3.geometry import Pose2, wrap
from pioneer3.sim.relief.shapes import FARTHEST
from pioneer3.tables import Key, degrees_of
from pioneer3.units import DEGREE

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


CENTER: Final = Key(
    type=_Center,
    read=lambda table: Pose2(*table.center),
    write=lambda pose: _Center((pose.x, pose.y)),
    spread=True,
)
PLACED: Final = Key(
    type=_Placed,
    read=lambda table: pose_of(table.center[0], table.center[1], table.theta_deg),
    write=lambda pose: _Placed((pose.x, pose.y), degrees_of(pose.theta)),
    spread=True,
)
FILE: Final = Key("file", str, Path, Path.as_posix)
