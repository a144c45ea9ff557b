"""Sonar and single rays with numpy alone: all pairs of ray and near wall, then the few that meet."""

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.kernels.robots import Robots
from pioneer3.sim.kernels.walls import Grid, ranges, rasterise
from pioneer3.sim.raycast import PAIRS, TOUCH, directions, meetings

Float = NDArray[np.float64]
Int = NDArray[np.int64]
Int32 = NDArray[np.int32]

FIRST_REACH = 2.0
"""How far rays are followed before those that hit something are dropped [m]."""


def measured(headings: Float, ends: Float) -> Float:
    """Return the range from the origin along each ray to a segment [m], as the oracle, or infinity.

    Args:
        headings: Unit vectors, shape (2, P).
        ends: Of the segment beside each, `ax, ay, bx, by` from the ray's start [m], shape (4, P).
    """
    (dx, dy), (ax, ay, bx, by) = headings, ends
    across0, across1 = dx * ay - dy * ax, dx * by - dy * bx
    along0, along1 = dx * ax + dy * ay, dx * bx + dy * by
    across0[abs(across0) <= TOUCH] = 0.0
    across1[abs(across1) <= TOUCH] = 0.0
    lies_along = (across0 == 0) & (across1 == 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        met = along0 + (along1 - along0) * (across0 / (across0 - across1))
    nearer = np.where(along0 * along1 <= 0, 0.0, np.minimum(along0, along1))
    met = np.where(lies_along, nearer, met)
    apart = np.sign(across0) * np.sign(across1) > 0
    ranges: Float = np.where(apart | ~(met >= -TOUCH), np.inf, met.clip(min=0.0))
    return ranges


class Rays:
    """The rays of one robot type, ready to be held against what is around a robot.

    Args:
        starts: Where each ray starts on its robot [m], shape (R, 2).
        headings: Their unit vectors there, shape (R, 2).
    """

    def __init__(self, starts: Float, headings: Float) -> None:
        self._starts, self._headings = starts.T.copy(), headings.T.copy()
        (x, y), (dx, dy) = self._starts, self._headings
        # of a point (x, y, 1): how far across each ray it lies, how far along
        self._across = np.stack([-dy, dx, dy * x - dx * y], axis=1)
        self._along = np.stack([dx, dy, -dx * x - dy * y], axis=1)
        self._block = PAIRS // len(starts) + 1

    def meet_walls(self, owners: Int, seen: Float, out: Float) -> None:
        """Shorten ranges by segments.

        Args:
            owners: Whose surroundings each segment belongs to, shape (P,).
            seen: Ends `ax, ay, bx, by` in the frame of that robot [m], shape (4, P).
            out: Ranges, contiguous [m], shape (robots, R).
        """
        ones = np.ones((1, seen.shape[1]))
        first_ends, last_ends = np.vstack([seen[:2], ones]), np.vstack([seen[2:], ones])
        for first in range(0, len(owners), self._block):
            some = slice(first, first + self._block)
            left, right = self._across @ first_ends[:, some], self._across @ last_ends[:, some]
            # a touch may come with any product up to this; `measured` then decides
            bound = TOUCH * (float(left.max()) - float(left.min()) + 1.0)
            right *= left
            pairs = np.flatnonzero(right <= bound)
            ray, wall = np.divmod(pairs, left.shape[1])
            self._measure(ray, owners[some][wall], seen[:, some].take(wall, axis=1), out)

    def meet_robots(self, owners: Int, middles: Float, corners: Float, out: Float) -> None:
        """Shorten ranges by outlines, given as middle x, y, radius, (3, P), and corners (8, P)."""
        points = np.vstack([middles[:2], np.ones((1, middles.shape[1]))])
        radius = middles[2] + TOUCH
        along = self._along @ points
        meets = (abs(self._across @ points) <= radius) & (along >= -radius)
        meets &= along - radius <= out[owners].T
        ray, robot = np.nonzero(meets)
        for k in range(4):
            ends = corners.take(robot, axis=1)[[2 * k - 2, 2 * k - 1, 2 * k, 2 * k + 1]]
            self._measure(ray, owners[robot], ends, out)

    def _measure(self, ray: Int, owner: Int, ends: Float, out: Float) -> None:
        ends -= np.tile(self._starts, (2, 1)).take(ray, axis=1)
        met = measured(self._headings.take(ray, axis=1), ends)
        np.minimum.at(out.reshape(-1), owner * out.shape[1] + ray, met)


def march(grid: Grid, origins: Float, angles: Float, limit: float, out: Float) -> None:
    """Fill `out` (R,) with the ranges to the walls, looking at no more cells than needed."""
    out[:] = limit
    headings = directions(angles)
    near, far = _interval(grid, origins)
    rays = np.flatnonzero(near < np.minimum(far, limit))
    start, reach = float(near[rays].min(initial=np.inf)), FIRST_REACH
    end = min(float(far[rays].max(initial=0.0)), limit)
    while len(rays) and start < end:
        stop = min(start + reach, end)
        _along(grid, origins, headings, rays, start, stop, out)
        # beyond `stop` a nearer wall may stand in a cell not looked at yet
        rays = rays[out[rays] > stop]
        start, reach = stop, 2 * reach


def _along(
    grid: Grid, origins: Float, headings: Float, rays: Int, start: float, stop: float, out: Float
) -> None:
    """Shorten ranges by the walls in the cells that rays pass from `start` to `stop` [m]."""
    span = np.concatenate([start * headings[rays], stop * headings[rays]], axis=1)
    cells, index = rasterise(np.tile(origins[rays] - grid.corner, 2) + span, grid.cell)
    inside = ((cells >= 0) & (cells < grid.shape)).all(axis=1)
    places, index = cells[inside] @ np.array([1, grid.shape[0]]), rays[index[inside]]
    first = grid.cell_start[places].astype(np.int64)
    counts = grid.cell_start[places + 1] - first
    blocks = np.flatnonzero(np.diff(np.cumsum(counts) // PAIRS)) + 1
    for block in np.split(np.arange(len(places)), blocks):
        ray = np.repeat(index[block], counts[block])
        walls = grid.pieces[ranges(first[block], counts[block]), :4]
        which, met = meetings(origins[ray], headings[ray], walls)
        np.minimum.at(out, ray[which], met)


def _interval(grid: Grid, origins: Float) -> tuple[Float, Float]:
    """Return the least and greatest distance [m] from each origin to the grid, both (R,)."""
    low, high = grid.corner, grid.corner + np.array(grid.shape) * grid.cell
    outside = np.maximum(np.maximum(low - origins, origins - high), 0.0)
    furthest = np.maximum(abs(origins - low), abs(origins - high))
    return np.hypot(*outside.T), np.hypot(*furthest.T)


def meet_robots(
    robots: Robots, pairs: tuple[Int, Int], origins: Float, angles: Float, out: Float
) -> None:
    """Shorten the ranges `out` (R,) of the rays by the robots paired with them."""
    headings = directions(angles)
    rays, others = pairs
    offset = robots.shapes[others, :2] - origins[rays]
    dx, dy = headings[rays].T
    across = dx * offset[:, 1] - dy * offset[:, 0]
    close = abs(across) <= robots.shapes[others, 2] + TOUCH
    rays, outlines = np.repeat(rays[close], 4), robots.outlines[others[close]].reshape(-1, 4)
    which, met = meetings(origins[rays], headings[rays], outlines)
    np.minimum.at(out, rays[which], met)
