"""Ranges of numbers and angles in degrees, for all tables of a world file."""

from math import degrees
from typing import Annotated, Any, Self

from msgspec import Meta, Struct

from pioneer3.geometry import Pose2, wrap
from pioneer3.sim.relief.shapes import FARTHEST
from pioneer3.units import DEGREE

Coordinate = Annotated[float, Meta(ge=-FARTHEST, le=FARTHEST)]
Point = Annotated[tuple[Coordinate, Coordinate], Meta(extra={"expected": "two numbers"})]
Side = Annotated[float, Meta(ge=0.01, le=1000)]
Size = Annotated[tuple[Side, Side], Meta(extra={"expected": "two numbers"})]
Angle = Annotated[float, Meta(ge=-360, le=360)]
Height = Annotated[float, Meta(ge=0.001, le=100)]
Elevation = Annotated[float, Meta(ge=0, le=100)]
Friction = Annotated[float, Meta(ge=0.01, le=3)]


class Table(Struct, forbid_unknown_fields=True, omit_defaults=True, kw_only=True):
    """Any table: unknown keys are refused, defaults are not written."""

    @classmethod
    def like(cls, item: object, **changed: Any) -> Self:
        """Return the table of an object: its attributes, except for those `changed`."""
        names = [name for name in cls.__struct_fields__ if name not in changed]
        return cls(**{name: getattr(item, name) for name in names}, **changed)


def pose_of(x: float, y: float, theta_deg: float) -> Pose2:
    """Return the pose that the keys of a table say."""
    return Pose2(x, y, wrap(theta_deg * DEGREE))


def degrees_of(angle: float) -> float:
    """Return an angle as a file has it."""
    return round(degrees(angle), 12)
