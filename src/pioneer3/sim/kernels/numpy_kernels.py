"""The kernels with numpy alone: always there; what a robot's small computer runs."""

from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.collision import TOUCH as DEEP
from pioneer3.sim.kernels.mounts import Fan, Mounts
from pioneer3.sim.kernels.near import NearWalls, near_robots
from pioneer3.sim.kernels.numpy_fans import paint
from pioneer3.sim.kernels.numpy_rays import Rays, march, meet_robots
from pioneer3.sim.kernels.robots import Robots
from pioneer3.sim.kernels.walls import Grid

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
        rays = Rays(np.repeat(table[:, :2], per_mount, axis=0), table[:, 2:].reshape(-1, 2))
        rays.meet_walls(*self._walls(grid, poses, reach), ranges)
        beside, others = near_robots(robots, *poses[:2], reach, owners)
        if len(others):
            shapes = robots.shapes.T[:, others]
            middles = np.stack([*_from(poses, beside, shapes[:2]), shapes[2]])
            rays.meet_robots(beside, middles, _from(poses, beside, shapes[3:]), ranges)
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
                paint(*self._walls(grid, poses[:, some], limit), fan, ranges[some])
                outlines = _outlines(robots, poses[:, some], limit, lasers[some], facing=True)
                if len(outlines[0]):
                    paint(*outlines, fan, ranges[some])
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
        walls = self._walls(grid, poses, reach)
        outlines = _outlines(robots, poses, reach, robots.everyone, facing=False)
        whose = np.concatenate([walls[0], outlines[0]])
        ax, ay, bx, by = np.concatenate([walls[1], outlines[1]], axis=1)
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

    def _walls(self, grid: Grid, poses: Float, reach: float) -> tuple[Int, Float]:
        """Return the walls within `reach` of each of the poses (3, F), and some more.

        Returns:
            Index of the pose, shape (P,), and ax, ay, bx, by seen from there [m], shape (4, P).
        """
        lists = self._near.setdefault(grid, {})
        if reach not in lists:
            lists[reach] = NearWalls(grid, reach)
        points, walls = lists[reach].of(poses[0], poses[1])
        return points, _from(poses, points, lists[reach].ends.take(walls, axis=1))


def _from(poses: Float, which: Int, points: Float) -> Float:
    """Return points x, y, x, y..., shape (2 K, P), as seen from the poses (3, F) `which` (P,)."""
    x, y, c, s = np.stack([*poses[:2], np.cos(poses[2]), np.sin(poses[2])]).take(which, axis=1)
    seen = np.empty_like(points)
    for k in range(0, len(points), 2):
        dx, dy = points[k] - x, points[k + 1] - y
        seen[k], seen[k + 1] = c * dx + s * dy, c * dy - s * dx
    return seen


def _outlines(
    robots: Robots, poses: Float, reach: float, owners: Int32, *, facing: bool
) -> tuple[Int, Float]:
    """Return the sides of the other robots within `reach`; only those `facing` a pose outside."""
    beside, others = near_robots(robots, poses[0], poses[1], reach, owners)
    corners = _from(poses, beside, robots.shapes.T[3:, others])
    starts = corners.reshape(4, 2, -1)
    ends = np.roll(starts, -1, axis=0)
    turn = starts[:, 0] * ends[:, 1] - starts[:, 1] * ends[:, 0]
    away = (turn > 0) & ~(turn > 0).all(axis=0) if facing else np.zeros_like(turn, dtype=np.bool_)
    side, pair = np.nonzero(~away)
    return beside[pair], np.concatenate([starts[side, :, pair], ends[side, :, pair]], axis=1).T
