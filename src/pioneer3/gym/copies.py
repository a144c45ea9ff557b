"""Copies of one map side by side, so alike that robots in them can't tell which they are in."""

from math import ceil, floor, sqrt

import numpy as np
from numpy.typing import NDArray

from pioneer3.errors import ConfigError
from pioneer3.sim.maps import Bounds, LineMap

Float = NDArray[np.float64]

FENCE = 1
"""From the walls of a map to the fence around it [m]."""
GAP = 1
"""Between the fences of two copies [m]."""
BASE = 2.0**14
"""All copies lie between this and twice this in x and y [m].

There all numbers have the same spacing (3.6e-12 m), and copies are whole metres apart: sums and
differences round alike in each of them, so that what happens in one is what happens in another to
the last bit.
"""


class Copies:
    """A map with a fence around it, several times.

    Args:
        line_map: What to copy.
        count: How often.

    Attributes:
        bounds: Of the fence, in the frame of `line_map` [m].
        walls: Of one copy, fence included, in the frame of `line_map` [m], shape (W, 4).
        shifts: From the frame of `line_map` to each copy [m], whole numbers, shape (count, 2).
        together: All copies as one map.

    Raises:
        ConfigError: So many do not fit.
    """

    def __init__(self, line_map: LineMap, count: int) -> None:
        x0, y0, x1, y1 = line_map.bounds
        self.bounds = Bounds(x0 - FENCE, y0 - FENCE, x1 + FENCE, y1 + FENCE)
        self.walls = np.concatenate([line_map.walls, _sides(self.bounds)])
        left, bottom = floor(x0) - FENCE, floor(y0) - FENCE
        pitch = np.array([ceil(x1) + FENCE + GAP - left, ceil(y1) + FENCE + GAP - bottom])
        columns = ceil(sqrt(count))
        if columns * int(pitch.max()) > BASE:
            raise ConfigError(
                f"{count} copies of a map of {pitch[0]} m x {pitch[1]} m do not fit into "
                f"{BASE:g} m x {BASE:g} m; take fewer or a smaller map"
            )
        number = np.arange(count)
        places = np.stack([number % columns, number // columns], axis=1)
        self.shifts = BASE + places * pitch - np.array([left, bottom])
        moved = self.walls + np.tile(self.shifts, 2)[:, None, :]
        self.together = LineMap(name=line_map.name, walls=moved.reshape(-1, 4))


def _sides(bounds: Bounds) -> Float:
    x0, y0, x1, y1 = bounds
    return np.array([[x0, y0, x1, y0], [x1, y0, x1, y1], [x1, y1, x0, y1], [x0, y1, x0, y0]])
