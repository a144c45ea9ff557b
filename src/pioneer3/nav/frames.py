"""Parts of a map: scans at poses, and the ways that were measured between them."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.nav.beams import Beams
from pioneer3.nav.matching import Cloud

Float = NDArray[np.float64]

VIEW = 5.0
"""Distance beyond which things seen count as if they were here [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class KeyFrame:
    """A scan that is kept.

    Attributes:
        beams: The scan.
        cloud: Its points, for matching.
        way: How far the robot had driven [m].
        turn: How far it had turned, left and right added [rad].
        view: The middle of what is near [m], in the robot's frame, shape (2,).
    """

    beams: Beams
    cloud: Cloud
    way: float
    turn: float
    view: Float

    @classmethod
    def of(cls, beams: Beams, cloud: Cloud, way: float, turn: float) -> Self:
        """Return the key frame of a scan."""
        away = np.hypot(*cloud.points.T)
        seen = cloud.points * np.minimum(1.0, VIEW / np.maximum(away, 1e-9))[:, None]
        view = seen.mean(axis=0) if len(seen) else np.zeros(2)
        return cls(beams, cloud, way, turn, view)


@dataclass(frozen=True, slots=True, eq=False)
class Edge:
    """A measured way from one key frame to another.

    Attributes:
        first: Number of a key frame.
        second: Number of the other.
        second_in_first: Pose of the second robot in the frame of the first [m, rad].
        information: Of it, in the frame of the second, shape (3, 3).
        loop: Whether it closes a loop, and so may be wrong altogether.
    """

    first: int
    second: int
    second_in_first: Pose2
    information: Float
    loop: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Survey:
    """All that a map is made of.

    Attributes:
        frames: The key frames.
        poses: Of the robot at each, in the map [m, rad].
        edges: Ways between them; those that are no loops connect them all.
    """

    frames: tuple[KeyFrame, ...]
    poses: tuple[Pose2, ...]
    edges: tuple[Edge, ...]
