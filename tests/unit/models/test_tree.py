import shutil
import subprocess
from collections.abc import Callable
from math import cos, hypot, inf, isfinite, pi
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.models import (
    RobotModel,
    generic_model,
    load_model,
    physics_of,
    shape_of,
    total_mass,
)
from pioneer3.models.description.tree import (
    Frames,
    FrameTree,
    body_tree,
    bumper_corners,
    bumper_segments,
    tree_of,
    wheel_joint_names,
)
from pioneer3.models.description.urdf import describe
from pioneer3.ros.installation import MODELS
from pioneer3.ros.messages import motion
from pioneer3.ros.messages.update import MessageOptions
from tests.support import DISTINCT
from tests.unit.ros.support import P3AT, Blank, seen, update

EVERY = [load_model(name) for name in DISTINCT]
UNKNOWN = generic_model("p9", max_speed=inf, max_turn_rate=0.0)


def urdf(model: RobotModel, frames: Frames | None = None) -> ET.Element:
    """Return the description of a robot with bumpers."""
    names = frames or Frames()
    return ET.fromstring(describe(model, tree_of(model, names), names, bumpers=(5, 5)))


def only(element: ET.Element, tag: str) -> ET.Element:
    """Return the one part of an element that there must be."""
    (found,) = element.findall(tag)
    return found


def numbers(text: str | None) -> list[float]:
    """Return the numbers in an attribute."""
    assert text is not None
    return [float(word) for word in text.split()]


@pytest.mark.parametrize("model", [*EVERY, UNKNOWN], ids=lambda model: model.name)
def test_a_description_is_one_tree_of_known_links(model: RobotModel) -> None:
    robot = urdf(model)
    links = [link.get("name") for link in robot.findall("link")]
    joints = robot.findall("joint")
    assert len(set(links)) == len(links)
    assert len({joint.get("name") for joint in joints}) == len(joints)
    parents = {
        only(joint, "child").get("link"): only(joint, "parent").get("link") for joint in joints
    }
    assert set(parents) == set(links) - {"base_footprint"}
    assert parents["base_link"] == "base_footprint"
    for link in links:
        above = link
        for _ in links:
            above = parents.get(above, above)
        assert above == "base_footprint"


@pytest.mark.parametrize("model", [*EVERY, UNKNOWN], ids=lambda model: model.name)
def test_every_part_of_a_description_has_a_size_a_place_and_a_colour(model: RobotModel) -> None:
    robot = urdf(model)
    colors = {material.get("name") for material in robot.findall("material")}
    for visual in robot.iter("visual"):
        assert only(visual, "material").get("name") in colors
    for part in [*robot.iter("visual"), *robot.iter("collision")]:
        origin = only(part, "origin")
        assert len(numbers(origin.get("xyz"))) == len(numbers(origin.get("rpy"))) == 3
        (solid,) = only(part, "geometry")
        sizes = [number for value in solid.attrib.values() for number in numbers(value)]
        assert len(sizes) == (3 if solid.tag == "box" else 2)
        assert all(isfinite(size) and size > 0 for size in sizes)


@pytest.mark.parametrize("name", MODELS)
def test_sensors_are_drawn_where_the_model_has_them(name: str) -> None:
    model = load_model(name)
    at = {
        only(joint, "child").get("link"): (
            numbers(only(joint, "origin").get("xyz")),
            numbers(only(joint, "origin").get("rpy"))[2],
        )
        for joint in urdf(model).findall("joint")
    }
    for number, mount in enumerate(model.sonars):
        (x, y, z), yaw = at[f"sonar_{number}"]
        assert (x, y) == pytest.approx((mount.x, mount.y))
        assert cos(yaw - mount.theta) == pytest.approx(1.0)
        assert z == pytest.approx(shape_of(model).sonar_height)
    assert model.laser is not None
    assert at["laser"][0][0] == pytest.approx(model.laser.x)


@pytest.mark.parametrize("name", MODELS)
def test_wheels_stand_on_the_floor_and_turn_without_end(name: str) -> None:
    model = load_model(name)
    robot = urdf(model)
    turning = {j.get("name"): j for j in robot.findall("joint") if j.get("type") == "continuous"}
    assert tuple(turning) == wheel_joint_names(model)
    for joint in turning.values():
        child = only(joint, "child").get("link")
        tyre = only(robot, f"link[@name='{child}']/collision/geometry/cylinder")
        high = numbers(only(joint, "origin").get("xyz"))[2]
        assert high == pytest.approx(numbers(tyre.get("radius"))[0])
        assert only(joint, "axis").get("xyz") == "0 1 0"
    assert len(turning) == (4 if model.drive == "skid" else 2)


