"""What a map is made of: scans at poses, and what is known of the ways between them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.nav.beams import Beams
from pioneer3.nav.matching import Cloud

Float = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class KeyFrame:
    """A scan that is kept.

    Attributes:
        beams: The scan.
        cloud: Its points, for matching.
        way: How far the robot had driven [m].
        turn: How far it had turned, either way [rad].
    """

    beams: Beams
    cloud: Cloud
    way: float
    turn: float


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
