"""Sonar with numpy alone: robots of one type at a time, all their rays at once."""

from typing import NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.kernels.echoes import Echoes
from pioneer3.sim.kernels.mounts import Mounts
from pioneer3.sim.kernels.near import near_robots
from pioneer3.sim.kernels.numpy_around import TOGETHER, Around
from pioneer3.sim.kernels.numpy_edges import hear_edges
from pioneer3.sim.kernels.numpy_frames import frames_of, joined, outlines_from, seen_from
from pioneer3.sim.kernels.numpy_rays import Rays
from pioneer3.sim.kernels.numpy_truth import indices_of
from pioneer3.sim.kernels.robots import Robots
from pioneer3.sim.kernels.walls import Grid
from pioneer3.sim.raycast import TOUCH

Float = NDArray[np.float64]
Int = NDArray[np.int64]
Int32 = NDArray[np.int32]

FEW = 200
"""Pairs of sensor and other robot up to which their sides are held against all rays, as walls."""

NOBODY = np.empty(0, dtype=np.int64)


class Listening(NamedTuple):
    """Who listens with what.

    That is rays of one robot type, robots (F,), limit and distance from a robot at which its rays
    may end [m], and what walls send back.
    """

    rays: Rays
    owners: Int32
    limit: float
    reach: float
    echoes: Echoes


class Sonar:
    """Makes the rays of mounts when they are first used."""

    def __init__(self, around: Around) -> None:
        self._around = around
        self._rays: WeakKeyDictionary[Mounts, list[Rays]] = WeakKeyDictionary()

    def measure(
        self,
        grid: Grid,
        robots: Robots,
        mounts: Mounts,
        limit: float,
        *,
        echoes: Echoes,
        owners: Int32 | None,
        out: Float | None,
    ) -> Float:
        """Return the ranges of `Kernels.sonar`."""
        who = robots.everyone[: len(mounts.kinds)] if owners is None else owners
        ranges = np.empty((len(who), mounts.most)) if out is None else out
        ranges[:] = limit
        if mounts not in self._rays:
            tables = np.split(mounts.table, mounts.offsets[1:-1])
            self._rays[mounts] = [Rays(table) for table in tables]
        kinds = mounts.kinds[who]
        for kind, rays in enumerate(self._rays[mounts]):
            rows = indices_of(kinds == kind)
            for first in range(0, len(rows) if rays.mounts else 0, TOGETHER):
                some = rows[first : first + TOGETHER]
                listening = Listening(rays, who[some], limit, limit + mounts.reach, echoes)
                ranges[some, : rays.mounts] = self._of_few(grid, robots, listening)
        return ranges

    def _of_few(self, grid: Grid, robots: Robots, listening: Listening) -> Float:
        """Return the ranges of a few robots of one type, shape (owners, transducers)."""
        rays, owners, limit, reach, echoes = listening
        ranges = np.full((len(owners), rays.count), limit)
        heard = ranges.copy() if echoes.steep > 0 else None
        frames = frames_of(*robots.poses.take(owners, axis=1))
        whose, ends = self._around.lists(grid, reach).around(frames[:2])
        beside, others = near_robots(robots, frames[0], frames[1], reach, owners)
        if heard is None and len(others) <= FEW:
            whose, ends = joined(whose, ends, robots, beside, others)
            others = NOBODY
        rays.meet_walls(whose, seen_from(frames, whose, ends), ranges, echoes.steep, heard)
        if heard is not None:
            # what sends nothing back still hides what is behind
            lost, nearest = heard > ranges + TOUCH, ranges.copy()
        if len(others):
            circles = robots.shapes.T[:3].take(others, axis=1)
            circles[:2] = seen_from(frames, beside, circles[:2])

            def outlines(some: Int) -> Float:
                return outlines_from(robots, frames, beside[some], others[some])

            rays.meet_robots(beside, circles, outlines, ranges)
        if heard is not None:
            ranges[lost & (ranges >= nearest)] = limit
        if rays.count > rays.mounts:
            ranges = ranges.reshape(len(owners), rays.mounts, -1).min(axis=2)
        hear_edges(self._around, grid, echoes, frames=frames, table=rays.table, out=ranges)
        return ranges