@pytest.mark.parametrize("name", MODELS)
def test_nothing_that_touches_sticks_out_of_the_robot(name: str) -> None:
    model = load_model(name)
    robot, tree = urdf(model), tree_of(model, Frames())
    places = {joint.child: joint for joint in tree.joints}
    for link in robot.findall("link"):
        joint = places.get(str(link.get("name")))
        for origin, box in zip(
            link.findall("collision/origin"), link.findall("collision/geometry/box"), strict=False
        ):
            x, y, z = numbers(origin.get("xyz"))
            far = hypot(*numbers(box.get("size"))[:2]) / 2
            x, y = x + (joint.x if joint else 0.0), y + (joint.y if joint else 0.0)
            assert -model.length_rear - 0.15 < x - far < x + far < model.length_front + 0.15
            assert abs(y) <= model.width / 2
            assert z + (joint.z if joint else 0.0) > 0


@pytest.mark.parametrize("model", [*EVERY, UNKNOWN], ids=lambda model: model.name)
@pytest.mark.parametrize("tree_of_kind", [tree_of, body_tree])
def test_masses_are_those_of_the_robot_whether_its_caster_moves_or_not(
    model: RobotModel, tree_of_kind: Callable[[RobotModel, Frames], FrameTree]
) -> None:
    robot = ET.fromstring(describe(model, tree_of_kind(model, Frames()), Frames()))
    masses = [numbers(mass.get("value"))[0] for mass in robot.iter("mass")]
    assert sum(masses) == pytest.approx(total_mass(model))
    for inertia in robot.iter("inertia"):
        x, y, z = (numbers(inertia.get(name))[0] for name in ("ixx", "iyy", "izz"))
        assert 2 * max(x, y, z) < x + y + z
        assert min(x, y, z) > 0


@pytest.mark.parametrize("model", [*EVERY, UNKNOWN], ids=lambda model: model.name)
def test_motors_of_a_description_have_the_robots_torque_and_a_transmission(
    model: RobotModel,
) -> None:
    robot = urdf(model)
    wheels = set(wheel_joint_names(model))
    limited = {joint.get("name"): joint.find("limit") for joint in robot.findall("joint")}
    limits = [limit for limit in limited.values() if limit is not None]
    assert {name for name, limit in limited.items() if limit is not None} == wheels
    efforts = [numbers(limit.get("effort"))[0] for limit in limits]
    assert sum(efforts) == pytest.approx(2 * physics_of(model).side_torque)
    for limit in limits:
        rim = numbers(limit.get("velocity"))[0] * shape_of(model).wheel_radius
        assert rim == pytest.approx(model.max_speed, rel=1e-5)
    moved = [each.attrib["name"] for each in robot.findall("transmission/joint")]
    assert sorted(moved) == sorted(wheels)


@pytest.mark.skipif(shutil.which("check_urdf") is None, reason="needs liburdfdom-tools")
@pytest.mark.parametrize("model", EVERY, ids=lambda model: model.name)
@pytest.mark.parametrize("tree_of_kind", [tree_of, body_tree])
def test_urdfdom_accepts_a_description(
    model: RobotModel, tree_of_kind: Callable[[RobotModel, Frames], FrameTree], tmp_path: Path
) -> None:
    file = tmp_path / "robot.urdf"
    file.write_text(describe(model, tree_of_kind(model, Frames()), Frames()))
    checked = subprocess.run(["check_urdf", file], capture_output=True, text=True, check=False)
    assert (checked.returncode, checked.stderr) == (0, "")
    assert "Successfully Parsed XML" in checked.stdout


def test_bumpers_go_round_the_outline_from_left_to_right() -> None:
    front, rear = bumper_segments(P3AT, 5), bumper_segments(P3AT, 5, rear=True)
    assert [pose.y for pose in front] == sorted((pose.y for pose in front), reverse=True)
    assert [pose.y for pose in rear] == sorted(pose.y for pose in rear)
    assert front[2].x == pytest.approx(P3AT.length_front)
    assert rear[2].x == pytest.approx(-P3AT.length_rear)
    assert abs(rear[2].theta) == pytest.approx(pi)
    assert len(bumper_corners(P3AT, 5)) == 6
    assert bumper_corners(P3AT, 0) == ()


def test_a_robot_without_bumpers_or_laser_is_drawn_without() -> None:
    names = Frames()
    bare = ET.fromstring(describe(P3AT, tree_of(P3AT, names), names, bumpers=(0, 0), laser=False))
    for link in ("bumpers", "laser"):
        assert bare.find(f"link[@name='{link}']") is not None
        assert bare.find(f"link[@name='{link}']/visual") is None


