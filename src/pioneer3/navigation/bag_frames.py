"""The frames of a bag: which is on which, where a laser is, and whose motion is odometry."""

from dataclasses import dataclass, replace
from math import atan2, isfinite, radians
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.nav.logged import is_mount, is_pose
from pioneer3.robot.lasers.mounting import Mounting
from pioneer3.state import Scan

Matrix = NDArray[np.float64]

ODOM = "odom"
"""Part of the name of a frame in which odometry tells poses."""
LEVEL = np.cos(radians(20))
"""Cosine of the tilt up to which a laser is level."""
STILL = 1e-6
"""Difference up to which two transforms are the same [m]."""


@dataclass(frozen=True, slots=True)
class FramePair:
    """A frame on another one."""

    parent: str
    child: str


def mounted(scan: Scan, mounting: Mounting) -> Scan:
    """Return a scan of a laser that is in another place than was said."""
    if not mounting.upside_down:
        return replace(scan, sensor_in_robot=mounting.sensor_in_robot)
    return replace(
        scan,
        stamp=scan.stamp + scan.beam_time * (len(scan.angles) - 1),
        sensor_in_robot=mounting.sensor_in_robot,
        angles=tuple(-angle for angle in reversed(scan.angles)),
        ranges=scan.ranges[::-1],
        beam_time=-scan.beam_time,
    )


class BagFrames:
    """The tree of frames, as transforms tell it."""

    def __init__(self) -> None:
        self._parents: dict[str, str] = {}
        self._matrices: dict[str, Matrix] = {}
        self._moving: set[str] = set()

    def take(self, edge: FramePair, transform: Any) -> None:
        """Take a transform, a message of ROS; of a frame that moves the first one counts."""
        matrix = matrix_of(transform.translation, transform.rotation)
        if matrix is None or edge.child == edge.parent:
            return
        old = self._matrices.get(edge.child)
        if old is None:
            self._parents[edge.child], self._matrices[edge.child] = edge.parent, matrix
        elif np.abs(old - matrix).max() > STILL:
            self._moving.add(edge.child)

    def odometry(self, frame: str) -> FramePair | None:
        """Return the edge whose motion is the odometry of what carries a frame.

        It is the first below a frame with `odom` in its name, else the uppermost that moves.
        """
        edges = self._above(frame)
        named = [edge for edge in edges if is_odom(edge.parent)]
        moving = [edge for edge in edges if edge.child in self._moving]
        return named[0] if named else moving[-1] if moving else None

    def mounting(self, frame: str, base: str) -> Mounting | None:
        """Return where a laser is on the frame of a robot, or `None` if no transform tells it."""
        matrix = self._matrix(frame, base)
        if matrix is None or not is_mount(_flat(matrix)):
            return None
        return Mounting(sensor_in_robot=_flat(matrix), upside_down=bool(matrix[2, 2] < 0))

    def is_level(self, frame: str, base: str) -> bool:
        """Whether a laser measures a level plane, as far as transforms tell it."""
        matrix = self._matrix(frame, base)
        return matrix is None or bool(abs(matrix[2, 2]) >= LEVEL)

    def _matrix(self, frame: str, base: str) -> Matrix | None:
        """Return the transform from a frame to one that carries it."""
        matrix: Matrix = np.eye(4)
        if frame == base:
            return matrix
        for edge in self._above(frame):
            matrix = self._matrices[edge.child] @ matrix
            if edge.parent == base:
                return matrix
        return None

    def _above(self, frame: str) -> list[FramePair]:
        """Return the edges from a frame up to the root."""
        edges: list[FramePair] = []
        while (parent := self._parents.get(frame)) and len(edges) <= len(self._parents):
            edges.append(FramePair(parent, frame))
            frame = parent
        return edges


def is_odom(frame: str) -> bool:
    """Whether a frame is one in which odometry tells poses, by its name."""
    return ODOM in frame.rpartition("/")[2].lower()


def frame_name(text: str) -> str:
    """Return the name of a frame without the slash that tf had before it."""
    return text.strip().lstrip("/")


def pose_of(place: Any, rotation: Any) -> Pose2 | None:
    """Return a pose of ROS on the plane; `None` if it cannot be one."""
    matrix = matrix_of(place, rotation)
    pose = None if matrix is None else _flat(matrix)
    return pose if pose is not None and is_pose(pose) else None


def _flat(matrix: Matrix) -> Pose2:
    """Return where a transform puts the origin, and where its x axis looks, seen from above."""
    return Pose2(float(matrix[0, 3]), float(matrix[1, 3]), float(atan2(matrix[1, 0], matrix[0, 0])))


def matrix_of(place: Any, rotation: Any) -> Matrix | None:
    """Return a transform as a matrix (4, 4); `None` if it is not finite.

    A quaternion without a length, which empty messages have, turns nothing.
    """
    x, y, z, w = rotation.x, rotation.y, rotation.z, rotation.w
    length = x * x + y * y + z * z + w * w
    if not (isfinite(length) and isfinite(place.x + place.y + place.z)):
        return None
    s = 2.0 / length if length > STILL else 0.0
    return np.array(
        [
            [1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w), place.x],
            [s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w), place.y],
            [s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y), place.z],
            [0.0, 0.0, 0.0, 1.0],
        ]
    )
