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


def nearest_per_ray(starts: Float, headings: Float, owners: Int, seen: Float, out: Float) -> None:
    """Shorten the ranges of robots that all carry the same rays.

    Args:
        starts: Where each ray starts on its robot [m], shape (R, 2).
        headings: Their unit vectors there, shape (R, 2).
        owners: Whose surroundings each segment belongs to, ascending, shape (P,).
        seen: Segments `x0, y0, x1, y1` [m], each in the frame of its robot, shape (P, 4).
        out: Ranges, contiguous [m], shape (robots, R).
    """
    rays, flat = len(headings), out.reshape(-1)
    # across a ray: heading x (end - start)
    ahead = headings[:, 0] * starts[:, 1] - headings[:, 1] * starts[:, 0]
    across = np.stack([-headings[:, 1], headings[:, 0], -ahead], axis=1)
    ends = np.ones((2, 3, PAIRS // rays + 1))
    for first in range(0, len(owners), PAIRS // rays + 1):
        some = seen[first : first + PAIRS // rays + 1]
        ends[0, :2, : len(some)], ends[1, :2, : len(some)] = some[:, :2].T, some[:, 2:].T
        left, right = across @ ends[0, :, : len(some)], across @ ends[1, :, : len(some)]
        # a touch may come with any product up to this; `meetings` then decides
        bound = TOUCH * max(1.0, abs(left).max(), abs(right).max())
        ray, wall = np.nonzero(np.multiply(left, right, out=left) <= bound)
        index, met = meetings(starts[ray], headings[ray], some[wall])
        place = owners[first + wall[index]] * rays + ray[index]
        np.minimum.at(flat, place, met)


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
