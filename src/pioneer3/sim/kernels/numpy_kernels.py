"""The kernels with numpy alone: always there; what a robot's small computer runs."""

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.kernels.drives import Drives
from pioneer3.sim.kernels.echoes import ALL, Echoes
from pioneer3.sim.kernels.mounts import Fan, Mounts
from pioneer3.sim.kernels.near import near_robots
from pioneer3.sim.kernels.numpy_around import TOGETHER, Around
from pioneer3.sim.kernels.numpy_fans import paint
from pioneer3.sim.kernels.numpy_frames import frames_of
from pioneer3.sim.kernels.numpy_march import march, meet_robots
from pioneer3.sim.kernels.numpy_outlines import place
from pioneer3.sim.kernels.numpy_sonar import Sonar
from pioneer3.sim.kernels.numpy_stepping import Stepping
from pioneer3.sim.kernels.robots import Robots
from pioneer3.sim.kernels.walls import Grid

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]
Int32 = NDArray[np.int32]


class NumpyKernels:
    """Same contract as `Kernels`."""

    name = "numpy"

    def __init__(self) -> None:
        self._around = Around()
        self._sonar, self._stepping = Sonar(self._around), Stepping(self._around)

    def place(self, robots: Robots) -> None:
        place(robots)

    def cast_rays(
        self,
        grid: Grid,
        robots: Robots,
        origins: Float,
        angles: Float,
        *,
        owner: Int32,
        limit: float,
        out: Float | None = None,
    ) -> Float:
        ranges = np.empty(len(angles)) if out is None else out
        march(grid, origins, angles, limit, ranges)
        pairs = near_robots(robots, origins[:, 0], origins[:, 1], limit, owner)
        meet_robots(robots, pairs, origins, angles, ranges)
        return ranges

    def sonar(
        self,
        grid: Grid,
        robots: Robots,
        mounts: Mounts,
        limit: float,
        *,
        echoes: Echoes = ALL,
        owners: Int32 | None = None,
        out: Float | None = None,
    ) -> Float:
        return self._sonar.measure(
            grid, robots, mounts, limit, echoes=echoes, owners=owners, out=out
        )

    def cast_fans(
        self,
        grid: Grid,
        robots: Robots,
        fan: Fan,
        limit: float,
        *,
        owners: Int32 | None = None,
        out: Float | None = None,
    ) -> Float:
        lasers = robots.everyone if owners is None else owners
        ranges = np.empty((len(lasers), fan.headings.shape[1])) if out is None else out
        x, y, theta = robots.poses.take(lasers, axis=1)
        c, s = np.cos(theta), np.sin(theta)
        mx, my, turned = fan.frame[:3]
        frames = frames_of(x + c * mx - s * my, y + s * mx + c * my, theta + turned)
        with np.errstate(divide="ignore"):
            ranges[:] = np.divide(1.0, limit)
            for first in range(0, len(lasers), TOGETHER):
                some = slice(first, first + TOGETHER)
                seen = self._around.seen(grid, robots, frames[:, some], limit, lasers[some])
                paint(*seen, fan, ranges[some])
            np.divide(1.0, ranges, out=ranges)
        return np.minimum(ranges, limit, out=ranges)

    def blocked(self, grid: Grid, robots: Robots, poses: Float, out: Bool | None = None) -> Bool:
        return self._stepping.blocked(grid, robots, poses, out)

    def step(
        self, grid: Grid, robots: Robots, drives: Drives, dt: float, noise: Float | None = None
    ) -> None:
        self._stepping.step(grid, robots, drives, dt, noise)
