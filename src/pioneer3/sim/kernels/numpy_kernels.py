"""The kernels with numpy alone: always there; what a robot's small computer runs."""

from typing import NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.kernels.drives import (
    FINER,
    NEGLIGIBLE,
    OTHERS,
    STALLED,
    TOUCHED,
    VELOCITY,
    WALLS,
    Drives,
)
from pioneer3.sim.kernels.mounts import Fan, Mounts
from pioneer3.sim.kernels.near import NearWalls, distances, near_robots
from pioneer3.sim.kernels.numpy_contact import (
    boxes_of,
    frames_of,
    hit_after,
    joined,
    largest,
    may_meet,
    outlines_from,
    room_of_others,
    rounded,
    seen_from,
)
from pioneer3.sim.kernels.numpy_fans import paint
from pioneer3.sim.kernels.numpy_motion import live, reached, roll, wants_to_move, wishes, wrapped
from pioneer3.sim.kernels.numpy_outlines import place, reach_into
from pioneer3.sim.kernels.numpy_rays import Rays, march, meet_robots
from pioneer3.sim.kernels.robots import Robots
from pioneer3.sim.kernels.walls import Grid
from pioneer3.sim.raycast import TOUCH

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]
Int = NDArray[np.int64]
Int32 = NDArray[np.int32]

ROOM = 1.5
"""How far from a robot walls are looked for [m]."""
SOON = 0.4
"""Room that is too little to wait until it is used up, once one is looked after [m]."""

TOGETHER = 128
"""Robots worked on at a time: their arrays then fit a processor's cache."""

FEW = 200
"""Pairs of sensor and other robot up to which their sides are held against all rays, as walls."""

NOBODY, SURE = np.empty(0, dtype=np.int64), np.empty(0, dtype=np.bool_)


