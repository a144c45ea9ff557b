"""The kernels with numpy alone: always there; what a robot's small computer runs."""

from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.collision import TOUCH as DEEP
from pioneer3.sim.kernels.mounts import Fan, Mounts
from pioneer3.sim.kernels.near import NearWalls, near_robots
from pioneer3.sim.kernels.numpy_fans import paint
from pioneer3.sim.kernels.numpy_rays import Rays, march, meet_robots, sides
from pioneer3.sim.kernels.robots import Robots
from pioneer3.sim.kernels.walls import Grid

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]
Int = NDArray[np.int64]
Int32 = NDArray[np.int32]

POINTS = [0, 1, 3, 4, 5, 6, 7, 8, 9, 10]
"""Rows of shapes transposed: the middle, then the corners."""

TOGETHER = 128
"""Robots worked on at a time: their arrays then fit a processor's cache."""


class NumpyKernels:
    """Same contract as `Kernels`."""

    name = "numpy"

    def __init__(self) -> None:
        self._rays: WeakKeyDictionary[Mounts, list[Rays]] = WeakKeyDictionary()
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
        self, grid: Grid, robots: Robots, mounts: Mounts, limit: float, out: Float | None = None
    ) -> Float:
        ranges = np.empty((len(robots), mounts.most)) if out is None else out
        ranges[:] = limit
        if mounts not in self._rays:
            tables = np.split(mounts.table, mounts.offsets[1:-1])
            self._rays[mounts] = [Rays(table) for table in tables]
        for kind, rays in enumerate(self._rays[mounts]):
            owners = np.flatnonzero(mounts.kinds == kind)
            for first in range(0, len(owners) if rays.mounts else 0, TOGETHER):
                some = owners[first : first + TOGETHER]
                ranges[some, : rays.mounts] = self._sonar(grid, robots, rays, some, limit)
        return ranges

    def _sonar(self, grid: Grid, robots: Robots, rays: Rays, owners: Int, limit: float) -> Float:
        """Return the ranges of a few robots of one type, shape (owners, transducers)."""
        ranges = np.full((len(owners), rays.count), limit)
        reach, frames = limit + rays.reach, _frames(*robots.poses[:, owners])
        rays.meet_walls(*self._walls(grid, frames, reach), ranges)
        beside, others = near_robots(robots, frames[0], frames[1], reach, owners)
        if len(others):
            shapes = robots.shapes.T.take(others, axis=1)
            radius, points = shapes[2], _from(frames, beside, shapes[POINTS])
            rays.meet_robots(beside, radius, points, ranges)
        shortest: Float = ranges.reshape(len(owners), rays.mounts, -1).min(axis=2)
        return shortest

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
        x, y, theta = robots.poses[:, lasers]
        c, s = np.cos(theta), np.sin(theta)
        mx, my, turned = fan.frame[:3]
        frames = _frames(x + c * mx - s * my, y + s * mx + c * my, theta + turned)
        with np.errstate(divide="ignore"):
            ranges[:] = np.divide(1.0, limit)
            for first in range(0, len(lasers), TOGETHER):
                some = slice(first, first + TOGETHER)
                seen = self._seen(grid, robots, frames[:, some], limit, lasers[some])
                paint(*seen, fan, ranges[some])
            np.divide(1.0, ranges, out=ranges)
        return np.minimum(ranges, limit, out=ranges)

    def blocked(self, grid: Grid, robots: Robots, poses: Float, out: Bool | None = None) -> Bool:
        front, rear, half = robots.state[3:]
        reach = float(np.hypot(np.maximum(front, rear), half).max(initial=0.0))
        whose, (ax, ay, bx, by) = self._seen(grid, robots, _frames(*poses), reach, robots.everyone)
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
        self, grid: Grid, robots: Robots, frames: Float, reach: float, owners: Int32
    ) -> tuple[Int, Float]:
        """Return the same of walls and of the outlines of all robots but the `owners` (F,)."""
        whose, seen = self._walls(grid, frames, reach)
        beside, others = near_robots(robots, frames[0], frames[1], reach, owners)
        if len(others) == 0:
            return whose, seen
        corners = _from(frames, beside, robots.shapes.T[3:].take(others, axis=1))
        return np.concatenate([whose, *[beside] * 4]), np.concatenate([seen, sides(corners)], 1)

    def _walls(self, grid: Grid, frames: Float, reach: float) -> tuple[Int, Float]:
        """Return the walls within `reach` of each of the frames (4, F), and some more.

        Returns:
            Index of the frame, shape (P,), and ax, ay, bx, by seen from there [m], shape (4, P).
        """
        lists = self._near.setdefault(grid, {})
        if reach not in lists:
            lists[reach] = NearWalls(grid, reach)
        points, walls = lists[reach].of(frames[0], frames[1])
        return points, _from(frames, points, lists[reach].ends.take(walls, axis=1))


def _frames(x: Float, y: Float, theta: Float) -> Float:
    """Return x, y, cosine and sine of poses, shape (4, F)."""
    return np.stack([x, y, np.cos(theta), np.sin(theta)])


def _from(frames: Float, which: Int, points: Float) -> Float:
    """Return points x, y, x, y..., shape (2 K, P), as seen from the frames `which` (P,)."""
    x, y, c, s = frames.take(which, axis=1)
    dx, dy = points[::2] - x, points[1::2] - y
    seen = np.empty_like(points)
    seen[::2] = c * dx + s * dy
    seen[1::2] = c * dy - s * dx
    return seen
