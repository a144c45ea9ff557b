"""How well the pings of sonars fit a map."""

from dataclasses import dataclass
from math import ceil, cos, radians
from typing import Self

import numpy as np

from pioneer3.arrays import Float, UInt16
from pioneer3.geometry import Pose2
from pioneer3.jit import fast
from pioneer3.maps import LineMap
from pioneer3.nav.kernels import CACHE
from pioneer3.nav.kernels.pings import expected_ranges, weigh_ranges
from pioneer3.nav.likelihood import WallField
from pioneer3.nav.raster import sparse

SONAR_CELL = 0.05
"""Side of a cell of the distances for sonars [m]."""
SONAR_REACH = 1.0
"""Longest of the distances for sonars [m]."""
PLACE_SIDE = 0.1
"""Side of the places for which expected ranges are computed, once [m]."""
SECTORS = 72
"""Directions for which expected ranges are computed at each place."""
SONAR_RANGE = 5.0
"""Range of the sonars [m]."""
RAYS = np.radians([-15.0, -7.5, 0.0, 7.5, 15.0])
"""Rays that make up a beam, off its axis [rad]."""
INCIDENCE = cos(radians(27))
"""Cosine of the angle to a wall's normal within which it echoes rays."""
RANGE_SIGMA = 0.04
"""Standard deviation of a range [m]."""
RANGE_SIGMA_SHARE = 0.02
"""Standard deviation of a range as a share of it."""
RIGHT_LIKELIHOOD = 1.0
"""Likelihood of the range that the map tells."""
NEARER_LIKELIHOOD = 0.08
"""Likelihood of a nearer range than the map tells."""
OTHER_LIKELIHOOD = 0.06
"""Likelihood of any range."""
PING_WEIGHT = 0.4
"""Share of a ping that counts: neighbors are wrong alike."""
RANGE_AGREEMENT = 0.2
"""Difference within which a range agrees with the map [m], or twice its share."""


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

    Those `known` have been computed [mm], 0 for the others, shape (H, W, `SECTORS`).
    """

    walls: WallField
    known: UInt16

    @classmethod
    def of(cls, line_map: LineMap) -> Self:
        """Return the map of echoes of all walls; nothing is computed yet."""
        own = line_map.walls.copy()  # kernels are compiled anew for arrays that are read only
        walls = WallField.of(own, line_map, SONAR_CELL, SONAR_REACH)
        raster = walls.field.raster
        height, width = (ceil(size * raster.cell / PLACE_SIDE) for size in raster.shape)
        return cls(walls, sparse((height, width, SECTORS), np.uint16))

    def expected(self, pings: Float, poses: Float) -> Float:
        """Return the ranges [m] that `pings` (F, 3+) should have at `poses` (P, 3), shape (P, F).

        Those that would echo nothing are longer than `SONAR_RANGE`.
        """
        out = np.empty((len(poses), len(pings)))
        w = self.walls
        surface = w.walls, w.field.distances, w.numbers, w.field.frame
        cone, memory = (RAYS, SONAR_RANGE, INCIDENCE), (self.known, PLACE_SIDE)
        fast(expected_ranges, CACHE)(surface, cone, memory, (pings, poses), out)
        return out


@dataclass(frozen=True, slots=True, eq=False)
class PingLikelihood:
    """The likelihood of pings: places, axes and ranges in the robot's frame [m, rad], (F, 4)."""

    echoes: EchoMap
    pings: Float

    def cost(self, poses: Float) -> Float:
        """Return the negative logarithm of the likelihood at `poses` (P, 3), shape (P,)."""
        out = np.empty(len(poses))
        shape = np.array(
            [
                SONAR_RANGE,
                RANGE_SIGMA,
                RANGE_SIGMA_SHARE,
                RIGHT_LIKELIHOOD,
                NEARER_LIKELIHOOD,
                OTHER_LIKELIHOOD,
            ]
        )
        expected = self.echoes.expected(self.pings, poses)
        fast(weigh_ranges, CACHE)(self.pings[:, 3], expected, shape, out)
        out *= PING_WEIGHT
        return out

    def agreeing(self, pose: Float) -> tuple[int, int]:
        """Return the number of echoes that agree with the map at `pose` (3,), and of all."""
        heard = self.pings[:, 3] <= SONAR_RANGE
        off = abs(self.echoes.expected(self.pings, pose[None])[0] - self.pings[:, 3])[heard]
        near = np.maximum(RANGE_AGREEMENT, 2 * RANGE_SIGMA_SHARE * self.pings[heard, 3])
        return int((off < near).sum()), int(heard.sum())
