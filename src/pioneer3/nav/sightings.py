"""Things that are not on the map: boxes, closed doors, people. Where, and when they were seen."""

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.jit import fast
from pioneer3.nav.beams import Beams
from pioneer3.nav.costs import CostMap
from pioneer3.nav.kernels import CACHE
from pioneer3.nav.kernels.sightings import clear_beams, mark_echoes

Float = NDArray[np.float64]

EXPLAINED = 0.12
"""An echo so near to a wall of the map is of that wall [m]."""
SHORT = 0.15
"""So much before its echo a beam clears nothing [m]: poses are not that exact."""
FAR = 6.0
"""Things farther away are not noted [m]."""
AGE = 60.0
"""Things not seen for so long may have gone [s]."""


class Sightings:
    """The cells of a map in which something unknown to it was seen last.

    Args:
        costs: Of the map alone, for its cells and clearances.
    """

    def __init__(self, costs: CostMap) -> None:
        self._raster, self._clearance = costs.raster, costs.clearance
        self._seen: Float = np.zeros(costs.raster.shape)

    def take(self, beams: Beams, robot_in_map: Pose2) -> None:
        """Note the echoes of a scan, and forget the things that it sees past.

        Args:
            beams: The scan.
            robot_in_map: The robot's pose at the scan's last reading.
        """
        raster = self._raster
        origin = raster.in_cells(in_map(robot_in_map, beams.origin[None]))[0]
        near = np.hypot(*(beams.points - beams.origin).T) < FAR
        ends = raster.in_cells(in_map(robot_in_map, beams.points))
        clear = raster.in_cells(in_map(robot_in_map, _shortened(beams)))
        short = SHORT / raster.cell
        fast(clear_beams, CACHE)(origin, np.concatenate([ends[near], clear]), short, self._seen)
        fast(mark_echoes, CACHE)(
            ends[near], self._clearance, EXPLAINED, max(beams.stamp, 1e-9), self._seen
        )

    def points(self, now: float, age: float = AGE) -> Float:
        """Return the middles of cells with things seen within `age` [s], shape (N, 2) [m]."""
        rows, columns = np.nonzero((self._seen > 0) & (self._seen >= now - age))
        raster = self._raster
        middles: Float = np.stack([columns + 0.5, rows + 0.5], axis=1) * raster.cell
        middles += raster.x, raster.y
        return middles

    def seen_at(self, x: float, y: float, within: float) -> float | None:
        """Return when something was last seen within a distance of a place [m], or `None`."""
        raster = self._raster
        u, v = raster.in_cells(np.array([[x, y]]))[0]
        reach = within / raster.cell
        left, right = max(0, int(u - reach)), max(0, int(u + reach) + 1)
        low, high = max(0, int(v - reach)), max(0, int(v + reach) + 1)
        latest = float(self._seen[low:high, left:right].max(initial=0.0))
        return latest or None

    def forget(self) -> None:
        """Forget everything, as after the robot was found to be somewhere else."""
        self._seen[:] = 0.0


def in_map(robot_in_map: Pose2, points: Float) -> Float:
    """Return points of the robot's frame (N, 2) in the map's [m]."""
    c, s = np.cos(robot_in_map.theta), np.sin(robot_in_map.theta)
    turned: Float = points @ np.array([[c, s], [-s, c]])
    turned += robot_in_map.x, robot_in_map.y
    return turned


def _shortened(beams: Beams) -> Float:
    """Return the ends of beams without echo, and of far ones, no farther than is noted."""
    far = beams.points[np.hypot(*(beams.points - beams.origin).T) >= FAR]
    ends = np.concatenate([beams.clear, far]) - beams.origin
    lengths = np.maximum(np.hypot(*ends.T), 1e-9)
    shortened: Float = beams.origin + ends * np.minimum(1.0, FAR / lengths)[:, None]
    return shortened
