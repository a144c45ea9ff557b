"""Finds the pose from which a scan fits the scans before it: point to line, odometry as a prior."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import ceil, cos, pi, sin
from typing import Self

import numpy as np

from pioneer3.arrays import Float, Int, UInt8
from pioneer3.geometry import Pose2, wrap
from pioneer3.jit import fast
from pioneer3.nav.beams import Beams
from pioneer3.nav.kernels import CACHE
from pioneer3.nav.kernels.matching import align, search, smear, sort_into
from pioneer3.nav.kernels.normals import normals_of, thinned

POINT_RANGE = 30.0
"""Range beyond which points are too sparse to show walls [m]."""
POINTS_APART = 0.03
"""Distance below which neighbouring points of a scan say nothing new [m]."""
MOST_POINTS = 360
"""Points of a scan that are matched at most."""
NEIGHBOURS = 4
"""Points on each side that a line is fitted over at least."""
LINE_REACH = 0.3
"""Distance within which all points are fitted over [m]."""
LINE_ROUGHNESS = 0.03
"""Distance of a wall's points from it [m, RMS]: noise, and the steps of a wall that was drawn in
pixels."""
WIDTHS = np.array([0.3, 0.15, 0.07])
"""Widths of the robust weights [m]: from the error of a search to three times the noise of a laser.
"""
TARGET_REACH = 0.2
"""Distance as far away as which a target is looked for [m]: about that of points 10 m away."""
POINT_SIGMA = 0.02
"""Standard deviation of a point from a wall [m]: the noise of a laser, and the roughness of walls.
"""
TARGET_CELL = 0.15
"""Side of the cells in which targets are looked for [m]."""
FINE_CELL = 0.05
"""Side of the cells of a search [m]."""
FINE_TURN = 0.0087
"""Turns of a search [rad]."""
COARSE_CELL = 2 * FINE_CELL
"""Side of the cells of a search of all headings [m]: each is worth the best of four fine ones."""
COARSE_TURN = 0.0175
"""Turns of a search of all headings [rad]."""
MOST_LEVELS = 6
"""Times that a block of a search is halved at most until it is a cell."""
HEADING_SECTORS = 12
"""Sectors of headings, each of which has a best pose of its own."""
KEPT = 0.8
"""Share of the worth of the best pose below which another is no rival."""
NOTHING = -1e17
"""Worth [sum] below which no pose was looked for in a sector."""
SEARCH_BLUR = 0.06
"""Distance to a wall as far as which a point counts for a search [m, sigma]."""
SHIFT_COST = 0.15
"""Cost of the largest shift or turn of a search, as a share of a perfect fit."""


Place = tuple[Pose2, float]
"""A pose, and what it is worth."""


@dataclass(frozen=True, slots=True, eq=False)
class Cloud:
    """The points of a scan (N, 2) [m] in the robot's frame, with the walls that they lie on.

    The normals of these (N, 2) are zeros where none was found.
    """

    points: Float
    normals: Float

    @classmethod
    def of(cls, beams: Beams) -> Self:
        """Return the points of a scan, thinned out."""
        points = np.ascontiguousarray(beams.points)
        points = points[np.hypot(*(points - beams.origin).T) < POINT_RANGE]
        kept = np.zeros(len(points), dtype=np.bool_)
        fast(thinned, CACHE)(points, POINTS_APART, kept)
        points = points[kept]
        normals = lines_at(points, beams.origin)[:, :2]
        every = ceil(len(points) / MOST_POINTS) or 1
        return cls(np.ascontiguousarray(points[::every]), np.ascontiguousarray(normals[::every]))

    def moved(self, pose: Pose2) -> Self:
        """Return the points in the frame of which `pose` is the robot's."""
        turn = rotation(pose.theta)
        return type(self)(self.points @ turn.T + (pose.x, pose.y), self.normals @ turn.T)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Match:
    """Where a scan fits.

    Attributes:
        pose: Of the robot in the frame of the submap.
        information: Of `pose`, by the points alone, shape (3, 3): x, y, theta.
        inliers: Share of the points that lie on a wall of the submap.
    """

    pose: Pose2
    information: Float
    inliers: float

    @property
    def ratio(self) -> float:
        """The smaller over the larger eigenvalue of the position's information: 0 in corridors."""
        turning = self.information[2, 2]
        if turning <= 0:
            return 0.0
        cross = self.information[:2, 2]
        low, high = np.linalg.eigvalsh(self.information[:2, :2] - np.outer(cross, cross) / turning)
        return float(max(0.0, low) / high) if high > 0 else 0.0

    def share(self, prior: "Prior") -> float:
        """Return the share of the points in the way ahead, 0 to 1; the rest is by a prior."""
        ahead = np.array([cos(self.pose.theta), sin(self.pose.theta), 0.0])
        both = self.information + prior.information
        return float(ahead @ np.linalg.solve(both, self.information) @ ahead)


