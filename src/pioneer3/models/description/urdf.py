"""A robot as a URDF: links, joints, boxes and cylinders, all from its model. Needs no ROS."""

from typing import Final
from xml.etree import ElementTree as ET

from pioneer3.models import RobotModel, physics_of, shape_of
from pioneer3.models.description.solids import COLORS, LinkSolid, solids_of
from pioneer3.models.description.tree import Frames, FrameTree, Joint
from pioneer3.models.description.xml import AXES, MAKER, Inertial, document, inertials_of, row

VELOCITY: Final = "hardware_interface/VelocityJointInterface"
"""How ros_control turns a wheel."""


def describe(
    model: RobotModel,
    tree: FrameTree,
    frames: Frames,
    *,
    bumpers: tuple[int, int] | None = None,
    laser: bool = True,
) -> str:
    """Return the URDF of a robot, whose links are the frames of `tree`.

    `frames` are their names without the prefix, for which rviz has a setting; `bumpers` numbers of
    segments in front and behind, `None` for the model's; `laser` is that of its model.
    """
    robot = ET.Element("robot", name=model.name)
    robot.append(ET.Comment(f" {MAKER} "))
    for name, rgb in COLORS.items():
        material = ET.SubElement(robot, "material", name=name)
        ET.SubElement(material, "color", rgba=row(*rgb, 1.0))
    solids = solids_of(model, tree, frames, bumpers=bumpers, laser=laser)
    inertials = inertials_of(model, tree)
    for name in (tree.root, *(joint.child for joint in tree.joints)):
        link = _link(robot, name, solids.get(name, ()))
        if name in inertials:
            _inertial(link, inertials[name])
        if tree.caster and name == tree.caster[-1].child:
            _roller(link, shape_of(model).caster_radius)
    shape, physics = shape_of(model), physics_of(model)
    for joint in tree.fixed:
        _joint(robot, joint)
    effort, velocity = physics.side_torque / len(shape.axles), model.max_speed / shape.wheel_radius
    for joint in tree.wheels:
        ET.SubElement(_joint(robot, joint), "limit", effort=row(effort), velocity=row(velocity))
    for joint in tree.caster:
        ET.SubElement(_joint(robot, joint), "dynamics", damping=row(physics.caster_damping))
    for joint in tree.wheels:
        _transmission(robot, joint)
    return document(robot)


def _link(robot: ET.Element, name: str, solids: tuple[LinkSolid, ...]) -> ET.Element:
    link = ET.SubElement(robot, "link", name=name)
    for solid in solids:
        ET.SubElement(_solid(link, "visual", solid), "material", name=solid.color)
    for solid in solids:
        if solid.hits:
            _solid(link, "collision", solid)
    return link


def _inertial(link: ET.Element, inertial: Inertial) -> None:
    part = ET.SubElement(link, "inertial")
    ET.SubElement(part, "origin", xyz=row(*inertial.at))
    ET.SubElement(part, "mass", value=row(inertial.mass))
    moments = dict.fromkeys(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), "0")
    for name, moment in zip(("ixx", "iyy", "izz"), inertial.inertia, strict=True):
        moments[name] = f"{moment:.6g}"
    ET.SubElement(part, "inertia", moments)


def _roller(link: ET.Element, radius: float) -> None:
    """Let the wheel of a caster that moves touch the floor, as a ball."""
    geometry = ET.SubElement(ET.SubElement(link, "collision"), "geometry")
    ET.SubElement(geometry, "sphere", radius=row(radius))


def _solid(link: ET.Element, kind: str, solid: LinkSolid) -> ET.Element:
    part = ET.SubElement(link, kind)
    ET.SubElement(part, "origin", xyz=row(*solid.at), rpy=row(*solid.turned))
    geometry = ET.SubElement(part, "geometry")
    if solid.is_round:
        across, _, length = solid.size
        ET.SubElement(geometry, "cylinder", radius=row(across / 2), length=row(length))
    else:
        ET.SubElement(geometry, "box", size=row(*solid.size))
    return part


def _joint(robot: ET.Element, joint: Joint) -> ET.Element:
    kind = "continuous" if joint.axis else "fixed"
    element = ET.SubElement(robot, "joint", name=joint.name, type=kind)
    ET.SubElement(element, "parent", link=joint.parent)
    ET.SubElement(element, "child", link=joint.child)
    ET.SubElement(element, "origin", xyz=row(joint.x, joint.y, joint.z), rpy=row(*joint.rpy))
    if joint.axis:
        ET.SubElement(element, "axis", xyz=AXES[joint.axis])
    return element


def _transmission(robot: ET.Element, joint: Joint) -> None:
    """Let ros_control turn a wheel at a speed."""
    part = ET.SubElement(robot, "transmission", name=f"{joint.name}_transmission")
    ET.SubElement(part, "type").text = "transmission_interface/SimpleTransmission"
    driven = ET.SubElement(part, "joint", name=joint.name)
    motor = ET.SubElement(part, "actuator", name=f"{joint.name}_motor")
    ET.SubElement(driven, "hardwareInterface").text = VELOCITY
    ET.SubElement(motor, "mechanicalReduction").text = "1"
