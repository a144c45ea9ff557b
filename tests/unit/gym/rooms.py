"""Maps and drivers to test environments with."""

from math import atan2
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import wrap
from pioneer3.maps import LineMap

Float32 = NDArray[np.float32]


def rooms(*boxes: tuple[float, float, float, float]) -> LineMap:
    """Return a map of closed boxes x0, y0, x1, y1 [m]."""
    walls = [
        side
        for x0, y0, x1, y1 in boxes
        for side in ((x0, y0, x1, y0), (x1, y0, x1, y1), (x1, y1, x0, y1), (x0, y1, x0, y0))
    ]
    return LineMap(name="rooms", walls=np.array(walls))


ROOM = rooms((-3.2, -2.7, 3.3, 2.9))
PILLARED = rooms((-3.2, -2.7, 3.3, 2.9), (0.4, -0.3, 1.0, 0.35))


def towards(info: dict[str, Any]) -> Float32:
    """Return what drives a robot straight to its goal, in a room without anything in its way."""
    x, y, theta = info["pose"]
    turn = wrap(atan2(info["goal"][1] - y, info["goal"][0] - x) - theta)
    return np.array([0.0 if abs(turn) > 0.2 else 0.6, np.clip(turn, -0.4, 0.4)], dtype=np.float32)
