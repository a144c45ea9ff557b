"""The tables of solids: keys, ranges and defaults.

Their fields have the names of the attributes of the objects in :mod:`pioneer3.sim.relief.solids`.
"""

from pathlib import Path
from typing import Annotated, Any, ClassVar, Self

from msgspec import Meta
from msgspec.structs import asdict

from pioneer3.sim.relief import (
    Carpet,
    Cylinder,
    HeightField,
    Mesh,
    Ramp,
    Solid,
    Step,
    Table,
)
from pioneer3.sim.relief.solids import (
    CARPET_FRICTION,
    CARPET_HEIGHT,
    LEG_WIDTH,
    TOP_THICKNESS,
)
from pioneer3.sim.worldfile.table import (
    Angle,
    Elevation,
    Friction,
    Height,
    Point,
    Size,
    degrees_of,
    pose_of,
)
from pioneer3.sim.worldfile.table import Table as FileTable

Slope = Annotated[float, Meta(ge=0.001, le=10)]
"""Height of a step or ramp [m]."""


class SolidTable(FileTable):
    """Any solid."""

    kind: ClassVar[type[Any]]

    def solid(self, folder: Path) -> Solid:
        """Return the solid; its file is seen from `folder`."""
        values = asdict(self)
        x, y = values.pop("center")
        values["pose"] = pose_of(x, y, values.pop("theta_deg", 0.0))
        if "file" in values:
            values["file"] = folder / values["file"]
        solid: Solid = self.kind(**values)
        return solid

    @classmethod
    def of(cls, solid: Solid, **changed: Any) -> Self:
        """Return the table of a solid."""
        if "theta_deg" in cls.__struct_fields__:
            changed["theta_deg"] = degrees_of(solid.pose.theta)
        return cls.like(solid, center=(solid.pose.x, solid.pose.y), **changed)


class StepTable(SolidTable):
    """`[[step]]`."""

    kind = Step
    center: Point
    size: Size
    height: Slope
    theta_deg: Angle = 0.0
    z: Elevation = 0.0


class RampTable(SolidTable):
    """`[[ramp]]`."""

    kind = Ramp
    center: Point
    size: Size
    height: Slope
    theta_deg: Angle = 0.0
    z: Elevation = 0.0


class CarpetTable(SolidTable):
    """`[[carpet]]`."""

    kind = Carpet
    center: Point
    size: Size
    theta_deg: Angle = 0.0
    friction: Friction = CARPET_FRICTION
    height: Annotated[float, Meta(ge=0.006, le=0.05)] = CARPET_HEIGHT
    z: Elevation = 0.0


class CylinderTable(SolidTable):
    """`[[cylinder]]`."""

    kind = Cylinder
    center: Point
    radius: Annotated[float, Meta(ge=0.005, le=500)]
    height: Height
    z: Elevation = 0.0


class TableTable(SolidTable):
    """`[[table]]`."""

    kind = Table
    center: Point
    size: Size
    height: Height
    theta_deg: Angle = 0.0
    thickness: Annotated[float, Meta(ge=0.002, le=1)] = TOP_THICKNESS
    leg_width: Annotated[float, Meta(ge=0.005, le=1)] = LEG_WIDTH
    back: Annotated[float, Meta(ge=0, le=10)] = 0.0
    z: Elevation = 0.0


class HeightFieldTable(SolidTable):
    """`[[heightfield]]`."""

    kind = HeightField
    file: str
    center: Point
    size: Size
    height: Slope
    theta_deg: Angle = 0.0
    z: Elevation = 0.0


class MeshTable(SolidTable):
    """`[[mesh]]`."""

    kind = Mesh
    file: str
    center: Point
    z: Annotated[float, Meta(ge=-100.0, le=100.0)] = 0.0
    theta_deg: Angle = 0.0
    scale: Annotated[float, Meta(ge=1e-6, le=1e6)] = 1.0


TABLES: tuple[type[SolidTable], ...] = (
    StepTable,
    RampTable,
    CarpetTable,
    CylinderTable,
    TableTable,
    HeightFieldTable,
    MeshTable,
)
"""In the order of :data:`pioneer3.sim.relief.SOLIDS`."""
