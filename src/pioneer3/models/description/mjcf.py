"""A robot as MJCF, the format of MuJoCo: bodies, tires, wheel-speed loops and sensor sites."""

from collections.abc import Iterator
from typing import Final
from xml.etree import ElementTree as ET

from pioneer3.models import BodyPhysics, BodyShape, RobotModel, physics_of, shape_of
from pioneer3.models.description.solids import COLORS, LinkSolid, solids_of
from pioneer3.models.description.tree import Frames, FrameTree, Joint, LinkPose, body_tree
from pioneer3.models.description.xml import AXES, MAKER, document, quaternion, row
from pioneer3.models.physics import Inertia

TIMESTEP: Final = 0.002
"""Step of the simulation [s]: a tire's contact needs two or more in its time constant."""
COLLISION = "3"
"""Group of the geoms that touch things."""
VISUAL = "2"
"""Group of the geoms that are seen."""
COLLIDES: Final = "collision"
"""In the name of a geom that touches things."""
SIDES: Final = ("left", "right")
"""Names of the actuators, which take a wheel speed [rad/s]."""
BELT: Final = (0.004, 1.0)
"""The `solref` that couples the wheels of a side: two steps is the stiffest."""
REACH: Final = 0.01
"""A bumper feels what is this close to it [m]; nothing pushes it before it touches."""
HERE: Final = LinkPose(0.0, 0.0, 0.0, 0.0)
CAMERA: Final = "camera"
"""Name of the camera."""
CAMERA_VIEW: Final = 37.0
"""Angle from the bottom of a picture to its top [deg]: 48 wide at 320 x 240, as a VC-C4's."""


def mjcf_of(model: RobotModel, *, floor: bool = False) -> str:
    """Return the MJCF of one robot, which can be attached to a world.

    Its body `base_link` has the free joint `base`; its origin is on the floor, in the centre of the
    robot's rotation. The actuators `left` and `right` are PI loops of the wheel speed [rad/s] with
    the motors' torque limit; those of a skid drive move both wheels of a side, which are coupled.
    Wheels have the names of the tree's joints. Solids that touch things are in group 3, those that
    are only seen in group 2.

    A file that is simulated by itself needs a `floor`, which has a light, too.
    """
    shape, physics, frames = shape_of(model), physics_of(model), Frames()
    tree = body_tree(model, frames)
    solids = solids_of(model, tree, frames)
    root = ET.Element("mujoco", model=model.name)
    root.append(ET.Comment(f" {MAKER} "))
    ET.SubElement(root, "compiler", angle="radian", autolimits="true")
    ET.SubElement(
        root, "option", timestep=row(TIMESTEP), integrator="implicitfast", cone="elliptic",
        impratio="10",
    )  # fmt: skip
    world = ET.SubElement(root, "worldbody")
    if floor:
        ET.SubElement(world, "light", name="light", pos="0 0 4", dir="0 0 -1", type="directional")
        ET.SubElement(
            world, "geom", name="floor", type="plane", size="20 20 0.1", rgba="0.6 0.6 0.6 1"
        )
    base = _base(world, tree, frames, physics, solids)
    lens = tree.fixed_in_base()[frames.camera]
    ET.SubElement(
        base, "camera", name=CAMERA, pos=row(*lens[:3]), xyaxes="0 -1 0 0 0 1",
        fovy=row(CAMERA_VIEW),
    )  # fmt: skip
    for joint in tree.wheels:
        _wheel(base, joint, shape, physics, solids[joint.child])
    if tree.caster:
        _caster(base, tree.caster, shape, physics, solids)
        contact = ET.SubElement(root, "contact")
        wheel = tree.caster[-1].child
        ET.SubElement(contact, "exclude", name=wheel, body1=tree.base, body2=wheel)
    _motors(root, tree, physics)
    return document(root)


def bumper_geoms(model: RobotModel) -> list[str]:
    """Return the geoms of the bumpers' segments that touch: in front, then behind."""
    frames = Frames()
    solids = solids_of(model, body_tree(model, frames), frames)
    link = frames.bumper_link
    names = _names(link, solids.get(link, ()), touching=True)
    return [name for name, (_, kind) in names if kind == COLLIDES]


def _base(
    world: ET.Element,
    tree: FrameTree,
    frames: Frames,
    physics: BodyPhysics,
    solids: dict[str, tuple[LinkSolid, ...]],
) -> ET.Element:
    """Add the body, with the solids of all links that never move, and a site for each of these."""
    base = ET.SubElement(world, "body", name=tree.base)
    ET.SubElement(base, "freejoint", name="base")
    center = (physics.center_x, 0.0, physics.center_z)
    _inertial(base, physics.base_mass, physics.base_inertia(), center)
    for link, place in tree.fixed_in_base().items():
        _geoms(base, link, solids.get(link, ()), place)
        if link not in (tree.base, tree.root):
            ET.SubElement(
                base, "site", name=link, pos=row(*place[:3]), quat=_turn(0.0, 0.0, place.yaw),
                size="0.005", group=VISUAL,
            )  # fmt: skip
    return base


