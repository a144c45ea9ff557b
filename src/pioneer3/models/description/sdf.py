"""A robot as SDF 1.9, the format of Gazebo: links, wheels that drive, and sensors."""

from typing import Final
from xml.etree import ElementTree as ET

from pioneer3.models import BodyShape, RobotModel, physics_of, shape_of
from pioneer3.models.description import gazebo
from pioneer3.models.description.solids import COLORS, LinkSolid, solids_of
from pioneer3.models.description.tree import Frames, FrameTree, Joint, body_tree
from pioneer3.models.description.xml import AXES, MAKER, Inertial, document, inertials_of, row
from pioneer3.models.lasers import LASERS

VERSION: Final = "1.9"
"""The one of Gazebo Fortress; later ones read it."""
ODOMETRY_RATE: Final = 10.0
"""Rate of odometry and joints [Hz]: the robot's own."""
IMU_RATE: Final = 100.0
"""[Hz]."""
SONAR_RATE: Final = 3.125
"""Rate of one transducer [Hz]: eight take turns, 40 ms each."""
SONAR_CONE: Final = 0.26
"""Width of the cone that rays of a sonar fill [rad]: Gazebo has no sonar."""
SONAR_RAYS: Final = 5
"""Across that cone, and again from its bottom to its top."""
SONAR_NEAR = 0.15
"""Shortest range [m]."""
SONAR_FAR = 5.0
"""Longest range [m]."""
OUTSIDE: Final = 0.1
"""Shortest range of a laser [m]: rays begin outside its housing."""
USUAL_LASER: Final = LASERS["lms-200"]
"""In the place of a laser that is not known."""


def sdf_of(model: RobotModel) -> str:
    """Return the SDF of one robot.

    Links that never move are frames of `base_link`, whose origin is on the floor, in the centre
    of the robot's rotation. Topics are those of `gazebo.bridge_of`. The world must have Gazebo's
    systems for sensors, IMU and contacts.
    """
    frames = Frames()
    tree, shape, physics = body_tree(model, frames), shape_of(model), physics_of(model)
    solids = solids_of(model, tree, frames)
    inertials = inertials_of(model, tree)
    root = ET.Element("sdf", version=VERSION)
    robot = ET.SubElement(root, "model", name=model.name, canonical_link=tree.base)
    robot.append(ET.Comment(f" {MAKER} "))
    for joint in tree.fixed:
        if joint.child == tree.base:  # links carry frames, so the link's own parent sits on it
            ET.SubElement(robot, "frame", name=joint.parent, attached_to=joint.child)
            continue
        frame = ET.SubElement(robot, "frame", name=joint.child, attached_to=joint.parent)
        _pose(frame, (joint.x, joint.y, joint.z), joint.rpy)
    base = _link(robot, tree.base, inertials[tree.base])
    for name in tree.fixed_in_base():
        _solids(base, name, solids.get(name, ()), on="" if name == tree.base else name)
    _sensors(base, model, frames)
    _touch(base, frames, solids.get(frames.bumper_link, ()))
    for joint in tree.moving:
        link = _link(robot, joint.child, inertials[joint.child], joint)
        _solids(link, joint.child, solids.get(joint.child, ()))
        if joint in tree.caster[-1:]:
            _roller(link, shape.caster_radius)
        _grip(link, physics.friction)
        axis = _joint(robot, joint)
        if joint in tree.wheels:
            effort = physics.side_torque / len(shape.axles)
            _text(ET.SubElement(axis, "limit"), "effort", effort)
        else:
            _text(ET.SubElement(axis, "dynamics"), "damping", physics.caster_damping)
    _drive(robot, model, tree, shape)
    return document(root)


def _roller(link: ET.Element, radius: float) -> None:
    """Let the wheel of a caster touch the floor, as a ball."""
    collision = ET.SubElement(link, "collision", name=f"{link.get('name')}_collision")
    sphere = ET.SubElement(ET.SubElement(collision, "geometry"), "sphere")
    _text(sphere, "radius", radius)