@dataclass(frozen=True, slots=True, eq=False)
class Prior:
    """A pose that is expected in the frame of a submap, and its information (3, 3)."""

    pose: Pose2
    information: Float

    @classmethod
    def around(cls, pose: Pose2, sigma: float, sigma_theta: float) -> Self:
        """Return a prior with standard deviations [m, rad]."""
        return cls(pose, np.diag([sigma**-2, sigma**-2, sigma_theta**-2]))

    def joined(self, other: Self) -> Self:
        """Return the two combined."""
        both = self.information + other.information
        x, y, theta = np.linalg.solve(both, other.information @ self._off(other.pose)).tolist()
        pose = Pose2(self.pose.x + x, self.pose.y + y, wrap(self.pose.theta + theta))
        return type(self)(pose, both)

    def squared_error(self, pose: Pose2) -> float:
        """Return how far a pose is from the expected one [squared sigmas]."""
        off = self._off(pose)
        return float(off @ self.information @ off)

    def _off(self, pose: Pose2) -> Float:
        mean = self.pose
        return np.array([pose.x - mean.x, pose.y - mean.y, wrap(pose.theta - mean.theta)])


class Submap:
    """The points of some scans, seen from the robot's pose at each, to match others against."""

    def __init__(self, clouds: Sequence[Cloud], poses: Sequence[Pose2]) -> None:
        moved = [cloud.moved(pose) for cloud, pose in zip(clouds, poses, strict=True)]
        self._points = np.concatenate([cloud.points for cloud in moved] or [np.empty((0, 2))])
        normals = np.concatenate([cloud.normals for cloud in moved] or [np.empty((0, 2))])
        straight = (normals[:, 0] != 0) | (normals[:, 1] != 0)
        points = self._points[straight]
        low, self._shape = _box(points, TARGET_CELL)
        columns, rows = ((points - low) / TARGET_CELL).astype(np.int64).T
        cells = rows * self._shape[1] + columns
        self._grid = np.array([*low, TARGET_CELL])
        self._starts = np.zeros(int(self._shape.prod()) + 1, dtype=np.int64)
        order = np.empty(len(points), dtype=np.int64)
        fast(sort_into, CACHE)(cells, self._starts, order)
        self._targets = np.concatenate([points, normals[straight]], axis=1)[order]
        self._pyramid: tuple[Float, UInt8] | None = None

    def match(self, cloud: Cloud, guess: Pose2, prior: Prior) -> Match:
        """Return where a scan fits near `guess`."""
        pose = np.array([guess.x, guess.y, guess.theta])
        mean = prior.pose
        # the same turn, written so that the difference to the guess is the short way
        theta = guess.theta + wrap(mean.theta - guess.theta)
        information = np.zeros((3, 3))
        inliers = fast(align, CACHE)(
            self._starts,
            self._targets,
            self._grid,
            self._shape,
            np.concatenate([cloud.points, cloud.normals], axis=1),
            pose,
            np.array([mean.x, mean.y, theta]),
            np.ascontiguousarray(prior.information),
            WIDTHS,
            TARGET_REACH,
            POINT_SIGMA,
            information,
        )
        x, y, theta = pose.tolist()
        return Match(pose=Pose2(x, y, wrap(theta)), information=information, inliers=float(inliers))

    def search(self, points: Float, guess: Pose2, way: float, turn: float) -> Pose2:
        """Return the best pose within `way` [m] and `turn` [rad] of `guess`."""
        found = self.search_for(points, guess, way, turn, worth=NOTHING)
        assert found is not None
        return found

    def search_for(
        self, points: Float, guess: Pose2, way: float, turn: float, worth: float
    ) -> Pose2 | None:
        """Return the best pose within `way` [m] and `turn` [rad] of `guess`, if worth that much.

        The worth is 1 where all points lie on walls, less up to `SHIFT_COST` for shift and turn.
        """
        found = self._search(points, guess, (way, turn), cost=SHIFT_COST, sectors=1, least=worth)
        return found[0][0] if found else None

    def search_all_headings(self, points: Float, guess: Pose2, way: float) -> list[Place]:
        """Return the best poses within `way` [m] of `guess`, one in each sector, the best first.

        Those are left out that are worth less than `KEPT` of the best one.
        """
        found = self._search(points, guess, (way, pi), cost=0.0, sectors=HEADING_SECTORS)
        return sorted(found, key=lambda each: -each[1])

    def _search(
        self,
        points: Float,
        guess: Pose2,
        within: tuple[float, float],
        *,
        cost: float,
        sectors: int,
        least: float = NOTHING,
    ) -> list[Place]:
        """Return the best pose in each of so many `sectors` of headings, and its worth.

        Those are left out that are worth less than `least`.
        """
        way, turn = within
        coarse = int(sectors > 1)
        cell, apart = (COARSE_CELL, COARSE_TURN) if coarse else (FINE_CELL, FINE_TURN)
        shift = max(1, ceil(way / cell))
        # up to three blocks side by side
        levels = min(MOST_LEVELS, shift.bit_length() + coarse)
        if self._pyramid is None or len(self._pyramid[1]) <= levels:
            self._pyramid = self._smeared(levels)
        grid, pyramid = self._pyramid
        if coarse:
            pyramid = np.ascontiguousarray(pyramid[1:, ::2, ::2])
        half = max(1, ceil(turn / apart))
        turns: Float = apart * np.arange(-half, half + 1, dtype=np.float64)
        c, s = np.cos(guess.theta + turns), np.sin(guess.theta + turns)
        x = np.outer(c, points[:, 0]) - np.outer(s, points[:, 1]) + guess.x
        y = np.outer(s, points[:, 0]) + np.outer(c, points[:, 1]) + guess.y
        cells = np.floor(np.stack([y - grid[1], x - grid[0]], axis=2) / cell).astype(np.int64)
        full = 255.0 * max(1, len(points))
        limits = np.array([float(shift), half * apart, cost * full, max(NOTHING, least * full)])
        sector = np.arange(len(turns), dtype=np.int64) * sectors // len(turns)
        best, worths = np.zeros((sectors, 3), dtype=np.int64), np.empty(sectors)
        fast(search, CACHE)(pyramid, cells, turns, sector, KEPT, limits, best, worths)
        return [
            (
                Pose2(
                    guess.x + cell * column,
                    guess.y + cell * row,
                    wrap(guess.theta + float(turns[a])),
                ),
                worth / full,
            )
            for (a, row, column), worth in zip(best.tolist(), worths.tolist(), strict=True)
            if worth > NOTHING
        ]

    def _smeared(self, levels: int) -> tuple[Float, UInt8]:
        """Return the grid of a search and its pyramid: see :func:`.kernels.matching.search`."""
        profile = _profile()
        margin = FINE_CELL * (len(profile) + 2**levels)
        low, shape = _box(self._points, FINE_CELL, margin)
        grid = np.array([*low, FINE_CELL])
        pyramid = np.zeros((levels + 1, int(shape[0]), int(shape[1])), dtype=np.uint8)
        fast(smear, CACHE)(self._points, grid, profile, pyramid[0])
        for level in range(levels):
            step, pooled = 2**level, pyramid[level + 1]
            pooled[:] = pyramid[level]
            pooled[:-step] = np.maximum(pooled[:-step], pooled[step:])
            pooled[:, :-step] = np.maximum(pooled[:, :-step], pooled[:, step:])
        return grid, pyramid


