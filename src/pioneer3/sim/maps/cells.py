"""Grids of cells: what scanned points and pictures say, for people to look at."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.sim.maps.image import MOST_PIXELS

Float = NDArray[np.float64]
States = NDArray[np.uint8]

UNKNOWN, OCCUPIED, FREE = range(3)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Cells:
    """A grid; compares by identity.

    Attributes:
        states: `UNKNOWN`, `OCCUPIED` or `FREE`, shape (H, W); row 0 is the lowest.
        side: Of a cell [m].
        corner: The lower left corner of the grid, and how it is turned, in the map frame.
    """

    states: States
    side: float
    corner: Pose2

    def coarser(self, most: int) -> "Cells":
        """Return the same with `most` cells at most, several joined to one.

        One that is occupied makes all of them so, one that is free those that nothing is known of.
        """
        height, width = self.states.shape
        share = 1
        while -(-height // share) * -(-width // share) > most:
            share += 1
        if share == 1:
            return self
        padded = np.pad(self.states, ((0, -height % share), (0, -width % share)))
        rows, columns = (size // share for size in padded.shape)
        blocks = padded.reshape(rows, share, columns, share)
        states = np.full((rows, columns), UNKNOWN, dtype=np.uint8)
        for state in (FREE, OCCUPIED):
            states[(blocks == state).any(axis=(1, 3))] = state
        return Cells(states=states, side=self.side * share, corner=self.corner)


def cells_of(points: Float, side: float) -> Cells | None:
    """Return the cells that are outlined by :func:`pioneer3.sim.maps.outline.outline`.

    Args:
        points: Middles of occupied cells [m], shape (N, 2).
        side: Of a cell [m].

    Returns:
        The grid, or `None` where there are no points, or they lie too far apart.
    """
    if not points.size:
        return None
    corner = points.min(axis=0)
    # before numbers become indices: points may lie 100 km apart
    extent = np.rint((points.max(axis=0) - corner) / side) + 1
    if extent.prod() > MOST_PIXELS:
        return None
    columns, rows = np.rint((points - corner) / side).astype(np.int64).T
    states = np.full((int(extent[1]), int(extent[0])), UNKNOWN, dtype=np.uint8)
    states[rows, columns] = OCCUPIED
    x, y = (corner - side / 2).tolist()
    return Cells(states=states, side=side, corner=Pose2(x, y))
