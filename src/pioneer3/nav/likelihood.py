"""How well scans fit a map of walls, and the poses at which they fit best."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from pioneer3.arrays import Float, Int32
from pioneer3.jit import fast
from pioneer3.maps import LineMap
from pioneer3.maps.line_map import OCCUPIED
from pioneer3.maps.materials import GLASS
from pioneer3.nav.beams import Beams
from pioneer3.nav.kernels import CACHE
from pioneer3.nav.kernels.scans import judge_poses, number_walls, refine_poses, weigh_poses
from pioneer3.nav.raster import DistanceField, sparse

FIELD_CELL = 0.025
"""Side of a cell of the distances for lasers [m]."""
FIELD_REACH = 0.5
"""Longest of the distances for lasers [m]."""
WALL_SIGMA = 0.05
"""Standard deviation of a point of a scan from the walls of the map [m]."""
WALL_REACH = 0.15
"""Distance from all walls that a point counts with at most [m]: people and things are not mapped.
"""
INDEPENDENT_READINGS = 15.0
"""Readings that a scan counts as: errors of neighbors and of the map are alike."""
SCALES = (0.5, 0.5, 0.5, 0.3, 0.3, 0.2, 0.2, 0.15, 0.1, 0.1, 0.07, 0.05, 0.05)
"""Distances from walls at which points lose their weight, step by step of a refinement [m]."""
LAST_SCALES = (0.15, 0.1, 0.07, 0.05, 0.05)
"""Distances at which points lose their weight where the pose is known within a few centimeters [m].
"""
AGREEMENT = 0.1
"""Distance to a wall within which a point agrees with it [m]."""
AGREEMENT_SHARE = 0.015
"""Share of its range within which a point agrees with a wall."""
THROUGH_DEPTH = 0.2
"""Depth behind a wall from which on a beam that ends there contradicts the map [m]."""
SHORT_WEIGHT = 0.25
"""Share of a beam that meets something nearer than the map: a person agrees with any place."""
CONTRADICTION = 2.0
"""Negative logarithm of the likelihood of a beam that does not agree at all."""


@dataclass(frozen=True, slots=True, eq=False)
class WallField:
    """Walls (W, 4) [m], and for each place of the map the nearest one and how far it is.

    Attributes:
        facing: Their free sides, of length 1; (0, 0) where both are free; shape (W, 2).
        numbers: The wall nearest to each cell from 1 on, 0 beyond the reach of `field`, (H, W).
    """

    walls: Float
    facing: Float
    field: DistanceField
    numbers: Int32

    @classmethod
    def of(cls, walls: Float, line_map: LineMap, cell: float, reach: float) -> Self:
        """Return the field of `walls` (W, 4) [m] over the bounds of a map."""
        field = DistanceField.of(walls, line_map.bounds, cell, reach)
        numbers = sparse(field.raster.shape, np.int32)
        fast(number_walls, CACHE)(walls, field.frame, field.distances, numbers)
        return cls(walls, free_sides(walls, line_map), field, numbers)

    @classmethod
    def for_lasers(cls, line_map: LineMap) -> Self:
        """Return the field of the walls that stop light."""
        opaque = line_map.walls[line_map.materials != GLASS]
        return cls.of(opaque, line_map, FIELD_CELL, FIELD_REACH)


@dataclass(frozen=True, slots=True, eq=False)
class Agreement:
    """How beams agree with the map at P poses; all of shape (P,).

    Attributes:
        agree: Number of echoes at walls, also of those behind something that was carried off.
        short: Of those from something that is not on the map, before its walls.
        through: Of other beams that go on behind a wall.
        misfit: Mean square of the distances of the echoes at walls, as a share of the limit.
    """

    agree: Float
    short: Float
    through: Float
    misfit: Float

    @property
    def agreement(self) -> Float:
        """Share of beams that agree with the map, 0 to 1; short ones count half."""
        count = self.agree + self.short + self.through
        good: Float = (self.agree + SHORT_WEIGHT * self.short) / np.maximum(count, 1.0)
        return good

    @property
    def log_likelihood(self) -> Float:
        """Logarithm of the likelihood, as of `INDEPENDENT_READINGS` beams."""
        count = self.agree + self.short + self.through
        short = (1 - SHORT_WEIGHT) * self.short
        cost = 0.5 * self.misfit * self.agree + CONTRADICTION * (short + self.through)
        likelihood: Float = -cost * INDEPENDENT_READINGS / np.maximum(count, 1.0)
        return likelihood


@dataclass(frozen=True, slots=True, eq=False)
class ScanLikelihood:
    """The likelihood of one scan on a map.

    Attributes:
        points: Of the scan, in the robot's frame [m], shape (N, 2).
        clear: Ends of the free part of beams that met nothing [m], shape (M, 2).
        origin: Of the beams [m], shape (2,).
        weighed: A few of the points, shape (K, 2).
    """

    walls: WallField
    points: Float
    clear: Float
    origin: Float
    weighed: Float

    @classmethod
    def of(cls, walls: WallField, beams: Beams, count: int = 60) -> Self:
        """Return the likelihood of a scan; weigh and judge `count` of its beams."""
        clear = beams.free
        total = len(beams.points) + len(clear)
        share = min(1.0, count / max(1, total))
        return cls(
            walls,
            np.ascontiguousarray(beams.points),
            _some(clear, round(share * len(clear))),
            np.ascontiguousarray(beams.origin),
            _some(beams.points, round(share * len(beams.points))),
        )

    def cost(self, poses: Float) -> Float:
        """Return the negative logarithm of the likelihood at `poses` (P, 3), shape (P,)."""
        out = np.empty(len(poses))
        field = self.walls.field.distances, self.walls.field.frame
        fast(weigh_poses, CACHE)(field, self.weighed, poses, (WALL_SIGMA, WALL_REACH), out)
        out *= min(1.0, INDEPENDENT_READINGS / max(1, len(self.weighed)))
        return out

    def refined(
        self,
        poses: Float,
        information: Float,
        scales: tuple[float, ...] = SCALES,
        *,
        all_points: bool = False,
    ) -> tuple[Float, Float]:
        """Return the poses (P, 3) near `poses` at which the scan fits best, and their information.

        The beginnings have the `information` (3, 3), the results some of shape (P, 3, 3). Points
        lose their weight at the distances `scales` [m], step by step; a few of them are looked at,
        or `all_points`.
        """
        best, out = poses.copy(), np.empty((len(poses), 3, 3))
        walls, points = self.walls, self.points if all_points else self.weighed
        surface = walls.walls, walls.facing, walls.numbers, walls.field.frame
        prior = information, WALL_SIGMA, np.array(scales)
        fast(refine_poses, CACHE)(surface, (points, self.origin), best, prior, out)
        return best, out

    def judged(self, poses: Float) -> Agreement:
        """Return how beams agree with the map at `poses` (P, 3)."""
        out = np.empty((len(poses), 4))
        w = self.walls
        surface = w.walls, w.field.distances, w.numbers, w.field.frame
        beams = self.weighed, self.clear, self.origin
        fast(judge_poses, CACHE)(
            surface, beams, poses, (AGREEMENT, AGREEMENT_SHARE, THROUGH_DEPTH), out
        )
        return Agreement(*out.T)


def _some(points: Float, count: int) -> Float:
    """Return `count` of `points` (N, 2), evenly among them."""
    if count >= len(points):
        return np.ascontiguousarray(points)
    chosen: Float = points[np.linspace(0, len(points) - 1, max(count, 0)).round().astype(np.intp)]
    return np.ascontiguousarray(chosen)


def free_sides(walls: Float, line_map: LineMap) -> Float:
    """Return the directions from walls (W, 4) to their free sides, (W, 2).

    Walls that do not outline occupied cells have the direction (0, 0).
    """
    along = walls[:, 2:] - walls[:, :2]
    length = np.hypot(along[:, 0], along[:, 1])
    normals = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.maximum(length, 1e-9)[:, None]
    middles = (walls[:, :2] + walls[:, 2:]) / 2
    sides = np.zeros_like(normals)
    for grid in line_map.grids:
        half = grid.resolution / 2
        # the middle of a long side may lie on the edge of a cell
        middle = middles + 0.1 * half * (along / np.maximum(length, 1e-9)[:, None])
        beside = ((middle + sign * half * normals).T for sign in (1, -1))
        left, right = (grid.states_at(x, y) == OCCUPIED for x, y in beside)
        sides[right & ~left] = normals[right & ~left]
        sides[left & ~right] = -normals[left & ~right]
    return sides