def test_wheels_can_have_other_names_as_many_as_there_are() -> None:
    frames = Frames()
    tree = tree_of(P3AT, frames, ("a", "b", "c", "d"))
    assert [joint.name for joint in tree.wheels] == ["a", "b", "c", "d"]
    with pytest.raises(ConfigError, match="4 wheels, not 2"):
        tree_of(P3AT, frames, ("a", "b"))


def test_two_frames_of_one_name_are_refused() -> None:
    with pytest.raises(ConfigError, match="both called 'laser'"):
        tree_of(P3AT, Frames(bumpers="laser"))
    with pytest.raises(ConfigError, match="both called 'base_link'"):
        tree_of(P3AT, Frames(odom="base_link"))


def test_a_base_may_be_the_footprint_and_what_is_in_its_own_coordinates() -> None:
    names = Frames(base="base_footprint", sonar="base_footprint", bumpers="base_footprint")
    children = {joint.child for joint in tree_of(P3AT, names).joints}
    assert "base_footprint" not in children
    assert "bumpers" in children


def test_without_a_footprint_the_base_is_the_root() -> None:
    names = Frames(footprint="")
    robot = urdf(P3AT, names)
    assert robot.find("link[@name='base_footprint']") is None
    assert robot.find("joint/child[@link='base_link']") is None
    assert names.with_prefix("r1/").root == "r1/base_link"


def test_transforms_lead_from_odometry_to_every_link_with_the_prefix() -> None:
    told = MessageOptions(prefix="r1/", wheels_tf=True)
    still, moving = Blank(), Blank()
    now = update(seen(), told)
    motion.fixed_transforms(still, now)
    motion.moving_transforms(moving, now)
    tree = {
        each.child_frame_id: each.header.frame_id
        for each in [*still.transforms, *moving.transforms]
    }
    assert len(tree) == len(still.transforms) + len(moving.transforms)
    assert tree["r1/base_footprint"] == "r1/odom"
    assert tree["r1/base_link"] == "r1/base_footprint"
    assert tree["r1/sonar_15"] == "r1/base_link"
    assert tree["r1/laser"] == "r1/top_plate"
    assert {each.header.stamp for each in moving.transforms} == {"now"}
    assert all(name.startswith("r1/") for pair in tree.items() for name in pair)


def test_the_transform_of_the_robot_says_what_odometry_says() -> None:
    message, pose = Blank(), Blank()
    now = update(seen(Pose2(2.0, 3.0, -1.0)))
    motion.moving_transforms(message, now)
    motion.odometry(pose, now)
    (transform,) = message.transforms
    assert transform.header == pose.header
    assert transform.child_frame_id == pose.child_frame_id == "base_footprint"
    place, rotation = transform.transform.translation, transform.transform.rotation
    position, orientation = pose.pose.pose.position, pose.pose.pose.orientation
    assert (place.x, place.y, place.z) == (position.x, position.y, 0.0)
    assert (rotation.x, rotation.y) == (0.0, 0.0)
    assert (rotation.z, rotation.w) == (orientation.z, orientation.w)


def test_wheels_are_either_moving_or_fixed_never_both() -> None:
    for turning in (True, False):
        still, moving = Blank(), Blank()
        now = update(seen(), MessageOptions(wheels_tf=turning), turned=(pi, 0.0))
        motion.fixed_transforms(still, now)
        motion.moving_transforms(moving, now)
        of = {
            where: {t.child_frame_id: t.transform.rotation for t in m.transforms}
            for where, m in (("still", still), ("moving", moving))
        }
        assert ("front_left_wheel" in of["moving"]) is turning
        assert ("front_left_wheel" in of["still"]) is not turning
        wheel = of["moving" if turning else "still"]["rear_left_wheel"]
        assert wheel.y == pytest.approx(1.0 if turning else 0.0)


def test_a_message_that_is_filled_again_has_nothing_of_before() -> None:
    mapped = ("earlier", Pose2(5.0, 6.0, 1.0))
    several = [
        update(seen(Pose2(2.0, 3.0, -1.0)), MessageOptions(wheels_tf=True), turned=(1.0, 2.0)),
        update(seen(Pose2(1.0)), MessageOptions(wheels_tf=True), odom_in_map=mapped),
        update(seen(Pose2(4.0)), MessageOptions(), odom_in_map=mapped),
        update(seen(), MessageOptions(odometry_tf=False)),
        update(seen(), MessageOptions(wheels_tf=True)),
    ]
    again = Blank(transforms=[])
    for each in several:
        anew = Blank(transforms=[])
        motion.moving_transforms(again, each)
        motion.moving_transforms(anew, each)
        assert again == anew


def test_a_tree_left_to_others_has_no_robot_in_it() -> None:
    message = Blank()
    motion.moving_transforms(message, update(seen(), MessageOptions(odometry_tf=False)))
    assert message.transforms == []
