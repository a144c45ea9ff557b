"""The simulator's inner loops: motion, rays, fans and footprints of all robots at once."""

from pioneer3.sim.kernels.drives import Drives
from pioneer3.sim.kernels.echoes import Echoes, find_edges
from pioneer3.sim.kernels.kernels import (
    CACHE,
    WORTH_COMPILING,
    WORTH_THREADS,
    Kernels,
    compiled_kernels,
)
from pioneer3.sim.kernels.mounts import Fan, Mounts, laser_fan, sonar_mounts
from pioneer3.sim.kernels.robots import Robots
from pioneer3.sim.kernels.walls import Grid, build_grid

__all__ = [
    "CACHE",
    "WORTH_COMPILING",
    "WORTH_THREADS",
    "Drives",
    "Echoes",
    "Fan",
    "Grid",
    "Kernels",
    "Mounts",
    "Robots",
    "build_grid",
    "compiled_kernels",
    "find_edges",
    "laser_fan",
    "sonar_mounts",
]
