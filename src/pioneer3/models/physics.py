"""Masses, motors and tires of a robot's body, for simulators in three dimensions."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Final, NamedTuple

from pioneer3.models.model import RobotModel
from pioneer3.models.shape import BodyShape, kin_of, shape_of
from pioneer3.units import MM

GUESS: Final = "assumption"
MEASURED: Final = "measured in MuJoCo with this body"


class Inertia(NamedTuple):
    """Moments of inertia about the axes of a link [kg m2]; its products of inertia are 0."""

    x: float
    y: float
    z: float


@dataclass(frozen=True, slots=True)
class Contact:
    """The contact of a tire with things, as MuJoCo has it.

    `solref` is time constant [s] and damping ratio, `solimp` the smallest and the largest impedance
    and the sink between them [m].
    """

    solref: tuple[float, float]
    solimp: tuple[float, float, float] = (0.9, 0.95, 0.001)


SOFT: Final = Contact(solref=(0.1, 0.3), solimp=(0.5, 0.9, 0.01))
"""A pneumatic tire, which sinks by 4 mm: a hard one hops when the robot turns and slips."""
HARD: Final = Contact(solref=(0.005, 1.0))
"""Solid rubber. The time constant must be two steps of the simulation or more."""


def _unit(unit: str) -> Mapping[str, str]:
    return {"unit": unit}


@dataclass(frozen=True, slots=True, kw_only=True)
class BodyPhysics:
    """Numbers that complete a :class:`BodyShape` to a body that moves by forces.

    The robot's frame is on the floor, in the centre of its rotation. Sensors have no mass of their
    own: the body's includes them.

    Attributes:
        body_mass: Without wheels, with the caster and its swivel.
        wheel_mass: Of one driven wheel.
        caster_mass: Of the caster's wheel, and of its swivel.
        center_x: Of the body's mass, in front of the origin.
        center_z: Of the body's mass, above the floor.
        box: Length, width and height of the even box that has the body's inertia.
        friction: Coefficient of a tire, rolling or sliding.
        armature: Rotor inertia of the motor times its gear ratio squared, of one wheel.
        side_torque: Largest torque of all the motors of one side together, at the wheels.
        loop_gain: Of the wheel-speed loop: torque for each radian that a wheel is behind.
        loop_damping: Of the wheel-speed loop: torque for each radian per second.
        rolling_radius: Way for each radian of a driven wheel: tires sink under the robot's weight.
        turning_track: Difference of the ways of the wheels of both sides for each radian that the
            robot turns; with it a robot is calibrated.
        sources: Where each of the numbers above is from, by its name.
    """

    body_mass: float = field(metadata=_unit("kg"))
    wheel_mass: float = field(metadata=_unit("kg"))
    caster_mass: float = field(default=0.0, metadata=_unit("kg"))
    center_x: float = field(metadata=_unit("m"))
    center_z: float = field(metadata=_unit("m"))
    box: tuple[float, float, float] = field(metadata=_unit("m"))
    friction: float = field(default=0.6, metadata=_unit(""))
    contact: Contact = field(default=HARD, metadata=_unit("s, -, m"))
    armature: float = field(default=0.02, metadata=_unit("kg m2"))
    side_torque: float = field(metadata=_unit("Nm"))
    loop_gain: float = field(default=100.0, metadata=_unit("Nm/rad"))
    loop_damping: float = field(default=5.0, metadata=_unit("Nm s/rad"))
    caster_damping: float = field(default=0.001, metadata=_unit("Nm s/rad"))
    rolling_radius: float = field(metadata=_unit("m"))
    turning_track: float = field(metadata=_unit("m"))
    sources: Mapping[str, str]

    @property
    def base_mass(self) -> float:
        """Mass of the body without the caster's two links [kg]."""
        return self.body_mass - 2 * self.caster_mass

    def base_inertia(self) -> Inertia:
        """Return the body's inertia about its center of mass."""
        return box_inertia(self.base_mass, *self.box)

    def wheel_inertia(self, shape: BodyShape) -> Inertia:
        """Return the inertia of a driven wheel, an even cylinder, which turns about its y axis."""
        mass, square = self.wheel_mass, shape.wheel_radius**2
        across = mass / 12 * (3 * square + shape.wheel_width**2)
        return Inertia(across, mass / 2 * square, across)

    def caster_inertia(self, shape: BodyShape) -> Inertia:
        """Return the inertia of the caster's wheel, and of its swivel, as of a ball."""
        one = 0.4 * self.caster_mass * shape.caster_radius**2
        return Inertia(one, one, one)


def box_inertia(mass: float, length: float, width: float, height: float) -> Inertia:
    """Return the inertia of an even box about its middle; lengths along x, y and z [kg, m]."""
    x, y, z = length**2, width**2, height**2
    return Inertia(mass / 12 * (y + z), mass / 12 * (x + z), mass / 12 * (x + y))


