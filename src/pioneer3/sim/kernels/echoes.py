"""What a transducer hears of walls."""

from dataclasses import dataclass

from pioneer3.sim.kernels.walls import Grid

SHADE = 0.02
"""A wall hides an edge that is further behind it than this [m]: sound bends around less."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Echoes:
    """What sends sound back; robots and other things that move always do.

    Attributes:
        steep: Sine of the smallest angle between a ray and a wall that sends it back.
        edges: Points that are heard in all directions, as walls without length, or `None`. One of
            them echoes if it lies between a transducer's outermost rays and no wall hides it.
        edge_range: As long as they are nearer than this [m].
    """

    steep: float = 0.0
    edges: Grid | None = None
    edge_range: float = 0.0


ALL = Echoes()
"""Every wall is heard at any angle, and so no edge for itself."""
