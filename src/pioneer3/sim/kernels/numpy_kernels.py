"""The kernels with numpy alone: always there; what a robot's small computer runs."""

from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.collision import TOUCH as DEEP
from pioneer3.sim.kernels.mounts import Fan, Mounts
from pioneer3.sim.kernels.near import NearWalls, near_robots
from pioneer3.sim.kernels.numpy_fans import paint
from pioneer3.sim.kernels.numpy_rays import march, meet_robots, nearest_per_ray
from pioneer3.sim.kernels.robots import Robots
from pioneer3.sim.kernels.walls import SLACK, Grid

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]
Int = NDArray[np.int64]
Int32 = NDArray[np.int32]

TOGETHER = 128
"""Robots worked on at a time: their arrays then fit a processor's cache."""


class NumpyKernels:
    """Same contract as `Kernels`."""

    name = "numpy"

    def __init__(self) -> None:
        self._near: WeakKeyDictionary[Grid, dict[float, NearWalls]] = WeakKeyDictionary()

    def place(self, robots: Robots) -> None:
        x, y, theta, front, rear, half = robots.state
        c, s = np.cos(theta), np.sin(theta)
        shapes = robots.shapes
        shapes[:, 0], shapes[:, 1] = x + c * (front - rear) / 2, y + s * (front - rear) / 2
        shapes[:, 2] = np.hypot((front + rear) / 2, half)
        corners = ((front, half), (-rear, half), (-rear, -half), (front, -half))
        for k, (ahead, left) in enumerate(corners):
            shapes[:, 3 + 2 * k] = x + c * ahead - s * left
            shapes[:, 4 + 2 * k] = y + s * ahead + c * left

    def cast_rays(
        self,
        grid: Grid,
        robots: Robots,
        origins: Float,
        angles: Float,
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
        self, grid: Grid, robots: Robots, mounts: Mounts, limit: float, out: Float | None = None
    ) -> Float:
        ranges = np.empty((len(robots), mounts.most)) if out is None else out
        ranges[:] = limit
        for kind in range(len(mounts.offsets) - 1):
            table = mounts.table[mounts.offsets[kind] : mounts.offsets[kind + 1]]
            owners = np.flatnonzero(mounts.kinds == kind)
            for first in range(0, len(owners) if len(table) else 0, TOGETHER):
                some = owners[first : first + TOGETHER]
                ranges[some, : len(table)] = self._sonar(grid, robots, table, some, limit)
        return ranges

    def _sonar(self, grid: Grid, robots: Robots, table: Float, owners: Int, limit: float) -> Float:
        """Return the ranges of a few robots of one type, shape (owners, transducers)."""
        per_mount = (table.shape[1] - 2) // 2
        ranges = np.full((len(owners), len(table) * per_mount), limit)
        reach = limit + float(np.hypot(table[:, 0], table[:, 1]).max())
        poses = robots.poses[:, owners]
        whose, seen = self._seen(grid, robots, poses, reach, owners)
        starts, headings = np.repeat(table[:, :2], per_mount, axis=0), table[:, 2:].reshape(-1, 2)
        nearest_per_ray(starts, headings, whose, seen.T, ranges)
        shortest: Float = ranges.reshape(len(owners), len(table), per_mount).min(axis=2)
        return shortest

    def cast_fans(
        self,
        grid: Grid,
        robots: Robots,
        fan: Fan,
        limit: float,
        owners: Int32 | None = None,
        out: Float | None = None,
    ) -> Float:
        lasers = robots.everyone if owners is None else owners
        ranges = np.empty((len(lasers), fan.headings.shape[1])) if out is None else out
        x, y, theta = robots.poses[:, lasers]
        c, s = np.cos(theta), np.sin(theta)
        mx, my, turned = fan.frame[:3]
        poses = np.stack([x + c * mx - s * my, y + s * mx + c * my, theta + turned])
        with np.errstate(divide="ignore"):
            ranges[:] = np.divide(1.0, limit)
            for first in range(0, len(lasers), TOGETHER):
                some = slice(first, first + TOGETHER)
                whose, seen = self._seen(grid, robots, poses[:, some], limit, lasers[some])
                paint(whose, seen, fan, limit, ranges[some])
            np.divide(1.0, ranges, out=ranges)
        return np.minimum(ranges, limit, out=ranges)

    def blocked(
        self,
        grid: Grid,
        robots: Robots,
        x: Float,
        y: Float,
        theta: Float,
        out: Bool | None = None,
    ) -> Bool:
        front, rear, half = robots.state[3:]
        reach = float(np.hypot(np.maximum(front, rear), half).max(initial=0.0))
        poses = np.stack([x, y, theta])
        whose, (ax, ay, bx, by) = self._seen(grid, robots, poses, reach, robots.everyone)
        length, width = (front + rear)[whose] / 2 - DEEP, half[whose] - DEEP
        mx, my, hx, hy = (ax + bx) / 2, (ay + by) / 2, (bx - ax) / 2, (by - ay) / 2
        mx -= (front - rear)[whose] / 2
        meets = (
            (abs(mx) <= length + abs(hx))
            & (abs(my) <= width + abs(hy))
            & (abs(hx * my - hy * mx) <= length * abs(hy) + width * abs(hx))
        )
        hits = np.empty(len(robots), dtype=np.bool_) if out is None else out
        hits[:] = np.bincount(whose[meets], minlength=len(robots)) > 0
        return hits

    def _seen(
        self, grid: Grid, robots: Robots, poses: Float, reach: float, owners: Int | Int32
    ) -> tuple[Int, Float]:
        """Return what comes within `reach` of each of the poses (3, F), and some more.

        Returns:
            Index of the pose, shape (P,), and the segments from there, ax, ay, bx, by, (4, P).
        """
        x, y, theta = poses
        lists = self._near.setdefault(grid, {})
        if reach not in lists:
            lists[reach] = NearWalls(grid, reach)
        points, walls = lists[reach].of(x, y)
        beside, others = near_robots(robots, x, y, reach, owners)
        whose, segments = points, grid.walls[walls]
        if len(others):
            whose = np.concatenate([points, np.repeat(beside, 4)])
            segments = np.concatenate([segments, robots.outlines[others].reshape(-1, 4)])
        c, s = np.cos(theta)[whose], np.sin(theta)[whose]
        ax, ay, bx, by = segments.T - np.stack([x, y, x, y])[:, whose]
        seen = np.stack([c * ax + s * ay, c * ay - s * ax, c * bx + s * by, c * by - s * bx])
        return whose, seen