def lines_at(points: Float, origin: Float, rough: float = LINE_ROUGHNESS) -> Float:
    """Return the lines through the points of a scan, see :func:`.kernels.normals.normals_of`."""
    lines = np.empty((len(points), 3))
    fast(normals_of, CACHE)(points, origin, NEIGHBOURS, LINE_REACH, rough, lines)
    return lines


def rotation(theta: float) -> Float:
    """Return the matrix, shape (2, 2)."""
    c, s = cos(theta), sin(theta)
    return np.array([[c, -s], [s, c]])


def _box(points: Float, cell: float, margin: float = 0.0) -> tuple[Float, Int]:
    """Return lower left corner [m], rows and columns of the cells around points."""
    if not len(points):
        return np.zeros(2), np.ones(2, dtype=np.int64)
    # columns one by one: numpy takes ten times as long along the other axis
    low = np.array([points[:, 0].min(), points[:, 1].min()]) - margin
    high = np.array([points[:, 0].max(), points[:, 1].max()]) + margin
    shape: Int = np.floor((high - low) / cell).astype(np.int64)[::-1] + 1
    return low, shape


@lru_cache
def _profile() -> UInt8:
    """Return the likelihood around a point, 255 at most."""
    half = ceil(2.5 * SEARCH_BLUR / FINE_CELL)
    off = FINE_CELL * np.arange(-half, half + 1)
    squared = off[:, None] ** 2 + off**2
    values: UInt8 = np.rint(255 * np.exp(-squared / (2 * SEARCH_BLUR**2))).astype(np.uint8)
    return values
