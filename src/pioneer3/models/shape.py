"""A robot from the side: heights and wheels, which ARIA's flat files do not have."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

from pioneer3.models.model import RobotModel
from pioneer3.units import MM


@dataclass(frozen=True, slots=True, kw_only=True)
class Shape:
    """Sizes that complete a :class:`RobotModel` to a body [m].

    Attributes:
        height: Of the top plate above the floor.
        clearance: Of the body above the floor.
        sonar_height: Of the transducers above the floor.
        wheel_radius: Of a wheel.
        wheel_width: Of a wheel.
        track: From the middle of a left wheel to that of the right one.
        axles: Where the driven wheels are along the robot, front first.
        caster: Where the caster is along the robot, or `None` without one.
        caster_radius: Of its wheel.
    """

    height: float
    clearance: float
    sonar_height: float
    wheel_radius: float
    wheel_width: float
    track: float
    axles: tuple[float, ...]
    caster: float | None = None
    caster_radius: float = 31 * MM


P3AT: Final = Shape(
    height=277 * MM,
    clearance=80 * MM,
    sonar_height=230 * MM,
    wheel_radius=111 * MM,
    wheel_width=75 * MM,
    track=394 * MM,
    axles=(134 * MM, -134 * MM),
)
P3DX: Final = Shape(
    height=237 * MM,
    clearance=60 * MM,
    sonar_height=190 * MM,
    wheel_radius=97.5 * MM,
    wheel_width=48 * MM,
    track=330 * MM,
    axles=(0.0,),
    caster=-180 * MM,
)
AMIGO: Final = Shape(
    height=150 * MM,
    clearance=30 * MM,
    sonar_height=110 * MM,
    wheel_radius=50 * MM,
    wheel_width=30 * MM,
    track=240 * MM,
    axles=(0.0,),
    caster=-110 * MM,
    caster_radius=20 * MM,
)
PEOPLEBOT: Final = Shape(
    height=1240 * MM,
    clearance=35 * MM,
    sonar_height=190 * MM,
    wheel_radius=95 * MM,
    wheel_width=48 * MM,
    track=330 * MM,
    axles=(0.0,),
    caster=-180 * MM,
)
SHAPES: Final[Mapping[str, Shape]] = MappingProxyType(
    {"p3at": P3AT, "p3dx": P3DX, "amigo": AMIGO, "peoplebot": PEOPLEBOT}
)
"""By the first word of a model's name. Heights and wheels are published figures,
rounded; the height of the sonars is an estimate. None was measured on a robot."""


def shape_of(model: RobotModel) -> Shape:
    """Return the body of `model`; for an unknown one, that of the most similar type."""
    kin = P3AT if model.drive == "skid" else P3DX
    return SHAPES.get(model.name.partition("-")[0], kin)
