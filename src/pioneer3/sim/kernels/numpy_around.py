"""What is around robots, with numpy alone: walls from lists that are kept, and other robots."""

from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.kernels.near import NearWalls, near_robots
from pioneer3.sim.kernels.numpy_frames import joined, seen_from
from pioneer3.sim.kernels.robots import Robots
from pioneer3.sim.kernels.walls import Grid

Float = NDArray[np.float64]
Int = NDArray[np.int64]
Int32 = NDArray[np.int32]

TOGETHER = 128
"""Robots worked on at a time: their arrays then fit a processor's cache."""


class Around:
    """Lists of near walls by grid and reach, made when first asked for."""

    def __init__(self) -> None:
        self._near: WeakKeyDictionary[Grid, dict[float, NearWalls]] = WeakKeyDictionary()

    def lists(self, grid: Grid, reach: float) -> NearWalls:
        """Return the lists of walls within `reach` [m]."""
        lists = self._near.setdefault(grid, {})
        if reach not in lists:
            lists[reach] = NearWalls(grid, reach)
        return lists[reach]

    def walls(self, grid: Grid, frames: Float, reach: float) -> tuple[Int, Float]:
        """Return the walls within `reach` of each of the frames (4, F), and some more.

        Returns:
            Index of the frame, shape (P,), and ax, ay, bx, by seen from there [m], shape (4, P).
        """
        points, ends = self.lists(grid, reach).around(frames[:2])
        return points, seen_from(frames, points, ends)

    def seen(
        self, grid: Grid, robots: Robots, frames: Float, reach: float, owners: Int | Int32
    ) -> tuple[Int, Float]:
        """Return the same of walls and of the outlines of all robots but the `owners` (F,)."""
        whose, ends = self.lists(grid, reach).around(frames[:2])
        beside, others = near_robots(robots, frames[0], frames[1], reach, owners)
        whose, ends = joined(whose, ends, robots, beside, others)
        return whose, seen_from(frames, whose, ends)
