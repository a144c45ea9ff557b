"""The kernels compiled by numba: the fast implementation, in the extra `fast`."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.kernels.compiled import fans, motion, rays, table
from pioneer3.sim.kernels.drives import Drives
from pioneer3.sim.kernels.echoes import ALL, Echoes
from pioneer3.sim.kernels.mounts import Fan, Mounts
from pioneer3.sim.kernels.robots import Robots
from pioneer3.sim.kernels.walls import Grid

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]
Int32 = NDArray[np.int32]

WORTH_THREADS = 50
"""Robots from which on sharing the work among threads pays."""

WHOLE = (np.array([[0.0, 0.0, 1.0, 0.0]]), np.array([0, 1], dtype=np.int32))
"""A transducer at the pose itself, pointing ahead."""


NO_NOISE = np.empty((3, 0))
NO_ECHOES = 0.0, 0.0


class NumbaKernels:
    """Same contract as `Kernels`; compiles at first use, in seconds, then loads from the cache.

    Args:
        threads: That share the work of many robots; the result is the same to the last bit.
    """

    name = "numba"

    def __init__(self, threads: int = 1) -> None:
        self._threads = threads
        self._pool = ThreadPoolExecutor(threads - 1, "kernels") if threads > 1 else None

    def place(self, robots: Robots) -> None:
        table.place(robots.state, robots.arrays)

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
        count = len(angles)
        ranges = np.empty(count) if out is None else out
        poses = np.concatenate([origins.T, angles[None]])
        mounts = (*WHOLE, np.zeros(count, dtype=np.int32))
        walls, others, rows = grid.arrays, robots.arrays, ranges.reshape(count, 1)

        def work(first: int, last: int) -> None:
            rays.sonar(
                first, last, limit, NO_ECHOES, poses, owner, mounts, walls, walls, others, rows
            )

        self._share(count, work)
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
        poses, table = robots.poses, mounts.arrays
        if owners is None:
            owners = robots.everyone[: len(mounts.kinds)]
        else:
            poses, table = poses[:, owners], (*table[:2], mounts.kinds[owners])
        count = len(owners)
        ranges = np.empty((count, mounts.most)) if out is None else out
        walls, others = grid.arrays, robots.arrays
        edges = walls if echoes.edges is None else echoes.edges.arrays
        heard = echoes.steep, echoes.edge_range if echoes.edges else 0.0

        def work(first: int, last: int) -> None:
            rays.sonar(
                first, last, limit, heard, poses, owners, table, walls, edges, others, ranges
            )

        self._share(count, work)
        return ranges

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
        walls, others, poses = grid.arrays, robots.arrays, robots.poses

        def work(first: int, last: int) -> None:
            fans.fans(
                first, last, limit, lasers, fan.frame, fan.headings, poses, walls, others, ranges
            )

        self._share(len(lasers), work)
        return ranges

    def blocked(self, grid: Grid, robots: Robots, poses: Float, out: Bool | None = None) -> Bool:
        hits = np.empty(len(robots), dtype=np.bool_) if out is None else out
        walls, others, state = grid.arrays, robots.arrays, robots.state

        def work(first: int, last: int) -> None:
            motion.blocked(first, last, poses, state, walls, others, hits)

        self._share(len(robots), work)
        return hits

    def step(
        self, grid: Grid, robots: Robots, drives: Drives, dt: float, noise: Float | None = None
    ) -> None:
        errors = NO_NOISE if noise is None else noise
        motion.step(dt, errors, drives.arrays, robots.state, grid.arrays, robots.arrays)

    def _share(self, count: int, work: Callable[[int, int], None]) -> None:
        """Call `work` on `count` rows, in parts if that pays."""
        if self._pool is None or count < WORTH_THREADS:
            work(0, count)
            return
        edges = [count * part // self._threads for part in range(self._threads + 1)]
        others = self._pool.map(work, edges[1:-1], edges[2:])
        work(0, edges[1])
        for _ in others:
            pass
