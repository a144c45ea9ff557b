"""Steps with numpy alone: only who has no room left is looked at closely."""

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
from pioneer3.sim.kernels.near import distances
from pioneer3.sim.kernels.numpy_around import Around
from pioneer3.sim.kernels.numpy_contact import hit_after, may_meet, room_of_others
from pioneer3.sim.kernels.numpy_frames import boxes_of, frames_of, largest, rounded
from pioneer3.sim.kernels.numpy_motion import live, reached, roll, wants_to_move, wishes, wrapped
from pioneer3.sim.kernels.numpy_outlines import place, reach_into
from pioneer3.sim.kernels.numpy_truth import any_of, indices_of
from pioneer3.sim.kernels.robots import Robots
from pioneer3.sim.kernels.walls import Grid

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]
Int = NDArray[np.int64]
Int32 = NDArray[np.int32]

ROOM = 1.5
"""How far from a robot walls are looked for [m]."""
SOON = 0.4
"""Room that is too little to wait until it is used up, once one is looked after [m]."""

NOBODY, SURE = np.empty(0, dtype=np.int64), np.empty(0, dtype=np.bool_)


class Stepping:
    """Moves robots as far as is free."""

    def __init__(self, around: Around) -> None:
        self._around = around

    def blocked(self, grid: Grid, robots: Robots, poses: Float, out: Bool | None) -> Bool:
        """Return what `Kernels.blocked` does."""
        hits = np.empty(len(robots), dtype=np.bool_) if out is None else out
        if len(robots):
            frames, still = frames_of(*poses), np.zeros(len(robots))
            hits[:] = self._stands(grid, robots, robots.everyone, frames)
            hits |= may_meet(robots, robots.everyone, frames, still)[0]
        return hits

    def step(
        self, grid: Grid, robots: Robots, drives: Drives, dt: float, noise: Float | None
    ) -> None:
        """Do what `Kernels.step` does."""
        live(drives, dt)
        moves = wants_to_move(drives)
        drives.flags[STALLED] = 0
        drives.flags[TOUCHED] &= ~moves
        if not any_of(moves):
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
        # who turns stays in the circle around its pose, but takes the one around its middle along
        way, turn = np.hypot(x, y), abs(turn)
        farthest = float((way + turn * abs(front - rear) / 2).max())
        free = drives.free
        free -= way
        free[OTHERS] -= farthest
        used_up = free <= 0
        if not any_of(used_up):
            return NOBODY, NOBODY, SURE
        # looking at some more at once is cheaper than again soon
        short = (free <= SOON) & moves & used_up.any(axis=1, keepdims=True)
        size, stands = np.hypot(np.maximum(front, rear), half), np.zeros(count, dtype=np.bool_)
        who = indices_of(short[WALLS])
        if len(who):
            room = self._room(grid, after[:, who]) - size[who]
            free[WALLS, who] = np.maximum(room, 0.0)
            who = who[room <= 0]
            stands[who] = self._stands(grid, robots, who, frames_of(*after[:, who]))
        who, crowd, clear = indices_of(short[OTHERS]), NOBODY, SURE
        if len(who):
            # both may still move, as may those looked at next
            room = room_of_others(robots, who, after[:, who]) - size[who] - farthest
            free[OTHERS, who] = np.maximum(room, 0.0)
            who = who[room <= farthest]
        if len(who):
            ways = np.zeros(len(robots))
            ways[:count] = way + turn * size
            meets, clear = may_meet(robots, who, frames_of(*after[:, who]), ways)
            crowd, clear = who[meets], clear[meets] & ~stands[who[meets]]
            stands[crowd] = False
        alone = indices_of(stands)
        for stopped in (alone, crowd):
            if len(stopped):
                free[:, stopped] -= way[stopped]
        return alone, crowd, clear

    def _room(self, grid: Grid, poses: Float) -> Float:
        """Return the distance to the nearest wall [m], up to `ROOM`, of poses (3, F), (F,)."""
        room = np.full(poses.shape[1], ROOM)
        points, ends = self._around.lists(grid, ROOM).around(poses[:2])
        np.minimum.at(room, points, distances(poses[:2].take(points, axis=1).T, ends.T))
        return room

    def _free_shares(self, grid: Grid, robots: Robots, who: Int, motions: Float) -> Float:
        """Return how much of their motions (3, F) robots can make, in steps of 1 / 1024, (F,)."""
        frames = frames_of(*robots.poses[:, who])
        reach = largest(robots, who) + float(np.hypot(motions[0], motions[1]).max())
        around = self._around.seen(grid, robots, frames, rounded(reach), who)
        boxes = boxes_of(robots, who)
        shares = np.ones(len(who))
        stuck = indices_of(hit_after(around, boxes, motions, shares[:, None]))
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
            whose, ends = self._around.walls(grid, frames, rounded(largest(robots, who)))
            stands[whose[reach_into(ends, *boxes_of(robots, who).take(whose, axis=1))]] = True
            stands &= robots.hidden[who] == 0
        return stands
