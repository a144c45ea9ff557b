"""Single rays with numpy alone: along the cells of the grid, in longer and longer pieces."""

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.kernels.numpy_truth import indices_of
from pioneer3.sim.kernels.robots import Robots
from pioneer3.sim.kernels.walls import Grid, ranges, rasterise
from pioneer3.sim.raycast import PAIRS, TOUCH, directions, meetings

Float = NDArray[np.float64]
Int = NDArray[np.int64]

FIRST_REACH = 2.0
"""How far rays are followed before those that hit something are dropped [m]."""


def march(grid: Grid, origins: Float, angles: Float, limit: float, out: Float) -> None:
    """Fill `out` (R,) with the ranges to the walls, looking at no more cells than needed."""
    out[:] = limit
    headings = directions(angles)
    near, far = _interval(grid, origins)
    rays = indices_of(near < np.minimum(far, limit))
    start, reach = float(near[rays].min(initial=np.inf)), FIRST_REACH
    end = min(float(far[rays].max(initial=0.0)), limit)
    while len(rays) and start < end:
        stop = min(start + reach, end)
        lines = np.concatenate([origins[rays], headings[rays]], axis=1)
        _along(grid, rays, lines, (start, stop), out)
        # beyond `stop` a nearer wall may stand in a cell not looked at yet
        rays = rays[out[rays] > stop]
        start, reach = stop, 2 * reach


def _along(grid: Grid, rays: Int, lines: Float, interval: tuple[float, float], out: Float) -> None:
    """Shorten the ranges of `rays` by the walls in the cells they pass in an interval [m].

    `lines` are where they start and their unit vectors, shape (len(rays), 4).
    """
    origins, headings = lines[:, :2], lines[:, 2:]
    span = np.concatenate([interval[0] * headings, interval[1] * headings], axis=1)
    cells, index = rasterise(np.tile(origins - grid.corner, 2) + span, grid.cell)
    inside = ((cells >= 0) & (cells < grid.shape)).all(axis=1)
    places, index = cells[inside] @ np.array([1, grid.shape[0]]), index[inside]
    first = grid.cell_start[places].astype(np.int64)
    counts = grid.cell_start[places + 1] - first
    blocks = np.flatnonzero(np.diff(np.cumsum(counts) // PAIRS)) + 1
    for block in np.split(np.arange(len(places)), blocks):
        ray = np.repeat(index[block], counts[block])
        walls = grid.pieces[ranges(first[block], counts[block]), :4]
        which, met = meetings(origins[ray], headings[ray], walls)
        np.minimum.at(out, rays[ray[which]], met)


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
    rays, outlines = (
        np.repeat(rays[close], robots.outlines.shape[1]),
        robots.outlines[others[close]].reshape(-1, 4),
    )
    which, met = meetings(origins[rays], headings[rays], outlines)
    np.minimum.at(out, rays[which], met)
