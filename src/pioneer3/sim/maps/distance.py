"""How far walls are from a point."""

import numpy as np
from numpy.typing import NDArray

Float = NDArray[np.float64]


def distances(point: Float, walls: Float) -> Float:
    """Return the distance [m] of `point` (2,) to each of `walls` (W, 4), shape (W,)."""
    start, extent = walls[:, :2] - point, walls[:, 2:] - walls[:, :2]
    squared = (extent**2).sum(axis=1)
    share = -(start * extent).sum(axis=1) / np.where(squared > 0, squared, 1.0)
    nearest: Float = start + np.clip(share, 0.0, 1.0)[:, None] * extent
    return np.hypot(nearest[:, 0], nearest[:, 1])
