"""The simulator's inner loops: motion, rays, fans and footprints of all robots at once.

========  ====================================================================================
module    contents
========  ====================================================================================
kernels   motion, rays, fans and collisions of all robots at once. Arrays in, arrays out
fans      laser fans: near segments rasterised onto the beams, the nearest one wins
spots     spots of a laser: the reading that three rays give, and its errors
rays      sonar and single rays: from cell to cell through the grid
motion    drives, and what stops them
robots    all that moves, as arrays, and its sensors: where rays start and where they point
echoes    echoes of walls
walls     walls sorted once into the cells of a uniform grid, as arrays that a kernel can walk
drives    the drives of many robots as arrays, and the numbers that their motion goes by
__main__  compiles the kernels and keeps the result: `python -m pioneer3.sim.kernels`
========  ====================================================================================
"""

from pioneer3.sim.kernels.drives import DriveArrays
from pioneer3.sim.kernels.echoes import Reflectors, find_edges
from pioneer3.sim.kernels.kernels import (
    CACHE,
    WORTH_COMPILING,
    WORTH_THREADS,
    Kernels,
    compiled_kernels,
)
from pioneer3.sim.kernels.robots import Fan, Mounts, RobotArrays, laser_fan, sonar_mounts
from pioneer3.sim.kernels.walls import Grid, build_grid

__all__ = [
    "CACHE",
    "WORTH_COMPILING",
    "WORTH_THREADS",
    "DriveArrays",
    "Fan",
    "Grid",
    "Kernels",
    "Mounts",
    "Reflectors",
    "RobotArrays",
    "build_grid",
    "compiled_kernels",
    "find_edges",
    "laser_fan",
    "sonar_mounts",
]