def _wheel(
    base: ET.Element,
    joint: Joint,
    shape: BodyShape,
    physics: BodyPhysics,
    solids: tuple[LinkSolid, ...],
) -> None:
    wheel = _body(base, joint, armature=physics.armature)
    _inertial(wheel, physics.wheel_mass, physics.wheel_inertia(shape))
    size = (shape.wheel_radius, shape.wheel_width / 2, shape.wheel_radius)
    _tire(wheel, joint.child, "ellipsoid", size, physics)
    _geoms(wheel, joint.child, solids, touching=False)


def _caster(
    base: ET.Element,
    joints: tuple[Joint, ...],
    shape: BodyShape,
    physics: BodyPhysics,
    solids: dict[str, tuple[LinkSolid, ...]],
) -> None:
    """Add the swivel, and the wheel on it."""
    parent = base
    for joint in joints:
        parent = _body(parent, joint, damping=physics.caster_damping)
        _inertial(parent, physics.caster_mass, physics.caster_inertia(shape))
        if joint is joints[-1]:
            _tire(parent, joint.child, "sphere", (shape.caster_radius,), physics)
        _geoms(parent, joint.child, solids.get(joint.child, ()), touching=False)


def _body(parent: ET.Element, joint: Joint, **numbers: float) -> ET.Element:
    """Add a body that turns; `numbers` are attributes of its joint."""
    body = ET.SubElement(parent, "body", name=joint.child, pos=row(joint.x, joint.y, joint.z))
    given = {name: row(number) for name, number in numbers.items()}
    fixed = {"name": joint.name, "type": "hinge", "axis": AXES[joint.axis]}
    ET.SubElement(body, "joint", fixed | given)
    return body


def _inertial(
    body: ET.Element,
    mass: float,
    inertia: Inertia,
    at: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> None:
    moments = " ".join(f"{moment:.6g}" for moment in inertia)
    ET.SubElement(body, "inertial", pos=row(*at), mass=row(mass), diaginertia=moments)


def _tire(
    body: ET.Element, link: str, shape: str, size: tuple[float, ...], physics: BodyPhysics
) -> None:
    """Add a tire whose contact settings hold on any floor, by its priority."""
    ET.SubElement(
        body, "geom", name=link, type=shape, size=row(*size), group=COLLISION, mass="0",
        priority="1", condim="3", friction=row(physics.friction, 0.005, 0.0001),
        solref=row(*physics.contact.solref), solimp=row(*physics.contact.solimp),
        rgba="0 0 0 0.3",
    )  # fmt: skip


def _geoms(
    body: ET.Element,
    link: str,
    solids: tuple[LinkSolid, ...],
    place: LinkPose = HERE,
    *,
    touching: bool = True,
) -> None:
    """Add the solids of a link: once for the eye, and those that touch things once more."""
    frame = None
    for name, (solid, kind) in _names(link, solids, touching=touching):
        if frame is None:
            frame = ET.SubElement(
                body, "frame", name=link, pos=row(*place[:3]), quat=_turn(0.0, 0.0, place.yaw)
            )
        x, y, z = solid.size
        size = (x / 2, z / 2) if solid.is_round else (x / 2, y / 2, z / 2)
        geom = ET.SubElement(
            frame, "geom", name=name,
            type="cylinder" if solid.is_round else "box", size=row(*size), pos=row(*solid.at),
            quat=_turn(*solid.turned), mass="0", rgba=row(*COLORS[solid.color], 1.0),
        )  # fmt: skip
        if kind == COLLIDES:
            geom.attrib |= {"group": COLLISION}
            if link == Frames().bumper_link:
                geom.set("gap", row(REACH))
        else:
            geom.attrib |= {"group": VISUAL, "contype": "0", "conaffinity": "0"}


def _names(
    link: str, solids: tuple[LinkSolid, ...], *, touching: bool
) -> Iterator[tuple[str, tuple[LinkSolid, str]]]:
    """Yield the name of each geom of a link, its solid, and whether it is seen or touches."""
    kinds = [(solid, "visual") for solid in solids]
    kinds += [(solid, COLLIDES) for solid in solids if solid.hits and touching]
    for number, (solid, kind) in enumerate(kinds):
        yield f"{link}_{kind}_{number}", (solid, kind)


def _motors(root: ET.Element, tree: FrameTree, physics: BodyPhysics) -> None:
    """Add a wheel-speed loop a side; over a tendon where a belt couples two wheels."""
    tendons, belts = ET.Element("tendon"), ET.Element("equality")
    actuators = ET.SubElement(root, "actuator")
    for number, side in enumerate(SIDES):
        first, *others = tree.wheels[number::2]
        target = {"joint": first.name}
        if others:
            target = {"tendon": side}
            fixed = ET.SubElement(tendons, "fixed", name=side)
            for joint in (first, *others):
                ET.SubElement(fixed, "joint", joint=joint.name, coef=row(1 / (1 + len(others))))
        for joint in others:
            ET.SubElement(
                belts, "joint", name=f"{side}_belt", joint1=first.name, joint2=joint.name,
                polycoef="0 1 0 0 0", solref=row(*BELT),
            )  # fmt: skip
        loop = {
            "name": side,
            "kp": row(physics.loop_gain),
            "kv": row(physics.loop_damping),
            "forcerange": row(-physics.side_torque, physics.side_torque),
        }
        ET.SubElement(actuators, "intvelocity", loop | target)
    root.extend(element for element in (tendons, belts) if len(element))


def _turn(roll: float, pitch: float, yaw: float) -> str:
    return row(*quaternion(roll, pitch, yaw))