def _grip(link: ET.Element, friction: float) -> None:
    """Give a tire its friction."""
    for collision in link.iter("collision"):
        part = ET.SubElement(ET.SubElement(collision, "surface"), "friction")
        ode = ET.SubElement(part, "ode")
        _text(ode, "mu", friction)
        _text(ode, "mu2", friction)


def _joint(robot: ET.Element, joint: Joint) -> ET.Element:
    """Add a joint that turns; return its axis."""
    turning = ET.SubElement(robot, "joint", name=joint.name, type="continuous")
    _text(turning, "parent", joint.parent)
    _text(turning, "child", joint.child)
    axis = ET.SubElement(turning, "axis")
    _text(axis, "xyz", AXES[joint.axis])
    return axis


def _link(
    robot: ET.Element, name: str, inertial: Inertial, joint: Joint | None = None
) -> ET.Element:
    """Add a link with its mass, where the joint has it."""
    link = ET.SubElement(robot, "link", name=name)
    if joint:
        _pose(link, (joint.x, joint.y, joint.z), relative_to=joint.parent)
    part = ET.SubElement(link, "inertial")
    _pose(part, inertial.at)
    _text(part, "mass", inertial.mass)
    inertia = ET.SubElement(part, "inertia")
    for name_, moment in zip(("ixx", "iyy", "izz"), inertial.inertia, strict=True):
        _text(inertia, name_, f"{moment:.6g}")
    return link


def _solids(link: ET.Element, name: str, solids: tuple[LinkSolid, ...], on: str = "") -> None:
    """Add solids in the coordinates of the frame `on`, the link's own if that is empty."""
    for number, solid in enumerate(solids):
        visual = _solid(link, "visual", f"{name}_visual_{number}", solid, on)
        material = ET.SubElement(visual, "material")
        for kind in ("ambient", "diffuse"):
            _text(material, kind, row(*COLORS[solid.color], 1.0))
    for number, solid in enumerate(solid for solid in solids if solid.hits):
        _solid(link, "collision", f"{name}_collision_{number}", solid, on)


def _solid(link: ET.Element, kind: str, name: str, solid: LinkSolid, on: str) -> ET.Element:
    part = ET.SubElement(link, kind, name=name)
    _pose(part, solid.at, solid.turned, relative_to=on)
    geometry = ET.SubElement(part, "geometry")
    if solid.is_round:
        cylinder = ET.SubElement(geometry, "cylinder")
        _text(cylinder, "radius", solid.size[0] / 2)
        _text(cylinder, "length", solid.size[2])
    else:
        _text(ET.SubElement(geometry, "box"), "size", row(*solid.size))
    return part


def _sensors(base: ET.Element, model: RobotModel, frames: Frames) -> None:
    _sensor(base, "imu", frames.imu, gazebo.TURN_RATE, IMU_RATE)
    if model.laser is not None:
        name = model.laser.kind.lower()
        kind = next((laser for laser in LASERS.values() if name in laser.kinds), USUAL_LASER)
        sensor = _sensor(base, "gpu_lidar", frames.laser, gazebo.SCAN, 1 / kind.turn)
        rays = _rays(sensor, (max(kind.near, OUTSIDE), kind.far))
        _across(rays, "horizontal", kind.count, kind.first, kind.last)
    for number in range(len(model.sonars)):
        topic = gazebo.sonar(number)
        sensor = _sensor(base, "gpu_lidar", frames.transducer(number), topic, SONAR_RATE)
        rays = _rays(sensor, (SONAR_NEAR, SONAR_FAR))
        for direction in ("horizontal", "vertical"):
            _across(rays, direction, SONAR_RAYS, -SONAR_CONE / 2, SONAR_CONE / 2)


