"""All that the third dimension adds to a map: heights of its walls, and solids."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

from pioneer3.arrays import Float
from pioneer3.maps import LineMap
from pioneer3.sim.relief.solids import Solid

Side = tuple[float, float, float, float]

WALL_HEIGHT = 1.0
"""Height of walls of which nothing is said [m]."""


class Origin(Protocol):
    """The world that a relief is made of."""

    @property
    def source(self) -> str:
        """Its file, for messages; empty without."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Relief:
    """The heights of a map; compares by identity.

    It belongs to one :class:`~pioneer3.maps.LineMap`, which knows nothing of it.

    Attributes:
        wall_height: Of walls of which nothing is said [m].
        heights: Of each wall of the map [m], shape (W,); 0 for the outline of a solid, which is
            there by itself. If not given, all walls are `wall_height` high.
        solids: By name: the table in the world file and the number there, such as `ramp_0`.
        origin: The world that it is made of, in which a file that is saved finds what is neither
            wall nor solid; `None` without.
    """

    wall_height: float = WALL_HEIGHT
    heights: Float = field(default_factory=lambda: np.empty(0))
    solids: Mapping[str, Solid] = field(default_factory=dict)
    origin: Origin | None = None

    @property
    def source(self) -> str:
        """The world file, for messages; empty without."""
        return self.origin.source if self.origin else ""

    def heights_of(self, line_map: LineMap) -> Float:
        """Return the height of each wall of the map that this belongs to [m], shape (W,)."""
        if len(self.heights) == len(line_map.walls):
            return self.heights
        return np.full(len(line_map.walls), self.wall_height)

    def carried(self, before: LineMap, after: LineMap) -> "Relief":
        """Return the relief of a map that was made of the one before.

        Walls that are still there keep their heights; others have :attr:`wall_height`. A solid
        one of whose walls is gone is gone, and its other walls are like others.
        """
        if before is after:
            return self
        if not self.solids and (self.heights == self.wall_height).all():
            return replace(self, heights=np.empty(0))
        there = sides_of(after.walls)
        solids = {
            name: solid for name, solid in self.solids.items() if sides_of(solid.walls) <= there
        }
        known = dict(zip(sides_in(before.walls), self.heights_of(before).tolist(), strict=True))
        for name, solid in self.solids.items():
            if name not in solids:
                known |= dict.fromkeys(sides_of(solid.walls), self.wall_height)
        heights = [known.get(side, self.wall_height) for side in sides_in(after.walls)]
        return replace(
            self,
            heights=np.array(heights, dtype=np.float64),
            solids=solids,
        )


def sides_in(walls: Float) -> list[Side]:
    """Return segments (S, 4) as numbers that can be looked up."""
    return [(x0, y0, x1, y1) for x0, y0, x1, y1 in walls.tolist()]


def sides_of(walls: Float) -> set[Side]:
    """Return the set of segments (S, 4)."""
    return set(sides_in(walls))


FLAT = Relief()
"""Walls of the usual height on a flat floor."""
