"""Heights, wheels and casters of a robot, which ARIA's flat files do not have."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from types import MappingProxyType
from typing import Final

from pioneer3.models.model import RobotModel
from pioneer3.units import MM

PUBLISHED: Final = "published figure, rounded"
GUESS: Final = "assumption"
_COMMON: Final[Mapping[str, str]] = {
    "height": PUBLISHED,
    "clearance": PUBLISHED,
    "sonar_height": GUESS,
    "laser_height": "the scan plane of a SICK LMS-200 is 116 mm above its foot, on the top plate",
    "wheel_radius": PUBLISHED,
    "wheel_width": PUBLISHED,
    "axles": "the origin is between the wheels",
}
_CASTER: Final[Mapping[str, str]] = {
    "caster": "amr-ros-config",
    "caster_radius": "amr-ros-config",
    "caster_trail": "amr-ros-config",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class BodyShape:
    """Sizes that complete a :class:`RobotModel` to a body [m]; none was measured on a robot.

    Attributes:
        height: Of the top plate above the floor.
        clearance: Of the body above the floor.
        sonar_height: Of the transducers above the floor.
        laser_height: Of the plane that a laser range finder scans above the floor.
        track: From the middle of a left wheel to that of the right one.
        axles: Where the driven wheels are along the robot, front first.
        caster: Where the caster's swivel axis is along the robot, or `None` without a caster.
        caster_radius: Of its wheel.
        caster_trail: From the swivel axis back to the middle of its wheel.
        sources: Where each of the numbers above is from, by its name.
    """

    height: float
    clearance: float
    sonar_height: float
    laser_height: float
    wheel_radius: float
    wheel_width: float
    track: float
    axles: tuple[float, ...]
    caster: float | None = None
    caster_radius: float = 37.5 * MM
    caster_trail: float = 26 * MM
    sources: Mapping[str, str] = field(compare=False)

    @property
    def wheelbase(self) -> float:
        """From the front axle to the rear one [m]; 0 with one axle."""
        return self.axles[0] - self.axles[-1]

    @property
    def effective_track(self) -> float:
        """Difference of the wheels' speeds by the turn rate [m]: the track of a robot that slips.

        With one axle that is the track T. Wheels of two axles, L apart, slip when the robot turns.
        At a turn rate r each contact patch slips sideways by r L/2, and forwards by s = u - r T/2,
        where u is the speed of the rim. Friction is isotropic and against the slip, so a free turn
        needs s T/2 = (r L/2) L/2, which gives 2 u / r = T + L^2/T. A tire of width w that
        presses with its edges adds w^2/T; an even load over its width would add a third of that.
        """
        if not self.wheelbase:
            return self.track
        return self.track + (self.wheelbase**2 + self.wheel_width**2) / self.track


P3AT: Final = BodyShape(
    height=277 * MM,
    clearance=80 * MM,
    sonar_height=230 * MM,
    laser_height=393 * MM,
    wheel_radius=111 * MM,
    wheel_width=75 * MM,
    track=394 * MM,
    axles=(134 * MM, -134 * MM),
    sources=MappingProxyType({**_COMMON, "track": "amr-ros-config", "axles": "amr-ros-config"}),
)
P3DX: Final = BodyShape(
    height=237 * MM,
    clearance=60 * MM,
    sonar_height=190 * MM,
    laser_height=353 * MM,
    wheel_radius=97.5 * MM,
    wheel_width=48 * MM,
    track=330 * MM,
    axles=(0.0,),
    caster=-185 * MM,
    sources=MappingProxyType(
        {
            **_COMMON,
            **_CASTER,
            "wheel_width": GUESS,
            "track": "assumption; 0.316 m in ua_ros_p3dx, 0.357 in ARIA",
        }
    ),
)
# ARIA's 182 mm cannot be the track of an AmigoBot: its wheels, 30 mm wide and outside the shell,
# would reach from 76 to 106 mm, into the shell that has its side sonars at 100 mm. A body of 279 mm
# allows at most 249 mm.
AMIGO: Final = BodyShape(
    height=150 * MM,
    clearance=30 * MM,
    sonar_height=110 * MM,
    laser_height=266 * MM,
    wheel_radius=50 * MM,
    wheel_width=30 * MM,
    track=240 * MM,
    axles=(0.0,),
    caster=-110 * MM,
    caster_radius=20 * MM,
    caster_trail=12 * MM,
    sources=MappingProxyType(
        {
            **dict.fromkeys((*_COMMON, *_CASTER), GUESS),
            "axles": _COMMON["axles"],
            "track": "assumption: wheels outside the shell; 249 mm at most",
        }
    ),
)
PEOPLEBOT: Final = replace(
    P3DX,
    height=1240 * MM,
    clearance=35 * MM,
    wheel_radius=95 * MM,
    sources=MappingProxyType(
        {
            **dict.fromkeys((*_COMMON, *_CASTER), "assumption: as of a P3-DX"),
            "height": GUESS,
            "clearance": GUESS,
            "wheel_radius": GUESS,
            "axles": _COMMON["axles"],
            "laser_height": "assumption: on the deck of the base, as of a P3-DX",
            "track": "assumption: as of a P3-DX",
        }
    ),
)
SHAPES: Final[Mapping[str, BodyShape]] = MappingProxyType(
    {"p3at": P3AT, "p3dx": P3DX, "amigo": AMIGO, "peoplebot": PEOPLEBOT}
)
"""By the first word of a model's name."""
PEOPLEBOTS: Final = ("p2pb", "p2pp", "perfpb", "perfpb+")
"""First words of names that are PeopleBots, too."""


def kin_of(model: RobotModel) -> str:
    """Return the name in `SHAPES` that a model has, or the most similar type."""
    word = model.name.partition("-")[0]
    if word in PEOPLEBOTS:
        return "peoplebot"
    return word if word in SHAPES else "p3at" if model.drive == "skid" else "p3dx"


def shape_of(model: RobotModel) -> BodyShape:
    """Return the body of `model`, or that of the most similar type; wheels stay below its shell."""
    return _shape_within(kin_of(model), model.width)


@lru_cache(maxsize=64)
def _shape_within(kin: str, width: float) -> BodyShape:
    shape = SHAPES[kin]
    return replace(shape, track=min(shape.track, width - shape.wheel_width))
