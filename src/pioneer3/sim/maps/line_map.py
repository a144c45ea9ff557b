"""A map as the simulator sees it: wall segments and named places, in SI."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import Pose2

Float = NDArray[np.float64]


class Bounds(NamedTuple):
    """An axis-aligned box [m]."""

    x_min: float
    y_min: float
    x_max: float
    y_max: float


@dataclass(frozen=True, slots=True, kw_only=True)
class MapObject:
    """A named place, line or area of a map: ARIA calls it a cairn.

    Attributes:
        kind: ARIA's type name: `Goal`, `RobotHome`, `ForbiddenLine`, `Sim.BoxObstacle`...
        name: The label; often empty.
        pose: Pose in the map frame; meaningless for lines and areas.
        outline: Points `(x, y)` [m] in the map frame: none for a place, the two ends of a line,
            the four corners of an area in order.
        solid: Its outline is among the walls of the map: a box, a reflector.
    """

    kind: str
    name: str
    pose: Pose2
    outline: tuple[tuple[float, float], ...] = ()
    solid: bool = False

    @property
    def sides(self) -> tuple[tuple[float, float, float, float], ...]:
        """The segments `x0, y0, x1, y1` [m]: of a place none, of a line one, of an area four."""
        corners = self.outline
        after = corners[1:] + (corners[:1] if len(corners) > 2 else ())
        return tuple((*start, *end) for start, end in zip(corners, after, strict=False))


def solid_walls(objects: Iterable[MapObject]) -> Float:
    """Return the walls that solid objects stand for [m], shape (W, 4), in their order."""
    sides = [side for item in objects if item.solid for side in item.sides]
    return np.array(sides, dtype=np.float64).reshape(-1, 4)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LineMap:
    """Walls and places; compares by identity.

    Attributes:
        name: What to call it on screen.
        walls: Segments `x0, y0, x1, y1` [m], shape (W, 4), float64; a read-only copy is kept. The
            sides of solid objects are among them.
        homes: Poses a robot may start at, in file order.
        objects: Every cairn in file order, the homes and obstacles among them.
    """

    name: str
    walls: Float
    homes: tuple[Pose2, ...] = ()
    objects: tuple[MapObject, ...] = ()

    def __post_init__(self) -> None:
        """Keep a copy of the walls that nobody can change."""
        walls = np.array(self.walls, dtype=np.float64).reshape(-1, 4)
        walls.setflags(write=False)
        object.__setattr__(self, "walls", walls)

    @property
    def bounds(self) -> Bounds:
        """The smallest box around the walls [m]; all zeros where there are none."""
        if not self.walls.size:
            return Bounds(0.0, 0.0, 0.0, 0.0)
        x, y = self.walls[:, ::2], self.walls[:, 1::2]
        return Bounds(float(x.min()), float(y.min()), float(x.max()), float(y.max()))


def empty_map() -> LineMap:
    """Return a plane without walls; what `--nomap` stands for."""
    return LineMap(name="empty", walls=np.empty((0, 4)))
