"""Numbers, pieces of XML and inertias that all formats of a description write alike."""

from collections.abc import Mapping
from math import cos, sin
from types import MappingProxyType
from typing import Final, NamedTuple
from xml.etree import ElementTree as ET

from pioneer3.models import RobotModel, physics_of, shape_of
from pioneer3.models.description.tree import FrameTree
from pioneer3.models.physics import Inertia, box_inertia

MAKER: Final = "Drawn by pioneer3 from the robot's model."
"""In every description of ours, and in no other."""
AXES: Final[Mapping[str, str]] = MappingProxyType({"y": "0 1 0", "z": "0 0 1"})
"""Axes of joints that turn."""


def row(*numbers: float) -> str:
    """Return numbers with six digits and no more than six places, which makes the text stable."""
    return " ".join(f"{round(number, 6) + 0.0:.6g}" for number in numbers)


def document(root: ET.Element) -> str:
    """Return the text of a document, indented."""
    ET.indent(root)
    return '<?xml version="1.0"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def quaternion(roll: float, pitch: float, yaw: float) -> tuple[float, float, float, float]:
    """Return w, x, y, z of turns about the fixed axes x, y and z, in that order [rad]."""
    (cr, sr), (cp, sp), (cy, sy) = ((cos(a / 2), sin(a / 2)) for a in (roll, pitch, yaw))
    return (
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    )


class Inertial(NamedTuple):
    """The mass of a link [kg], its inertia about its center [kg m2], and that center [m]."""

    mass: float
    inertia: Inertia
    at: tuple[float, float, float] = (0.0, 0.0, 0.0)


def inertials_of(model: RobotModel, tree: FrameTree) -> dict[str, Inertial]:
    """Return the masses of the links that have one; a caster that is fixed is part of the base."""
    physics, shape = physics_of(model), shape_of(model)
    center = (physics.center_x, 0.0, physics.center_z)
    base = physics.base_mass if tree.caster else physics.body_mass
    caster = Inertial(physics.caster_mass, physics.caster_inertia(shape))
    wheel = Inertial(physics.wheel_mass, physics.wheel_inertia(shape))
    return {
        tree.base: Inertial(base, box_inertia(base, *physics.box), center),
        **{joint.child: wheel for joint in tree.wheels},
        **{joint.child: caster for joint in tree.caster},
    }
