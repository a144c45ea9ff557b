"""Single rays, for tests and benchmarks: each is a robot's only transducer, at its pose."""

import numpy as np

from pioneer3.arrays import Float, Int32
from pioneer3.sim.kernels import Grid, Kernels, RobotArrays


def cast_rays(
    kernels: Kernels,
    grid: Grid,
    robots: RobotArrays,
    origins: Float,
    angles: Float,
    *,
    owner: Int32,
    limit: float,
) -> Float:
    """Return the range to the nearest wall or robot along each ray [m], shape (R,).

    Rays start at `origins` [m], shape (R, 2), at `angles` [rad], shape (R,), and end at `limit`
    [m]. `owner` is the robot that each of them does not see, or -1, shape (R,).
    """
    count = len(angles)
    ranges, poses = np.empty((count, 1)), np.concatenate([origins.T, angles[None]])
    ahead = np.array([[0.0, 0.0, 1.0, 0.0]]), np.array([0, 1], dtype=np.int32)
    mounts, walls = (*ahead, np.zeros(count, dtype=np.int32)), grid.arrays
    echoes = 0.0, 0.0
    kernels._sonar(
        0, count, limit, echoes, poses, owner, mounts, walls, walls, robots.arrays, ranges
    )
    return ranges[:, 0]
