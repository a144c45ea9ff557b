"""The kernels with numpy alone: always there; what a robot's small computer runs."""

from typing import NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.collision import TOUCH as DEEP
from pioneer3.sim.kernels.drives import FINER, NEGLIGIBLE, STALLED, TOUCHED, VELOCITY, Drives
from pioneer3.sim.kernels.mounts import Fan, Mounts
from pioneer3.sim.kernels.near import NearWalls, distances, near_robots
from pioneer3.sim.kernels.numpy_fans import paint
from pioneer3.sim.kernels.numpy_motion import live, reached, roll, wants_to_move, wishes, wrapped
from pioneer3.sim.kernels.numpy_outlines import place, reach_into
from pioneer3.sim.kernels.numpy_rays import Rays, march, meet_robots, sides
from pioneer3.sim.kernels.robots import Robots
from pioneer3.sim.kernels.walls import Grid
from pioneer3.sim.raycast import TOUCH

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]
Int = NDArray[np.int64]
Int32 = NDArray[np.int32]

ROOM = 1.5
"""How far a robot is looked after whether there is room [m]."""

TOGETHER = 128
"""Robots worked on at a time: their arrays then fit a processor's cache."""


class Ears(NamedTuple):
    """Who listens with what: rays of one robot type, robots (F,), limit [m] and steepness."""

    rays: Rays
    owners: Int32
    limit: float
    steep: float


