"""All that the third dimension adds to a map: heights of its walls, and solids."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from pioneer3.maps import LineMap
from pioneer3.sim.relief.solids import Solid

Float = NDArray[np.float64]

WALL_HEIGHT = 1.0
"""Of walls of which nothing is said [m]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Relief:
    """The heights of a map; compares by identity.

    It belongs to one :class:`~pioneer3.maps.LineMap`, which knows nothing of it.

    Attributes:
        wall_height: Of walls of which nothing is said [m].
        heights: Of each wall of the map [m], shape (W,); 0 for the outline of a solid, which is
            there by itself. If not given, all walls are `wall_height` high.
        solids: By name: the table in the world file and the number there, such as `ramp_0`.
        source: The world file, for messages; empty without.
    """

    wall_height: float = WALL_HEIGHT
    heights: Float = field(default_factory=lambda: np.empty(0))
    solids: Mapping[str, Solid] = field(default_factory=lambda: MappingProxyType({}))
    source: str = ""

    def heights_of(self, line_map: LineMap) -> Float:
        """Return the height of each wall of the map that this belongs to [m], shape (W,)."""
        if len(self.heights) == len(line_map.walls):
            return self.heights
        return np.full(len(line_map.walls), self.wall_height)

    def carried(self, before: LineMap, after: LineMap) -> "Relief":
        """Return the relief of a map that was made of the one before.

        Walls that are still there keep their heights; others have :attr:`wall_height`.
        """
        known = dict(zip(map(tuple, before.walls.tolist()), self.heights_of(before), strict=True))
        heights = [known.get(tuple(wall), self.wall_height) for wall in after.walls.tolist()]
        return replace(self, heights=np.array(heights, dtype=np.float64))


FLAT = Relief()
"""Walls of the usual height on a flat floor."""
