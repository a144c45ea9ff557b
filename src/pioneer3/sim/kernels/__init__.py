"""The fast heart of the simulator: rays, fans and footprints, by numba or by numpy alone."""

from pioneer3.sim.kernels.base import Kernels
from pioneer3.sim.kernels.drives import Drives
from pioneer3.sim.kernels.echoes import Echoes
from pioneer3.sim.kernels.edges import find_edges
from pioneer3.sim.kernels.load import load_kernels, warm_up
from pioneer3.sim.kernels.mounts import Fan, Mounts, laser_fan, sonar_mounts
from pioneer3.sim.kernels.robots import Robots
from pioneer3.sim.kernels.walls import Grid, build_grid

__all__ = [
    "Drives",
    "Echoes",
    "Fan",
    "Grid",
    "Kernels",
    "Mounts",
    "Robots",
    "build_grid",
    "find_edges",
    "laser_fan",
    "load_kernels",
    "sonar_mounts",
    "warm_up",
]