class NumpyKernels:
    """Same contract as `Kernels`."""

    name = "numpy"

    def __init__(self) -> None:
        self._rays: WeakKeyDictionary[Mounts, list[Rays]] = WeakKeyDictionary()
        self._near: WeakKeyDictionary[Grid, dict[float, NearWalls]] = WeakKeyDictionary()

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
        steep: float = 0.0,
        owners: Int32 | None = None,
        out: Float | None = None,
    ) -> Float:
        who = robots.everyone[: len(mounts.kinds)] if owners is None else owners
        ranges = np.empty((len(who), mounts.most)) if out is None else out
        ranges[:] = limit
        if mounts not in self._rays:
            tables = np.split(mounts.table, mounts.offsets[1:-1])
            self._rays[mounts] = [Rays(table) for table in tables]
        kinds = mounts.kinds[who]
        for kind, rays in enumerate(self._rays[mounts]):
            rows = np.flatnonzero(kinds == kind)
            for first in range(0, len(rows) if rays.mounts else 0, TOGETHER):
                some = rows[first : first + TOGETHER]
                ears = Ears(rays, who[some], limit, steep)
                ranges[some, : rays.mounts] = self._sonar(grid, robots, ears)
        return ranges

    def _sonar(self, grid: Grid, robots: Robots, ears: Ears) -> Float:
        """Return the ranges of a few robots of one type, shape (owners, transducers)."""
        rays, owners, limit, steep = ears
        ranges = np.full((len(owners), rays.count), limit)
        echoes = ranges.copy() if steep > 0 else None
        reach, frames = limit + rays.reach, _frames(*robots.poses[:, owners])
        rays.meet_walls(*self._walls(grid, frames, reach), ranges, steep, echoes)
        if echoes is not None:
            # what sends nothing back still hides what is behind
            lost, nearest = echoes > ranges + TOUCH, ranges.copy()
        beside, others = near_robots(robots, frames[0], frames[1], reach, owners)
        if len(others):
            shapes = robots.shapes.T.take(others, axis=1)
            points = _from(frames, beside, np.concatenate([shapes[:2], shapes[3:]]))
            rays.meet_robots(beside, shapes[2], points, ranges)
        if echoes is not None:
            ranges[lost & (ranges >= nearest)] = limit
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
        hits = np.empty(len(robots), dtype=np.bool_) if out is None else out
        if len(robots):
            stands, meets = self._touch(grid, robots, robots.everyone, _frames(*poses), 0.0)
            hits[:] = stands | meets
        return hits

    def step(
        self, grid: Grid, robots: Robots, drives: Drives, dt: float, noise: Float | None = None
    ) -> None:
        live(drives, dt)
        moves = wants_to_move(drives)
        drives.flags[STALLED] = 0
        drives.flags[TOUCHED, moves] = 0
        if not moves.any():
            return
        wish = wishes(drives, dt, noise)
        poses = robots.poses[:, : len(drives)]
        before, after = poses.copy(), reached(poses, wish)
        alone, crowded = self._doubtful(grid, robots, drives, np.flatnonzero(moves), after)
        poses[:] = after
        stuck = np.concatenate([alone, crowded])
        if len(stuck):
            poses[:, stuck] = before[:, stuck]
        place(robots)
        # who meets nobody does not depend on the order
        for who in [alone][: len(alone)] + list(crowded[:, None]):
            shares = self._free_shares(grid, robots, who, wish[:3, who])
            drives.flags[STALLED, who] = drives.flags[TOUCHED, who] = shares < 1
            wish[:, who] *= shares
            drives.axes[VELOCITY][:, who[shares < 1]] = 0.0
            poses[:, who] = reached(before[:, who], wish[:, who])
            place(robots, who)
        roll(drives, wish)
        poses[2] = wrapped(poses[2])

    def _doubtful(
        self, grid: Grid, robots: Robots, drives: Drives, moving: Int, after: Float
    ) -> tuple[Int, Int]:
        """Return who stands in a wall after this step, and who may meet another; both ascending.

        How much room a robot surely has is kept and used up step by step; only those that have
        none left are looked at.
        """
        x, y, turn = after - robots.poses[:, : len(drives)]
        front, rear, half = robots.state[3:6, : len(drives)]
        way = np.hypot(x, y) + abs(turn) * np.hypot(np.maximum(front, rear), half)
        farthest = float(way.max())
        drives.free -= way + farthest
        who = moving[drives.free[moving] <= 0]
        if len(who) == 0:
            return who, who
        x, y, theta = after[:, who]
        front, rear, half = robots.state[3:6, who]
        size = np.hypot(np.maximum(front, rear), half)
        room = np.full(len(who), ROOM)
        points, walls = self._lists(grid, ROOM).of(x, y)
        np.minimum.at(room, points, distances(np.stack([x, y], 1)[points], grid.walls[walls]))
        beside, others = near_robots(robots, x, y, ROOM, who)
        if len(others):
            middles = robots.shapes[others]
            apart = np.hypot(middles[:, 0] - x[beside], middles[:, 1] - y[beside])
            np.minimum.at(room, beside, apart - middles[:, 2] - farthest)
        drives.free[who] = np.maximum(room - size, 0.0)
        doubt = np.flatnonzero(room <= size)
        if len(doubt) == 0:
            return who[doubt], who[doubt]
        who = who[doubt]
        frames = _frames(x[doubt], y[doubt], theta[doubt])
        stands, meets = self._touch(grid, robots, who, frames, 2 * farthest)
        return who[stands & ~meets], who[meets]

    def _free_shares(self, grid: Grid, robots: Robots, who: Int, motions: Float) -> Float:
        """Return how much of their motions (3, F) robots can make, in steps of 1 / 1024, (F,)."""
        shares = np.ones(len(who))
        stuck = np.flatnonzero(self._hits(grid, robots, who, motions))
        shares[stuck] = 0.0
        part, stuck = 1.0, stuck[abs(motions[:, stuck]).max(axis=0) > NEGLIGIBLE]
        for _ in range(2 if len(stuck) else 0):
            part /= FINER
            tried = shares[stuck, None] + part * np.arange(1, FINER)
            moved = motions[:, stuck].repeat(FINER - 1, axis=1) * tried.ravel()
            hits = self._hits(grid, robots, who[stuck].repeat(FINER - 1), moved)
            hits = hits.reshape(len(stuck), FINER - 1)
            first = np.where(hits.any(axis=1), hits.argmax(axis=1), FINER - 1)
            shares[stuck] += part * first
        return shares

    def _hits(self, grid: Grid, robots: Robots, who: Int, motions: Float) -> Bool:
        """Return whether robots would stand on something after their motions (3, F)."""
        poses = reached(robots.poses[:, who], motions)
        stands, meets = self._touch(grid, robots, who, _frames(*poses), 0.0)
        return stands | meets

    def _touch(
        self, grid: Grid, robots: Robots, who: Int | Int32, frames: Float, spread: float
    ) -> tuple[Bool, Bool]:
        """Return whether robots would stand on a wall, or on another that is up to `spread` off."""
        front, rear, half = robots.state[3:6, who]
        reach = float(np.hypot(np.maximum(front, rear), half).max())
        middle, length, width = (front - rear) / 2, (front + rear) / 2 - DEEP, half - DEEP
        whose, ends = self._walls(grid, frames, reach)
        into = reach_into(ends, middle[whose], length[whose], width[whose])
        solid = robots.hidden[who] == 0
        stands: Bool = solid & (np.bincount(whose[into], minlength=len(who)) > 0)
        beside, others = near_robots(robots, frames[0], frames[1], reach + spread, who)
        if len(others) == 0:
            return stands, np.zeros_like(stands)
        corners = _from(frames, beside, robots.shapes.T[3:].take(others, axis=1))
        whose = np.tile(beside, len(corners) // 2)
        length, width = length + spread, width + spread
        into = reach_into(sides(corners), middle[whose], length[whose], width[whose])
        return stands, solid & (np.bincount(whose[into], minlength=len(who)) > 0)

    def _seen(
        self, grid: Grid, robots: Robots, frames: Float, reach: float, owners: Int32
    ) -> tuple[Int, Float]:
        """Return the same of walls and of the outlines of all robots but the `owners` (F,)."""
        whose, seen = self._walls(grid, frames, reach)
        beside, others = near_robots(robots, frames[0], frames[1], reach, owners)
        if len(others) == 0:
            return whose, seen
        corners = _from(frames, beside, robots.shapes.T[3:].take(others, axis=1))
        whose = np.concatenate([whose, np.tile(beside, len(corners) // 2)])
        return whose, np.concatenate([seen, sides(corners)], axis=1)

    def _walls(self, grid: Grid, frames: Float, reach: float) -> tuple[Int, Float]:
        """Return the walls within `reach` of each of the frames (4, F), and some more.

        Returns:
            Index of the frame, shape (P,), and ax, ay, bx, by seen from there [m], shape (4, P).
        """
        near = self._lists(grid, reach)
        points, walls = near.of(frames[0], frames[1])
        return points, _from(frames, points, near.ends.take(walls, axis=1))

    def _lists(self, grid: Grid, reach: float) -> NearWalls:
        lists = self._near.setdefault(grid, {})
        if reach not in lists:
            lists[reach] = NearWalls(grid, reach)
        return lists[reach]


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
