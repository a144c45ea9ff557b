"""The third dimension of a world: heights of walls, and solids that robots drive over or meet.

=========  ======================================================================================
module     contents
=========  ======================================================================================
relief     all that the third dimension adds to a map: heights of its walls, and solids
solids     the solids of a world file
shapes     the shapes that the solids of a world consist of, their outlines, keys of their tables
mesh_file  reads meshes: STL, binary or text, and the points and faces of OBJ
=========  ======================================================================================
"""

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
