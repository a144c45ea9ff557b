"""How well the pings of sonars fit a map."""

from dataclasses import dataclass
from math import ceil, cos, radians
from typing import Self

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.jit import fast
from pioneer3.maps import LineMap
from pioneer3.nav.kernels import CACHE
from pioneer3.nav.kernels.pings import expected_ranges, weigh_ranges
from pioneer3.nav.likelihood import WallField

Float = NDArray[np.float64]
UInt16 = NDArray[np.uint16]

CELL, REACH = 0.05, 1.0
"""Of the distances for sonars [m]."""
PLACE, SECTORS = 0.1, 72
"""Expected ranges are computed once for places of this side [m] and so many directions."""
LONGEST = 5.0
"""Range of the sonars [m]."""
RAYS = np.radians([-15.0, -7.5, 0.0, 7.5, 15.0])
"""That make up a beam, off its axis."""
STEEP = cos(radians(27))
"""Walls echo rays that meet them within this of a right angle."""
SIGMA, SIGMA_SHARE = 0.04, 0.02
"""Standard deviation of a range [m], and as a share of it."""
RIGHT, NEARER, OTHER = 1.0, 0.08, 0.06
"""Likelihoods of the range that the map tells, of a nearer one, and of any."""
INDEPENDENT = 0.4
"""Share of a ping that counts: neighbors are wrong alike."""
FITS = 0.2
"""A range agrees with the map within this [m], or twice its share."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Pings:
    """Firings of sonar transducers.

    Attributes:
        stamp: Time of the report [s, monotonic].
        robot_in_odom: Pose of the robot when they fired [m, rad].
        mounts: Poses of the transducers in the robot's frame [m, rad], shape (F, 3).
        ranges: [m], `inf` where nothing echoed, shape (F,).
    """

    stamp: float
    robot_in_odom: Pose2
    mounts: Float
    ranges: Float


@dataclass(frozen=True, slots=True, eq=False)
class EchoMap:
    """The ranges that transducers are expected to have on a map.

    Attributes:
        walls: Of the map.
        known: Those that have been computed [mm], 0 for the others, shape (H, W, `SECTORS`).
    """

    walls: WallField
    known: UInt16

    @classmethod
    def of(cls, line_map: LineMap) -> Self:
        """Return the map of echoes of all walls; nothing is computed yet."""
        walls = WallField.of(line_map.walls, line_map, CELL, REACH)
        height, width = (ceil(size * CELL / PLACE) for size in walls.numbers.shape)
        return cls(walls, np.zeros((height, width, SECTORS), dtype=np.uint16))

    def expected(self, pings: Float, poses: Float) -> Float:
        """Return the ranges [m] that `pings` (F, 3+) should have at `poses` (P, 3), shape (P, F).

        Those that would echo nothing are longer than `LONGEST`.
        """
        out = np.empty((len(poses), len(pings)))
        w = self.walls
        surface = w.walls, w.field.distances, w.numbers, w.frame
        cone, memory = (RAYS, LONGEST, STEEP), (self.known, PLACE)
        fast(expected_ranges, CACHE)(surface, cone, memory, (pings, poses), out)
        return out


@dataclass(frozen=True, slots=True, eq=False)
class PingLikelihood:
    """The likelihood of pings on a map.

    Attributes:
        echoes: Of the map.
        pings: Places, axes and ranges in the robot's frame [m, rad], shape (F, 4).
    """

    echoes: EchoMap
    pings: Float

    def cost(self, poses: Float) -> Float:
        """Return the negative logarithm of the likelihood at `poses` (P, 3), shape (P,)."""
        out = np.empty(len(poses))
        shape = np.array([LONGEST, SIGMA, SIGMA_SHARE, RIGHT, NEARER, OTHER])
        expected = self.echoes.expected(self.pings, poses)
        fast(weigh_ranges, CACHE)(self.pings[:, 3], expected, shape, out)
        out *= INDEPENDENT
        return out

    def agreeing(self, pose: Float) -> tuple[int, int]:
        """Return the number of echoes that agree with the map at `pose` (3,), and of all."""
        heard = self.pings[:, 3] <= LONGEST
        off = abs(self.echoes.expected(self.pings, pose[None])[0] - self.pings[:, 3])[heard]
        near = np.maximum(FITS, 2 * SIGMA_SHARE * self.pings[heard, 3])
        return int((off < near).sum()), int(heard.sum())