EVEN_BOX: Final = (
    "chosen to give the inertias of an even box of that mass (docs/explanation/physics.md)"
)
_COMMON: Final = {
    "caster_mass": GUESS,
    "friction": "assumption: rubber on a hard floor",
    "contact": "chosen in MuJoCo: all wheels stay on the floor, odometry stays exact",
    "loop_gain": "chosen in MuJoCo",
    "loop_damping": "as loop_gain",
    "caster_damping": GUESS,
    "rolling_radius": MEASURED,
    "turning_track": MEASURED,
    "box": GUESS,
}
P3AT: Final = BodyPhysics(
    body_mass=12.0,
    wheel_mass=0.7,
    center_x=0.0,
    center_z=161 * MM,
    box=(490 * MM, 380 * MM, 190 * MM),
    contact=SOFT,
    armature=0.1,
    side_torque=4.5,
    rolling_radius=109.0 * MM,
    turning_track=574 * MM,
    sources=MappingProxyType(
        {
            **_COMMON,
            "box": EVEN_BOX,
            "body_mass": "12 kg in the guide of Webots; 14 kg in osrf/gazebo_models",
            "wheel_mass": "0.5 kg in amr-ros-config, more for a filled tire",
            "center_x": "middle, as in the guide of Webots",
            "center_z": "assumption: 50 mm above the axles",
            "contact": "chosen in MuJoCo: a tire that sinks 4 mm turns at the theory's track",
            "armature": "assumption: motors of 49.8:1, a belt and two axles a side",
            "side_torque": "assumption: turns on the spot, and stalls at a wall before it slips",
        }
    ),
)
P3DX: Final = BodyPhysics(
    body_mass=7.8,
    wheel_mass=0.6,
    caster_mass=0.15,
    center_x=-60 * MM,
    center_z=157.5 * MM,
    box=(400 * MM, 316 * MM, 150 * MM),
    side_torque=1.1,
    rolling_radius=97.5 * MM,
    turning_track=330 * MM,
    sources=MappingProxyType(
        {
            **_COMMON,
            "box": EVEN_BOX,
            "body_mass": "9 kg with its wheels in the guide of Webots",
            "wheel_mass": GUESS,
            "center_x": "guide of Webots",
            "center_z": "guide of Webots: 60 mm above the axle",
            "armature": "assumption: motors of 38.3:1",
            "side_torque": "assumption: turns on the spot, and stalls at a wall before it slips",
        }
    ),
)
AMIGO: Final = BodyPhysics(
    body_mass=3.2,
    wheel_mass=0.2,
    caster_mass=0.05,
    center_x=-20 * MM,
    center_z=70 * MM,
    box=(280 * MM, 200 * MM, 100 * MM),
    armature=0.004,
    side_torque=0.37,
    loop_gain=10.0,
    loop_damping=0.5,
    caster_damping=0.0001,
    rolling_radius=50 * MM,
    turning_track=240 * MM,
    sources=MappingProxyType(
        {
            **_COMMON,
            "body_mass": "assumption: 3.6 kg with its wheels",
            "wheel_mass": GUESS,
            "center_x": GUESS,
            "center_z": GUESS,
            "armature": "assumption: as of a P3-DX, by mass and radius",
            "side_torque": "assumption: as of a P3-DX, by mass and radius",
        }
    ),
)
PEOPLEBOT: Final = replace(
    P3DX,
    body_mass=17.8,
    center_z=300 * MM,
    box=(380 * MM, 316 * MM, 800 * MM),
    side_torque=2.5,
    rolling_radius=95 * MM,
    sources=MappingProxyType(
        {
            **_COMMON,
            "body_mass": "assumption: 19 kg with its wheels",
            "wheel_mass": GUESS,
            "center_x": "assumption: as of a P3-DX",
            "center_z": "assumption: batteries at the bottom, a light column",
            "armature": "assumption: as of a P3-DX",
            "side_torque": "assumption: climbs 10 degrees, and stalls at a wall before it slips",
        }
    ),
)
BODIES: Final[Mapping[str, BodyPhysics]] = MappingProxyType(
    {"p3at": P3AT, "p3dx": P3DX, "amigo": AMIGO, "peoplebot": PEOPLEBOT}
)
"""By the name that :func:`.kin_of` gives. None was measured on a robot."""


def physics_of(model: RobotModel) -> BodyPhysics:
    """Return the masses and motors of `model`; for an unknown one, of the most similar type."""
    return BODIES[kin_of(model)]


def total_mass(model: RobotModel) -> float:
    """Return the mass of a robot with all its wheels [kg]."""
    physics = physics_of(model)
    return physics.body_mass + 2 * len(shape_of(model).axles) * physics.wheel_mass
