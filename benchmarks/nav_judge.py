"""How well poses and maps agree with the truth, or with themselves."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import degrees, hypot
from statistics import median

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates
from scipy.spatial import cKDTree

from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap, OccupancyGrid
from pioneer3.maps.grid import samples
from pioneer3.nav.beams import Beams
from pioneer3.nav.matching import lines_at, rotation
from pioneer3.nav.raster import DistanceField
from pioneer3.nav.rendering import line_map_of

Float = NDArray[np.float64]

SAMPLE = 0.02
"""Walls are compared at points so far apart [m]."""
SEEN, SEEN_TIMES = 0.03, 3
"""A wall was seen where so many echoes are so near [m]."""
OTHER_PASS = 30.0
"""Two scans are of different passes if the robot drove so far between them [m]."""
SAME_WALL = 0.3
"""Of two passes, points nearer than this [m] are of one wall."""


@dataclass(frozen=True, slots=True, eq=False)
class Alignment:
    """The motion that brings one trajectory closest to another."""

    turn: Float
    shift: Float

    @classmethod
    def of(cls, places: Float, truth: Float) -> "Alignment":
        """Return the alignment of places (N, 2) with the truth (N, 2)."""
        mean, true_mean = places.mean(axis=0), truth.mean(axis=0)
        u, _, v = np.linalg.svd((places - mean).T @ (truth - true_mean))
        turn = v.T @ np.diag([1.0, float(np.sign(np.linalg.det(v.T @ u.T)))]) @ u.T
        return cls(turn, true_mean - turn @ mean)

    def __call__(self, points: Float) -> Float:
        """Return points as seen from the truth's frame."""
        moved: Float = points @ self.turn.T + self.shift
        return moved


def places_of(poses: Sequence[Pose2]) -> Float:
    """Return the positions, shape (N, 2)."""
    return np.array([(pose.x, pose.y) for pose in poses])


def trajectory_errors(poses: Sequence[Pose2], truth: Sequence[Pose2]) -> Float:
    """Return how far each place is from the true one [m], after alignment."""
    places, true_places = places_of(poses), places_of(truth)
    off = Alignment.of(places, true_places)(places) - true_places
    distances: Float = np.hypot(off[:, 0], off[:, 1])
    return distances


def step_errors(poses: Sequence[Pose2], truth: Sequence[Pose2]) -> tuple[float, float]:
    """Return the median errors of the ways from pose to pose [m, degrees]."""
    off = [
        (c.inverse() @ d).inverse() @ (a.inverse() @ b)
        for a, b, c, d in zip(poses, poses[1:], truth, truth[1:], strict=False)
    ]
    return median(hypot(e.x, e.y) for e in off), median(abs(degrees(e.theta)) for e in off)


def wall_distances(poses: Sequence[Pose2], beams: Sequence[Beams], ways: Float) -> Float:
    """Return the distances of points to the walls that other passes saw there [m].

    Args:
        poses: Of the robot at each scan.
        beams: The scans.
        ways: How far the robot had driven at each [m].
    """
    points, normals, passed = [], [], []
    for pose, one, way in zip(poses, beams, ways.tolist(), strict=True):
        turn, lines = rotation(pose.theta), lines_at(one.points, one.origin)
        straight = lines[:, :2].any(axis=1)
        points.append(one.points[straight] @ turn.T + (pose.x, pose.y))
        normals.append(lines[straight, :2] @ turn.T)
        passed.append(np.full(int(straight.sum()), way))
    at, normal, way_at = (np.concatenate(part) for part in (points, normals, passed))
    _, near = cKDTree(at).query(at[::3], k=60, distance_upper_bound=SAME_WALL)
    known = near < len(at)
    near = np.where(known, near, 0)
    known &= np.abs(way_at[near] - way_at[::3, None]) > OTHER_PASS
    known &= (normal[near] * normal[::3, None]).sum(axis=2) > 0.8
    first, has = known.argmax(axis=1), known.any(axis=1)
    other = near[np.arange(len(near)), first][has]
    off: Float = np.abs(((at[::3][has] - at[other]) * normal[other]).sum(axis=1))
    return off


@dataclass(frozen=True, slots=True)
class WallShares:
    """How well the walls of a map agree with the true ones [%].

    Attributes:
        found: True walls that were seen and are within 5 cm of one on the map.
        false_5: Walls of the map farther than 5 cm from any true wall.
        false_10: The same with 10 cm.
    """

    found: float
    false_5: float
    false_10: float


def wall_shares(grid: OccupancyGrid, align: Alignment, truth: LineMap, echoes: Float) -> WallShares:
    """Compare a map with the true one.

    Args:
        grid: The map.
        align: From its frame to that of the truth.
        truth: The true walls.
        echoes: The ends of beams, as the map has them [m], shape (N, 2).
    """
    drawn = align(samples(line_map_of(grid, truth.name).walls, SAMPLE / 2))
    field = DistanceField.of(truth.walls, truth.bounds, SAMPLE, 0.3)
    at = field.raster.in_cells(drawn).T[::-1] - 0.5
    off = field.reach + map_coordinates(field.distances, at, order=1, mode="constant", cval=0.0)
    true = samples(truth.walls, SAMPLE)
    times = cKDTree(align(echoes)).query_ball_point(true, SEEN, return_length=True)
    missed = cKDTree(drawn).query(true[times >= SEEN_TIMES])[0]
    return WallShares(
        found=100 * float((missed <= 0.05).mean()),
        false_5=100 * float((off > 0.05).mean()),
        false_10=100 * float((off > 0.1).mean()),
    )