def _sensor(
    base: ET.Element, kind: str, frame: str, topic: gazebo.Exchange, rate: float
) -> ET.Element:
    sensor = ET.SubElement(base, "sensor", name=frame, type=kind)
    _pose(sensor, (0.0, 0.0, 0.0), relative_to=frame)
    _text(sensor, "topic", topic.topic)
    _text(sensor, gazebo.FRAME_ID, frame)
    _text(sensor, "update_rate", rate)
    _text(sensor, "always_on", "true")
    return sensor


def _rays(sensor: ET.Element, reach: tuple[float, float]) -> ET.Element:
    """Add a lidar with this nearest and farthest range [m]; return the element for its rays."""
    lidar = ET.SubElement(sensor, "lidar")
    scan = ET.SubElement(lidar, "scan")
    limits = ET.SubElement(lidar, "range")
    for name, metres in zip(("min", "max"), reach, strict=True):
        _text(limits, name, metres)
    return scan


def _across(scan: ET.Element, direction: str, count: int, first: float, last: float) -> None:
    rays = ET.SubElement(scan, direction)
    for name, number in (("samples", count), ("min_angle", first), ("max_angle", last)):
        _text(rays, name, number)


def _touch(base: ET.Element, frames: Frames, bumpers: tuple[LinkSolid, ...]) -> None:
    """Add a contact sensor for each piece of the bumpers; all have one topic."""
    for number in range(sum(solid.hits for solid in bumpers)):
        sensor = ET.SubElement(base, "sensor", name=f"bumper_{number}", type="contact")
        _text(sensor, "update_rate", ODOMETRY_RATE)
        _text(sensor, "always_on", "true")
        contact = ET.SubElement(sensor, "contact")
        _text(contact, "collision", f"{frames.bumper_link}_collision_{number}")
        _text(contact, "topic", gazebo.BUMPERS.topic)


def _drive(robot: ET.Element, model: RobotModel, tree: FrameTree, shape: BodyShape) -> None:
    drive = ET.SubElement(robot, "plugin", gazebo.DRIVE._asdict())
    for number, joint in enumerate(tree.wheels):
        _text(drive, "right_joint" if number % 2 else "left_joint", joint.name)
    for name, value in (
        ("wheel_separation", shape.effective_track),
        ("wheel_radius", shape.wheel_radius),
        ("odom_publish_frequency", ODOMETRY_RATE),
        ("topic", gazebo.COMMAND.topic),
        ("odom_topic", gazebo.ODOMETRY.topic),
        ("tf_topic", gazebo.TRANSFORMS.topic),
        ("frame_id", Frames().odom),
        ("child_frame_id", tree.root),
        ("min_linear_velocity", -model.max_speed),
        ("max_linear_velocity", model.max_speed),
        ("min_linear_acceleration", -model.deceleration),
        ("max_linear_acceleration", model.acceleration),
        ("min_angular_velocity", -model.max_turn_rate),
        ("max_angular_velocity", model.max_turn_rate),
        ("min_angular_acceleration", -model.turn_deceleration),
        ("max_angular_acceleration", model.turn_acceleration),
    ):
        _text(drive, name, value)
    joints = ET.SubElement(robot, "plugin", gazebo.JOINTS._asdict())
    _text(joints, "topic", gazebo.WHEELS.topic)
    for joint in tree.moving:
        _text(joints, "joint_name", joint.name)
    _text(joints, "update_rate", ODOMETRY_RATE)


def _pose(
    element: ET.Element,
    at: tuple[float, float, float],
    turned: tuple[float, float, float] = (0.0, 0.0, 0.0),
    *,
    relative_to: str = "",
) -> None:
    """Add a pose [m, rad] in the coordinates of a frame; of the parent if that is empty."""
    pose = ET.SubElement(element, "pose", {"relative_to": relative_to} if relative_to else {})
    pose.text = row(*at, *turned)


def _text(element: ET.Element, name: str, content: float | str) -> None:
    ET.SubElement(element, name).text = content if isinstance(content, str) else row(content)