class Ears(NamedTuple):
    """Who listens with what.

    That is rays of one robot type, robots (F,), limit and distance from a robot at which its rays
    may end [m], and steepness.
    """

    rays: Rays
    owners: Int32
    limit: float
    reach: float
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
                ears = Ears(rays, who[some], limit, limit + mounts.reach, steep)
                ranges[some, : rays.mounts] = self._sonar(grid, robots, ears)
        return ranges

    def _sonar(self, grid: Grid, robots: Robots, ears: Ears) -> Float:
        """Return the ranges of a few robots of one type, shape (owners, transducers)."""
        rays, owners, limit, reach, steep = ears
        ranges = np.full((len(owners), rays.count), limit)
        echoes = ranges.copy() if steep > 0 else None
        frames = frames_of(*robots.poses[:, owners])
        whose, ends = self._lists(grid, reach).around(frames[:2])
        beside, others = near_robots(robots, frames[0], frames[1], reach, owners)
        if echoes is None and len(others) <= FEW:
            whose, ends = joined(whose, ends, robots, beside, others)
            others = NOBODY
        rays.meet_walls(whose, seen_from(frames, whose, ends), ranges, steep, echoes)
        if echoes is not None:
            # what sends nothing back still hides what is behind
            lost, nearest = echoes > ranges + TOUCH, ranges.copy()
        if len(others):
            circles = robots.shapes.T[:3].take(others, axis=1)
            circles[:2] = seen_from(frames, beside, circles[:2])

            def outlines(some: Int) -> Float:
                return outlines_from(robots, frames, beside[some], others[some])

            rays.meet_robots(beside, circles, outlines, ranges)
        if echoes is not None:
            ranges[lost & (ranges >= nearest)] = limit
        if rays.count == rays.mounts:
            return ranges
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
        frames = frames_of(x + c * mx - s * my, y + s * mx + c * my, theta + turned)
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
            frames, still = frames_of(*poses), np.zeros(len(robots))
            hits[:] = self._stands(grid, robots, robots.everyone, frames)
            hits |= may_meet(robots, robots.everyone, frames, still)[0]
        return hits

    def step(
        self, grid: Grid, robots: Robots, drives: Drives, dt: float, noise: Float | None = None
    ) -> None:
        live(drives, dt)
        moves = wants_to_move(drives)
        drives.flags[STALLED] = 0
        drives.flags[TOUCHED] &= ~moves
        if not moves.any():
            return
        wish = wishes(drives, dt, noise)
        poses = robots.poses[:, : len(drives)]
        after = reached(poses, wish[:3])
        alone, crowd, clear = self._doubtful(grid, robots, drives, moves, after)
        if len(alone) + len(crowd) == 0:
            poses[:] = after
            place(robots)
        else:
            waiting = np.concatenate([alone, crowd])
            before, outlines = poses[:, waiting], robots.shapes[waiting]
            poses[:] = after
            place(robots)
            there = robots.shapes[crowd]
            poses[:, waiting], robots.shapes[waiting] = before, outlines
            # who meets nobody does not depend on the order
            self._advance(grid, robots, drives, alone, wish)
            for k, n in enumerate(crowd.tolist()):
                if clear[k]:
                    poses[:, n], robots.shapes[n] = after[:, n], there[k]
                else:
                    self._advance(grid, robots, drives, crowd[k : k + 1], wish)
        roll(drives, wish)
        poses[2] = wrapped(poses[2])

    def _advance(self, grid: Grid, robots: Robots, drives: Drives, who: Int, wish: Float) -> None:
        """Let robots move as far as is free; shorten what they wish to that."""
        if len(who) == 0:
            return
        shares = self._free_shares(grid, robots, who, wish[:3, who])
        drives.flags[STALLED, who] = drives.flags[TOUCHED, who] = shares < 1
        wish[:, who] *= shares
        drives.axes[VELOCITY][:, who[shares < 1]] = 0.0
        robots.poses[:, who] = reached(robots.poses[:, who], wish[:3, who])
        place(robots, who)

    def _doubtful(
        self, grid: Grid, robots: Robots, drives: Drives, moves: Bool, after: Float
    ) -> tuple[Int, Int, Bool]:
        """Return who stands in a wall after this step, who may meet another, which of these won't.

        How much room a robot surely has is kept and used up step by step; only those that have
        none left are looked at. Both ascending; who may meet another is not among the first.
        """
        count = len(drives)
        x, y, turn = after - robots.poses[:, :count]
        front, rear, half = robots.state[3:6, :count]
        size = np.hypot(np.maximum(front, rear), half)
        way = np.hypot(x, y) + abs(turn) * size
        farthest = float(way.max())
        free = drives.free
        free -= way
        free[OTHERS] -= farthest
        used_up = free.min(axis=1, keepdims=True) <= 0
        if not used_up.any():
            return NOBODY, NOBODY, SURE
        # looking at some more at once is cheaper than again soon
        short = (free <= SOON) & moves & used_up
        stands = np.zeros(count, dtype=np.bool_)
        who = np.flatnonzero(short[WALLS])
        if len(who):
            room = self._room(grid, after[:, who]) - size[who]
            free[WALLS, who] = np.maximum(room, 0.0)
            who = who[room <= 0]
            stands[who] = self._stands(grid, robots, who, frames_of(*after[:, who]))
        who, crowd, clear = np.flatnonzero(short[OTHERS]), NOBODY, SURE
        if len(who):
            # both may still move, as may those looked at next
            room = room_of_others(robots, who, after[:, who]) - size[who] - farthest
            free[OTHERS, who] = np.maximum(room, 0.0)
            who = who[room <= farthest]
            ways = np.zeros(len(robots))
            ways[:count] = way
            meets, clear = may_meet(robots, who, frames_of(*after[:, who]), ways)
            crowd, clear = who[meets], clear[meets] & ~stands[who[meets]]
            stands[crowd] = False
        alone = np.flatnonzero(stands)
        for stopped in (alone, crowd):
            free[:, stopped] -= way[stopped]
        return alone, crowd, clear

    def _room(self, grid: Grid, poses: Float) -> Float:
        """Return the distance to the nearest wall [m], up to `ROOM`, of poses (3, F), (F,)."""
        room = np.full(poses.shape[1], ROOM)
        points, ends = self._lists(grid, ROOM).around(poses[:2])
        np.minimum.at(room, points, distances(poses[:2].take(points, axis=1).T, ends.T))
        return room

    def _free_shares(self, grid: Grid, robots: Robots, who: Int, motions: Float) -> Float:
        """Return how much of their motions (3, F) robots can make, in steps of 1 / 1024, (F,)."""
        frames = frames_of(*robots.poses[:, who])
        reach = largest(robots, who) + float(np.hypot(motions[0], motions[1]).max())
        around = self._seen(grid, robots, frames, rounded(reach), who)
        boxes = boxes_of(robots, who)
        shares = np.ones(len(who))
        stuck = np.flatnonzero(hit_after(around, boxes, motions, shares[:, None]))
        shares[stuck] = 0.0
        part, stuck = 1.0, stuck[abs(motions[:, stuck]).max(axis=0) > NEGLIGIBLE]
        for _ in range(2 if len(stuck) else 0):
            part /= FINER
            tried = shares[:, None] + part * np.arange(1, FINER)
            hits = hit_after(around, boxes, motions, tried)[stuck]
            first = np.where(hits.any(axis=1), hits.argmax(axis=1), FINER - 1)
            shares[stuck] += part * first
        return shares

    def _stands(self, grid: Grid, robots: Robots, who: Int | Int32, frames: Float) -> Bool:
        """Return whether robots would stand on a wall, shape (F,)."""
        stands = np.zeros(len(who), dtype=np.bool_)
        if len(who):
            whose, ends = self._walls(grid, frames, rounded(largest(robots, who)))
            stands[whose[reach_into(ends, *boxes_of(robots, who).take(whose, axis=1))]] = True
            stands &= robots.hidden[who] == 0
        return stands

    def _seen(
        self, grid: Grid, robots: Robots, frames: Float, reach: float, owners: Int | Int32
    ) -> tuple[Int, Float]:
        """Return the same of walls and of the outlines of all robots but the `owners` (F,)."""
        whose, ends = self._lists(grid, reach).around(frames[:2])
        beside, others = near_robots(robots, frames[0], frames[1], reach, owners)
        whose, ends = joined(whose, ends, robots, beside, others)
        return whose, seen_from(frames, whose, ends)

    def _walls(self, grid: Grid, frames: Float, reach: float) -> tuple[Int, Float]:
        """Return the walls within `reach` of each of the frames (4, F), and some more.

        Returns:
            Index of the frame, shape (P,), and ax, ay, bx, by seen from there [m], shape (4, P).
        """
        points, ends = self._lists(grid, reach).around(frames[:2])
        return points, seen_from(frames, points, ends)

    def _lists(self, grid: Grid, reach: float) -> NearWalls:
        lists = self._near.setdefault(grid, {})
        if reach not in lists:
            lists[reach] = NearWalls(grid, reach)
        return lists[reach]
