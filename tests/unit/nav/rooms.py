"""Rooms, and the sensors of a robot in them, without errors."""

from math import inf, pi

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.maps import LineMap
from pioneer3.nav.beams import Beams, beams_of
from pioneer3.nav.likelihood_sonar import Pings
from pioneer3.state import Scan

Float = NDArray[np.float64]

MOUNTS = np.array([(0.2, 0.0, angle) for angle in np.radians([-90, -50, -10, 10, 50, 90])])


def room(*corners: tuple[float, float]) -> Float:
    """Return the walls between corners in order, the last and the first joined."""
    ends = np.array([*corners, corners[0]])
    return np.hstack([ends[:-1], ends[1:]])


FLAT = LineMap(
    name="flat",
    walls=np.vstack(
        [
            room((0, 0), (8, 0), (8, 5), (0, 5)),
            [[4, 0, 4, 2], [4, 3, 4, 5]],
            [[1, 3.5, 2, 3.5], [6.5, 1, 6.5, 2.2], [5, 4.2, 5, 5]],
        ]
    ),
)
"""Two rooms and a doorway."""
SYMMETRICAL = LineMap(name="symmetrical", walls=room((0, 0), (7, 0), (7, 4), (0, 4)))
"""A room that looks the same from its other end."""


def cast(walls: Float, origin: tuple[float, float], angles: Float) -> tuple[Float, Float]:
    """Return the ranges to the nearest wall [m], `inf` where there is none, and how it is met.

    That is the cosine between the ray and the normal of the wall; both are of shape (A,).
    """
    ahead = np.stack([np.cos(angles), np.sin(angles)], axis=1)[:, None]
    start, along = walls[None, :, :2] - origin, (walls[:, 2:] - walls[:, :2])[None]
    cross = ahead[..., 0] * along[..., 1] - ahead[..., 1] * along[..., 0]
    with np.errstate(all="ignore"):
        way = (start[..., 0] * along[..., 1] - start[..., 1] * along[..., 0]) / cross
        share = (start[..., 0] * ahead[..., 1] - start[..., 1] * ahead[..., 0]) / cross
        met = (way > 0) & (share >= 0) & (share <= 1)
    ways = np.where(met, way, inf)
    cosines = abs(cross) / np.hypot(along[..., 0], along[..., 1])
    rays, nearest = np.arange(len(angles)), ways.argmin(axis=1)
    return ways[rays, nearest], cosines[rays, nearest]


def echo(walls: Float, origin: tuple[float, float], axis: float) -> float:
    """Return the range of a transducer that hears walls within 27 degrees of a right angle [m]."""
    ranges, cosines = cast(walls, origin, axis + np.radians([-15.0, -7.5, 0.0, 7.5, 15.0]))
    return float(np.where(cosines > np.cos(np.radians(27)), ranges, inf).min())


def beams(
    line_map: LineMap, truth: Pose2, odom: Pose2, *, stamp: float = 0.0, near: float = inf
) -> Beams:
    """Return a scan of 181 readings at `truth`; to the left something stands `near` [m]."""
    angles = np.linspace(-pi / 2, pi / 2, 181)
    ranges, _ = cast(line_map.walls, (truth.x, truth.y), truth.theta + angles)
    ranges[90:] = np.minimum(ranges[90:], near)
    scan = Scan(
        stamp=stamp,
        sequence=0,
        robot_in_odom=odom,
        sensor_in_robot=ORIGIN,
        angles=tuple(angles.tolist()),
        ranges=tuple(ranges.tolist()),
        far=30.0,
    )
    return beams_of(scan)


def pings(line_map: LineMap, truth: Pose2, odom: Pose2) -> Pings:
    """Return what six narrow transducers hear at `truth`."""
    ranges = []
    for x, y, theta in MOUNTS.tolist():
        at = truth @ Pose2(x, y, theta)
        ranges.append(echo(line_map.walls, (at.x, at.y), at.theta))
    heard = np.where(np.array(ranges) > 5.0, inf, ranges)
    return Pings(stamp=0.0, robot_in_odom=odom, mounts=MOUNTS, ranges=heard)
