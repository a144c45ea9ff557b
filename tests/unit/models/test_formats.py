"""A robot drives to the same place in MuJoCo, whether it comes from its MJCF, URDF or SDF.

URDF and SDF give links, joints, masses and shapes; motors and tires, for which MuJoCo has settings
of its own, are those of the MJCF.
"""

from collections.abc import Callable
from math import dist, pi
from xml.etree import ElementTree as ET

import pytest

from pioneer3.models import RobotModel, load_model, physics_of, total_mass
from pioneer3.models.description.mjcf import mjcf_of
from pioneer3.models.description.sdf import sdf_of
from pioneer3.models.description.tree import Frames, body_tree
from pioneer3.models.description.urdf import describe
from pioneer3.models.description.xml import quaternion, row
from tests.unit.models.mujoco_robot import Drive, mujoco

TYPES = [load_model(name) for name in ("p3at-sh", "p3dx-sh", "amigo-sh", "peoplebot-sh")]
SIZES = {"box": "size", "cylinder": "radius", "sphere": "radius"}


def from_urdf(model: RobotModel) -> ET.Element:
    """Return the bodies that MuJoCo reads in the URDF."""
    frames = Frames()
    spec = mujoco.MjSpec.from_string(describe(model, body_tree(model, frames), frames))
    spec.compiler.fusestatic = False
    spec.compile()
    (base,) = ET.fromstring(spec.to_xml()).findall("worldbody/body")
    return base


def from_sdf(model: RobotModel) -> ET.Element:
    """Return the bodies of the SDF: its links, joints, masses and the shapes that touch."""
    (robot,) = ET.fromstring(sdf_of(model)).findall("model")
    bodies: dict[str, ET.Element] = {}
    for frame in robot.findall("frame"):
        bodies[frame.attrib["name"]] = ET.Element("body", name=frame.attrib["name"])
    for link in robot.findall("link"):
        body = bodies[link.attrib["name"]] = ET.Element("body", name=link.attrib["name"])
        moments = (link.findtext(f"inertial/inertia/{axis}", "") for axis in ("ixx", "iyy", "izz"))
        at, _ = pose(link, "inertial/pose")
        mass = link.findtext("inertial/mass", "")
        ET.SubElement(body, "inertial", pos=at, mass=mass, diaginertia=" ".join(moments))
    parents = {
        joint.findtext("child", ""): (joint.findtext("parent", ""), joint)
        for joint in robot.findall("joint")
    }
    for part in (*robot.findall("frame"), *robot.findall("link")):
        name = part.attrib["name"]
        if name == robot.get("canonical_link"):
            continue
        parent, joint = parents.get(name, (part.get("attached_to", ""), None))
        assert part.find("pose[@relative_to]") is None or joint is not None
        bodies[name].attrib |= dict(zip(("pos", "quat"), pose(part, "pose"), strict=True))
        bodies[parent].append(bodies[name])
        if joint is not None:
            axis = joint.findtext("axis/xyz", "")
            ET.SubElement(bodies[name], "joint", name=joint.attrib["name"], axis=axis)
    for link in robot.findall("link"):
        for collision in link.findall("collision"):
            at, turned = pose(collision, "pose")
            (where,) = [*collision.findall("pose")] or [ET.Element("pose")]
            on = bodies[where.get("relative_to", link.attrib["name"])]
            (shape,) = collision.findall("geometry/*")
            size = [float(word) for word in shape.findtext(SIZES[shape.tag], "").split()]
            if shape.tag == "box":
                size = [side / 2 for side in size]
            elif shape.tag == "cylinder":
                size.append(float(shape.findtext("length", "")) / 2)
            ET.SubElement(on, "geom", type=shape.tag, size=row(*size), pos=at, quat=turned)
    return bodies[robot.get("canonical_link", "")]


def pose(element: ET.Element, path: str) -> tuple[str, str]:
    """Return a position and a quaternion."""
    x, y, z, *turns = (float(word) for word in element.findtext(path, "0 0 0 0 0 0").split())
    roll, pitch, yaw = turns
    return row(x, y, z), row(*quaternion(roll, pitch, yaw))


def with_motors(model: RobotModel, base: ET.Element) -> str:
    """Return the MJCF of the robot, its bodies replaced; tires keep their size and place."""
    root = ET.fromstring(mjcf_of(model, floor=True))
    (world,) = root.findall("worldbody")
    (own,) = world.findall("body")
    world.remove(own)
    world.append(base)
    base.insert(0, ET.Element("freejoint", name="base"))
    for geom in base.iter("geom"):
        geom.set("mass", "0")
    tires = ("friction", "solref", "solimp", "priority", "condim")
    for joint in body_tree(model, Frames()).moving:
        (mine,) = own.findall(f".//joint[@name='{joint.name}']")
        (body,) = [each for each in base.iter("body") if each.get("name") == joint.child]
        (turning,) = body.findall("joint")
        turning.attrib |= {
            key: mine.attrib[key] for key in set(mine.keys()) & {"armature", "damping"}
        }
        for geom in body.findall("geom"):
            (tire,) = own.findall(f".//geom[@name='{joint.child}']")
            geom.attrib |= {key: tire.attrib[key] for key in tires}
            if geom.get("type") == "cylinder":  # a point of contact in the middle, not two
                radius, half = geom.attrib["size"].split()
                geom.attrib |= {"type": "ellipsoid", "size": f"{radius} {radius} {half}"}
    return ET.tostring(root, encoding="unicode")


def way(model: RobotModel, text: str) -> list[tuple[float, float, float]]:
    """Drive ahead, round a bend, on the spot and back; return the places after each."""
    robot = Drive(model, mujoco.MjModel.from_xml_string(text))
    assert robot.compiled.body_mass.sum() == pytest.approx(total_mass(model))
    places = []
    for speed, rate in ((0.3, 0.0), (0.3, 0.5), (0.0, -0.8), (-0.2, 0.0)):
        robot.drive(speed, rate, 3.0)
        robot.drive(0.0, 0.0, 1.5)
        places.append(robot.place)
    return places


@pytest.mark.parametrize(
    ("model", "read"),
    [
        pytest.param(
            model,
            read,
            id=f"{model.name}-{read.__name__}",
            marks=() if is_urdf == model.name.startswith("p3") else pytest.mark.thorough,
        )
        for model in TYPES
        for is_urdf, read in ((True, from_urdf), (False, from_sdf))
    ],
)
def test_a_robot_of_every_format_drives_to_the_same_place(
    model: RobotModel, read: Callable[[RobotModel], ET.Element]
) -> None:
    expected = way(model, mjcf_of(model, floor=True))
    places = way(model, with_motors(model, read(model)))
    assert dist(expected[1][:2], (0.0, 0.0)) > 1.0
    for (x, y, heading), (x_, y_, heading_) in zip(places, expected, strict=True):
        assert dist((x, y), (x_, y_)) < 0.002
        assert abs((heading - heading_ + pi) % (2 * pi) - pi) < 0.005


def test_a_caster_that_touches_nothing_lets_the_robot_fall() -> None:
    """Which shows that the places above depend on the shapes of the format."""
    model = TYPES[1]
    base = from_urdf(model)
    (caster,) = [body for body in base.iter("body") if body.get("name") == "caster"]
    for geom in caster.findall("geom"):
        caster.remove(geom)
    robot = Drive(model, mujoco.MjModel.from_xml_string(with_motors(model, base)))
    assert abs(robot.data.joint("base").qpos[4:6]).max() > 0.05
    assert physics_of(model).center_x < 0
