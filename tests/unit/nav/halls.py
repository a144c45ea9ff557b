"""Rooms to look around in, for tests of map making."""

from math import pi

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.nav.beams import Beams
from pioneer3.sim.raycast import ranges_reference

Float = NDArray[np.float64]

FAR = 30.0

HALL = np.array(
    [
        [0.0, 0.0, 12.0, 0.0],
        [12.0, 0.0, 12.0, 8.0],
        [12.0, 8.0, 0.0, 8.0],
        [0.0, 8.0, 0.0, 0.0],
        # a block in the middle makes a way around it
        [4.0, 3.0, 8.0, 3.0],
        [8.0, 3.0, 8.0, 5.0],
        [8.0, 5.0, 4.0, 5.0],
        [4.0, 5.0, 4.0, 3.0],
        # and a corner that is unlike the others
        [0.0, 1.5, 1.0, 1.5],
        [1.0, 1.5, 1.0, 0.0],
    ]
)
"""Walls [m]."""
ROUND = [Pose2(2.0 + 0.25 * k, 1.5, 0.0) for k in range(29)]
ROUND += [Pose2(9.5, 1.5 + 0.25 * k, pi / 2) for k in range(1, 20)]
ROUND += [Pose2(9.5 - 0.25 * k, 6.5, pi) for k in range(1, 30)]
ROUND += [Pose2(2.0, 6.5 - 0.25 * k, -pi / 2) for k in range(1, 20)]
"""A way around the block."""


def look(
    walls: Float,
    robot_in_world: Pose2,
    robot_in_odom: Pose2 = ORIGIN,
    *,
    noise: float = 0.0,
    rng: np.random.Generator | None = None,
    count: int = 361,
) -> Beams:
    """Return what a laser sees that looks all around from the middle of a robot."""
    angles = np.linspace(-pi, pi, count)[:-1]
    place = np.array([robot_in_world.x, robot_in_world.y])
    ranges = ranges_reference(place, robot_in_world.theta + angles, walls, FAR).min(axis=1)
    seen = ranges < FAR
    if noise and rng is not None:
        ranges = ranges + noise * rng.standard_normal(len(ranges))
    ends = ranges[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return Beams(
        stamp=0.0,
        robot_in_odom=robot_in_odom,
        points=ends[seen],
        clear=ends[~seen],
        origin=np.zeros(2),
        far=FAR,
    )
