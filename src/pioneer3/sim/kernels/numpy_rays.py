"""Sonar and single rays with numpy alone: every ray and near wall, then the few that meet."""

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
    (dx, dy), x, y = headings, ends[::2], ends[1::2]
    across, along = dx * y - dy * x, dx * x + dy * y
    across *= abs(across) > TOUCH
    gap = across[0] - across[1]
    with np.errstate(divide="ignore", invalid="ignore"):
        met: Float = along[0] + (along[1] - along[0]) * (across[0] / gap)
    met[across[0] * across[1] > 0] = np.inf
    lies_along = np.flatnonzero((gap == 0) & (across[0] == 0))
    if len(lies_along):
        one, other = along[:, lies_along]
        met[lies_along] = np.where(one * other <= 0, 0.0, np.minimum(one, other))
    met[met < -TOUCH] = np.inf
    return np.maximum(met, 0.0, out=met)


def sides(corners: Float) -> Float:
    """Return the sides of outlines given by C corners, (2 C, P) to ax, ay, bx, by, (4, C P)."""
    x, y = corners[::2], corners[1::2]
    ends = np.stack([np.roll(x, 1, axis=0), np.roll(y, 1, axis=0), x, y])
    return ends.reshape(4, -1)


class Rays:
    """The rays of one robot type, ready to be held against what is around a robot.

    Args:
        table: Of each mount x, y [m], then cosine and sine of each of its rays, shape (M, 2 + 2 k).

    Attributes:
        mounts: M.
        count: Of rays, M * k.
        reach: Largest distance of a mount from the robot's pose [m].
    """

    def __init__(self, table: Float) -> None:
        self.mounts, self.count = len(table), table[:, 2:].size // 2
        self.reach = float(np.hypot(table[:, 0], table[:, 1]).max(initial=0.0))
        x, y = np.repeat(table[:, :2].T, self.count // max(1, self.mounts), axis=1)
        dx, dy = table[:, 2:].reshape(-1, 2).T
        self._starts, self._headings = np.stack([x, y, x, y]), np.stack([dx, dy])
        # of a point (x, y, 1): how far across each ray it lies, how far along
        self._across = np.stack([-dy, dx, dy * x - dx * y], axis=1)
        self._along = np.stack([dx, dy, -dx * x - dy * y], axis=1)
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
        # a touch may come with any product up to this; `measured` then decides
        bound = TOUCH * (4 * float(abs(seen).max(initial=0.0)) + 10)
        for first in range(0, len(owners), self._block):
            some = points[:, first : first + self._block]
            product = self._across @ some[:3]
            product *= self._across @ some[3:]
            ray, wall = np.divmod(np.flatnonzero(product <= bound), some.shape[1])
            wall += first
            ends = seen.take(wall, axis=1)
            self._measure(ray, owners[wall], ends, out)
            if heard is not None:
                back = ~(self._steepness(ray, ends) < steep)  # a post has no steepness
                self._measure(ray[back], owners[wall[back]], seen.take(wall[back], axis=1), heard)

    def meet_robots(self, owners: Int, radius: Float, seen: Float, out: Float) -> None:
        """Shorten ranges by outlines of a `radius` (P,) [m]: middle and corners (2 + 2 C, P)."""
        points = np.ones((3, len(owners)))
        points[:2] = seen[:2]
        radius = radius + TOUCH
        along = self._along @ points
        meets = (abs(self._across @ points) <= radius) & (along >= -radius)
        meets &= along - radius <= out[owners].T
        ray, robot = np.nonzero(meets)
        if len(ray):
            ends = sides(seen[2:].take(robot, axis=1))
            corners = len(seen) // 2 - 1
            self._measure(np.tile(ray, corners), np.tile(owners[robot], corners), ends, out)

    def _steepness(self, ray: Int, ends: Float) -> Float:
        """Return the sine of the angle between each ray and its segment."""
        dx, dy = self._headings.take(ray, axis=1)
        ex, ey = ends[2] - ends[0], ends[3] - ends[1]
        with np.errstate(invalid="ignore"):
            sine: Float = abs(dx * ey - dy * ex) / np.hypot(ex, ey)
        return sine

    def _measure(self, ray: Int, owner: Int, ends: Float, out: Float) -> None:
        ends -= self._starts.take(ray, axis=1)
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
