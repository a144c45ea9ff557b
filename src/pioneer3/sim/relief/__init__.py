"""The third dimension of a world: heights of walls, and solids that robots drive over or meet."""

from pioneer3.sim.relief.relief import FLAT, WALL_HEIGHT, Relief
from pioneer3.sim.relief.solids import (
    SOLIDS,
    Carpet,
    Cylinder,
    HeightField,
    Mesh,
    Ramp,
    Solid,
    Step,
    Table,
)

__all__ = [
    "FLAT",
    "SOLIDS",
    "WALL_HEIGHT",
    "Carpet",
    "Cylinder",
    "HeightField",
    "Mesh",
    "Ramp",
    "Relief",
    "Solid",
    "Step",
    "Table",
]
