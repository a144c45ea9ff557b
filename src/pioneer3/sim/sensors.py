"""What the robot's sensors measure of the world: rays in, ranges out. Knows no wire."""

from math import cos, sin

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.models import SonarMount
from pioneer3.sim.raycast import cast

Float = NDArray[np.float64]

SONAR_RANGE = 5.0
"""What a transducer reports when nothing echoes, and the farthest it hears [m] (arcos.md 7.2)."""
SONAR_MIN = 0.1
"""Nearer echoes come while the transducer still rings [m] (arcos.md 9.6)."""
LASER_RANGE = 32.0
"""Of a SICK LMS-200 in 10 mm mode [m]."""


def sonar_ranges(pose: Pose2, mounts: tuple[SonarMount, ...], walls: Float) -> Float:
    """Return the range per transducer [m], shape (M,), in [:data:`SONAR_MIN`, SONAR_RANGE].

    Args:
        pose: Of the robot in the world.
        mounts: Of the transducers on the robot, M of them.
        walls: Segments `x0, y0, x1, y1` [m], shape (W, 4), at least those within range.
    """
    if not mounts:
        return np.empty(0)
    mount = np.array([(m.x, m.y, m.theta) for m in mounts])
    c, s = cos(pose.theta), sin(pose.theta)
    origins = np.column_stack(
        (pose.x + c * mount[:, 0] - s * mount[:, 1], pose.y + s * mount[:, 0] + c * mount[:, 1])
    )
    ranges = cast(origins, mount[:, 2] + pose.theta, walls, SONAR_RANGE)
    return np.clip(ranges, SONAR_MIN, SONAR_RANGE)


def laser_ranges(pose: Pose2, angles: Float, walls: Float) -> Float:
    """Return the range per beam [m], shape (B,), at most :data:`LASER_RANGE`.

    Args:
        pose: Of the laser in the world.
        angles: Of the beams from straight ahead [rad], counter-clockwise, shape (B,).
        walls: As for :func:`sonar_ranges`.
    """
    origins = np.broadcast_to((pose.x, pose.y), (len(angles), 2))
    return cast(origins, angles + pose.theta, walls, LASER_RANGE)
