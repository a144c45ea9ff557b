"""Masses of a robot's links."""

from typing import NamedTuple

from pioneer3.models import RobotModel, physics_of, shape_of
from pioneer3.models.description.tree import Tree
from pioneer3.models.physics import Inertia, box_inertia


class Inertial(NamedTuple):
    """The mass of a link [kg], its inertia about its center [kg m2], and that center [m]."""

    mass: float
    inertia: Inertia
    at: tuple[float, float, float] = (0.0, 0.0, 0.0)


def inertials_of(model: RobotModel, tree: Tree) -> dict[str, Inertial]:
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
