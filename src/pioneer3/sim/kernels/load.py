"""Which implementation to run."""

from importlib.util import find_spec
from typing import Literal

import numpy as np

from pioneer3.errors import ConfigError, how_to_get
from pioneer3.sim.kernels.base import Kernels
from pioneer3.sim.kernels.cache import tell_ready
from pioneer3.sim.kernels.drives import Drives
from pioneer3.sim.kernels.mounts import laser_fan, sonar_mounts
from pioneer3.sim.kernels.numpy_kernels import NumpyKernels
from pioneer3.sim.kernels.robots import Robots
from pioneer3.sim.kernels.walls import build_grid


def load_kernels(
    prefer: Literal["numba", "numpy"] | None = None, *, threads: int = 1, warm: bool = True
) -> Kernels:
    """Return the kernels to simulate with: numba's where it is installed, else numpy's.

    Args:
        prefer: One of the two; `None` takes the fastest there is.
        threads: That share the work of 50 robots and more; numba only.
        warm: Compile now, which takes seconds the first time ever and half a second later; else
            the first call of each kernel does. Another thread may well do it: it holds the GIL
            for most of the time, but lets others run in between.

    Raises:
        ConfigError: numba was asked for and is missing.
    """
    if prefer == "numpy" or (prefer is None and find_spec("numba") is None):
        return NumpyKernels()
    try:
        from pioneer3.sim.kernels.numba_kernels import NumbaKernels  # noqa: PLC0415
    except ImportError as error:
        if prefer is None:
            return NumpyKernels()
        raise ConfigError(
            f"kernels: numba was asked for but cannot be imported ({error}): {how_to_get('fast')}"
        ) from error
    kernels = NumbaKernels(threads)
    if warm:
        warm_up(kernels)
        tell_ready()
    return kernels


def warm_up(kernels: Kernels) -> None:
    """Call every kernel once in a tiny world, so that later calls find it compiled."""
    grid = build_grid(np.array([[1.0, -1.0, 1.0, 1.0]]))
    size = np.array([0.2])
    robots = Robots(size, size, size)
    kernels.place(robots)
    kernels.sonar(grid, robots, sonar_mounts([np.zeros((1, 3))], [0]), 2.0)
    kernels.cast_fans(grid, robots, laser_fan((0.0, 0.0, 0.0), 0.0, 1.0, 1), 2.0)
    kernels.blocked(grid, robots, robots.poses)
    drives = Drives.at_rest(1)
    for noise in (None, np.zeros((3, 1))):
        kernels.step(grid, robots, drives, 0.1, noise)
