"""Colours of a world's geoms: a camera and a colour tracker can tell them apart; their groups."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, Final

from pioneer3.sim.obstacles import Obstacle
from pioneer3.sim.worldfile import Person

Rgba = tuple[float, float, float, float]

COLORS: Final[Mapping[str, Rgba]] = MappingProxyType(
    {
        "floor": (0.62, 0.58, 0.52, 1.0),
        "wall": (0.86, 0.84, 0.78, 1.0),
        "box": (0.90, 0.50, 0.10, 1.0),
        "person": (0.10, 0.55, 0.25, 1.0),
        "ramp": (0.70, 0.71, 0.74, 1.0),
        "step": (0.74, 0.75, 0.78, 1.0),
        "heightfield": (0.66, 0.64, 0.56, 1.0),
        "carpet": (0.60, 0.56, 0.75, 1.0),
        "cylinder": (0.45, 0.34, 0.28, 1.0),
        "table": (0.52, 0.36, 0.26, 1.0),
        "mesh": (0.55, 0.55, 0.50, 1.0),
    }
)
"""Colours by the names of geoms; robots have those of their description."""
SKY: Final = (0.55, 0.72, 0.90), (0.30, 0.45, 0.75)
"""At the horizon, and above."""
SKY_SIZE: Final = 16
"""Side of the sky's picture [pixels]."""


def paint(spec: Any, obstacles: Mapping[str, Obstacle]) -> None:
    """Colour floor, walls, boxes and people, and put a sky around them.

    `spec` is a complete `MjSpec` of MuJoCo; obstacles are by the names of their bodies.
    """
    import mujoco

    for geom in spec.worldbody.geoms:
        geom.rgba = COLORS.get(geom.name.partition("_")[0], COLORS["wall"])
    for name, obstacle in obstacles.items():
        kind = "person" if isinstance(obstacle.kind, Person) else "box"
        for geom in spec.body(name).geoms:
            geom.rgba = COLORS[kind]
    horizon, above = SKY
    spec.add_texture(
        name="sky",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        rgb1=above,
        rgb2=horizon,
        width=SKY_SIZE,
        height=SKY_SIZE * 6,
    )


COUNT = 6
"""Number of MuJoCo's groups."""
WALLS = 0
"""Group of tall walls."""
THINGS = 1
"""Group of the floor and all else that sensors meet."""
PARTS = 2
"""Group of small parts of robots, which are only drawn."""
TOUCHING = 3
"""Group of solids that only touch."""
BODIES = 4
"""Group of people as sonars and eyes meet them."""
LEGS = 5
"""Group of people as lasers meet them."""
DRAWN = WALLS, THINGS, PARTS, BODIES
"""By cameras."""
