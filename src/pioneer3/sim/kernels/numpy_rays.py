"""The rays of a robot with numpy alone: every ray and near wall, then the few that meet."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.kernels.numpy_frames import sides
from pioneer3.sim.kernels.numpy_truth import all_of, indices_of
from pioneer3.sim.raycast import PAIRS, TOUCH

Float = NDArray[np.float64]
Int = NDArray[np.int64]

MAYBE = 1e6 * TOUCH
"""A touch comes with no larger product of how far across a ray both ends of a wall lie [m^2]."""


def measured(headings: Float, ends: Float) -> Float:
    """Return the range from the origin along each ray to a segment [m], as the oracle, or infinity.

    Args:
        headings: Unit vectors, shape (2, ...).
        ends: Of the segment beside each, `ax, ay, bx, by` from the ray's start [m], shape (4, ...).
    """
    (dx, dy), x, y = headings, ends[::2], ends[1::2]
    return _met(dx * y - dy * x, dx * x + dy * y)


def _met(across: Float, along: Float) -> Float:
    """Return the same, given how far the ends lie across the ray, how far along [m], (2, ...)."""
    across *= abs(across) > TOUCH
    one, other = across
    gap = one - other
    with np.errstate(divide="ignore", invalid="ignore"):
        met: Float = along[0] + (along[1] - along[0]) * (one / gap)
    if not all_of(gap):
        lies_along = (gap == 0) & (one == 0)
        near, far = along[:, lies_along]
        met[lies_along] = np.where(near * far <= 0, 0.0, np.minimum(near, far))
    met[(one * other > 0) | (met < -TOUCH)] = np.inf
    return np.maximum(met, 0.0, out=met)


class Rays:
    """The rays of one robot type, ready to be held against what is around a robot.

    Args:
        table: Of each mount x, y [m], then cosine and sine of each of its rays, shape (M, 2 + 2 k).

    Attributes:
        table: The same.
        mounts: M.
        count: Of rays, M * k.
    """

    def __init__(self, table: Float) -> None:
        self.table = table
        self.mounts, self.count = len(table), table[:, 2:].size // 2
        x, y = np.repeat(table[:, :2].T, self.count // max(1, self.mounts), axis=1)
        dx, dy = table[:, 2:].reshape(-1, 2).T
        self._starts, self._headings = np.stack([x, y, x, y]), np.stack([dx, dy])
        # of a point (x, y, 1): how far across each ray it lies, how far along
        self._across = np.stack([-dy, dx, dy * x - dx * y], axis=1)
        self._along = np.stack([dx, dy, -dx * x - dy * y])
        self._block = PAIRS // max(1, self.count) + 1

    def meet_walls(
        self, owners: Int, seen: Float, out: Float, steep: float = 0.0, heard: Float | None = None
    ) -> None:
        """Shorten ranges by segments.

        Args:
            owners: Whose surroundings each segment belongs to, shape (P,).
            seen: Ends `ax, ay, bx, by` in the frame of that robot [m], shape (4, P).
            out: Ranges, contiguous [m], shape (robots, R).
            steep: Sine of the smallest angle to a segment that sends a ray back.
            heard: In addition, the ranges to segments that do, shape (robots, R).
        """
        points = np.ones((6, seen.shape[1]))
        points[:2], points[3:5] = seen[:2], seen[2:]
        for first in range(0, len(owners), self._block):
            some = points[:, first : first + self._block]
            across = np.empty((2, self.count, some.shape[1]))
            np.matmul(self._across, some[:3], out=across[0])
            np.matmul(self._across, some[3:], out=across[1])
            maybe = indices_of(across[0] * across[1] <= MAYBE)
            ray, wall = np.divmod(maybe, some.shape[1])
            ends = some.take(wall, axis=1)
            dx, dy, start = self._along.take(ray, axis=1)
            along = dx * ends[::3] + dy * ends[1::3] + start
            met = _met(across.reshape(2, -1).take(maybe, axis=1), along)
            place = owners[first : first + self._block].take(wall) * out.shape[1] + ray
            np.minimum.at(out.reshape(-1), place, met)
            if heard is not None:
                back = ~(self._steepness(ray, ends[[0, 1, 3, 4]]) < steep)  # a post has none
                np.minimum.at(heard.reshape(-1), place[back], met[back])

    def meet_robots(
        self, owners: Int, circles: Float, outlines: Callable[[Int], Float], out: Float
    ) -> None:
        """Shorten ranges by outlines.

        Args:
            owners: In whose frame each is seen, shape (P,).
            circles: Middle x, y there and radius of the circle around each [m], shape (3, P).
            outlines: Returns the corners of some of them there [m], shape (2 C, ...).
            out: Ranges, contiguous [m], shape (robots, R).
        """
        points = np.ones((3, len(owners)))
        points[:2] = circles[:2]
        maybe = indices_of(abs(self._across @ points) <= circles[2] + TOUCH)
        ray, robot = np.divmod(maybe, len(owners))
        dx, dy, start = self._along.take(ray, axis=1)
        x, y, radius = circles.take(robot, axis=1)
        along, place = dx * x + dy * y + start, owners[robot] * out.shape[1] + ray
        near = (along >= -radius - TOUCH) & (along - radius <= out.reshape(-1)[place] + TOUCH)
        ray, robot, place = ray[near], robot[near], place[near]
        if len(ray):
            ends = sides(outlines(robot)).reshape(4, -1, len(ray))
            ends -= self._starts.take(ray, axis=1)[:, None]
            headings = self._headings.take(ray, axis=1)[:, None]
            np.minimum.at(out.reshape(-1), place, measured(headings, ends).min(axis=0))

    def _steepness(self, ray: Int, ends: Float) -> Float:
        """Return the sine of the angle between each ray and its segment."""
        dx, dy = self._headings.take(ray, axis=1)
        ex, ey = ends[2] - ends[0], ends[3] - ends[1]
        with np.errstate(invalid="ignore"):
            sine: Float = abs(dx * ey - dy * ex) / np.hypot(ex, ey)
        return sine
