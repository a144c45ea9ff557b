from dataclasses import replace
from math import hypot
from typing import Any
from xml.etree import ElementTree as ET

import pytest

from pioneer3.models import RobotModel, load_model, physics_of, shape_of, total_mass
from pioneer3.models.description.mjcf import SIDES, mjcf_of
from pioneer3.models.description.tree import wheel_joint_names
from tests.support import DISTINCT
from tests.unit.models.mujoco_robot import Drive, mujoco

EVERY = [load_model(name) for name in DISTINCT]
TYPES = [load_model(name) for name in ("p3at-sh", "p3dx-sh", "amigo-sh", "peoplebot-sh")]
P3AT, P3DX = TYPES[:2]

every = pytest.mark.parametrize("model", EVERY, ids=lambda model: model.name)
every_type = pytest.mark.parametrize("model", TYPES, ids=lambda model: model.name)


def compiled(model: RobotModel) -> Any:
    """Return the model of a robot on a floor."""
    return mujoco.MjModel.from_xml_string(mjcf_of(model, floor=True))


@every
def test_every_element_has_a_name(model: RobotModel) -> None:
    root = ET.fromstring(mjcf_of(model))
    named = ("body", "joint", "freejoint", "geom", "site", "camera", "frame", "fixed", "exclude")
    for tag in (*named, "intvelocity"):
        inside = [each for each in root.iter(tag) if "coef" not in each.attrib]
        names = [each.get("name") for each in inside]
        assert all(names)
        assert len(set(names)) == len(names)


@every
def test_robots_can_be_attached_to_a_world_side_by_side(model: RobotModel) -> None:
    world = mujoco.MjSpec()
    world.option.timestep = 0.002
    for number in range(2):
        child = mujoco.MjSpec.from_string(mjcf_of(model))
        world.option.integrator, world.option.cone = child.option.integrator, child.option.cone
        world.option.impratio = child.option.impratio
        frame = world.worldbody.add_frame(pos=[2.0 * number, 0.0, 0.0])
        world.attach(child, prefix=f"r{number}/", frame=frame)
    both = world.compile()
    assert both.body("r1/base_link").pos[0] == 2.0
    assert both.body_mass.sum() == pytest.approx(2 * total_mass(model))
    assert {both.actuator(number).name for number in range(4)} == {
        f"r{number}/{side}" for number in range(2) for side in SIDES
    }


@every
def test_sensors_are_where_the_model_has_them(model: RobotModel) -> None:
    robot = compiled(model)
    data = mujoco.MjData(robot)
    mujoco.mj_forward(robot, data)
    for number, mount in enumerate(model.sonars):
        x, y, z = data.site(f"sonar_{number}").xpos
        assert (x, y, z) == pytest.approx((mount.x, mount.y, shape_of(model).sonar_height))
    if model.laser is not None:
        assert data.site("laser").xpos[0] == pytest.approx(model.laser.x)
    assert data.site("imu_link").xpos[0] == 0.0
    assert {robot.joint(name).type[0] for name in wheel_joint_names(model)} == {3}


@every_type
def test_a_robot_stands_still_on_all_wheels(model: RobotModel) -> None:
    robot = Drive(model, compiled(model))
    mujoco.mj_step(robot.compiled, robot.data, 1000)
    assert abs(robot.data.qvel).max() < 1e-6
    assert robot.data.ncon == 2 * len(shape_of(model).axles) + (shape_of(model).caster is not None)


@pytest.mark.parametrize("length", [0.03, 0.25])
@pytest.mark.parametrize("mounts", [(), (0.166,), (0.01, -0.01), (-0.2,)])
def test_a_robot_with_sonars_anywhere_or_nowhere_has_a_body(
    mounts: tuple[float, ...], length: float
) -> None:
    sonars = tuple(replace(P3DX.sonars[0], x=x) for x in mounts)
    model = replace(P3DX, sonars=sonars, length_front=length, length_rear=length)
    robot = Drive(model, compiled(model))
    assert robot.place == pytest.approx((0.0, 0.0, 0.0), abs=1e-3)


@every_type
def test_a_robot_drives_a_metre_straight_on_its_rolling_radius(model: RobotModel) -> None:
    robot = Drive(model, compiled(model))
    robot.drive(0.3, 0.0, 1 / 0.3)
    robot.drive(0.0, 0.0, 2.0)
    x, y, heading = robot.place
    assert x == pytest.approx(1.0, abs=0.002)
    assert abs(y) < 1e-6
    assert abs(heading) < 1e-6
    measured = x / robot.turned[0]
    assert measured == pytest.approx(physics_of(model).rolling_radius, abs=0.1e-3)


@pytest.mark.parametrize(("speed", "rate"), [(0.0, 0.2), (0.0, 1.0), (0.0, 2.0), (0.5, 0.5)])
@pytest.mark.parametrize(
    ("model", "tolerance"),
    [(P3AT, 0.07), (P3DX, 0.01)],
    ids=lambda value: getattr(value, "name", ""),
)
def test_a_robot_turns_as_its_effective_track_says(
    model: RobotModel, tolerance: float, speed: float, rate: float
) -> None:
    robot = Drive(model, compiled(model))
    robot.drive(speed, rate, speed / 0.3 + 1.4)
    before, heading = robot.turned, robot.place[2]
    robot.contacts.clear()
    robot.drive(speed, rate, 1.0)
    left, right = (after - b for after, b in zip(robot.turned, before, strict=True))
    turn = (robot.place[2] - heading) % 6.283185307179586
    track = (right - left) * physics_of(model).rolling_radius / turn
    assert track == pytest.approx(shape_of(model).effective_track, rel=tolerance)
    assert track == pytest.approx(physics_of(model).turning_track, rel=0.01)
    assert sum(robot.contacts) == len(robot.contacts) * max(robot.contacts)
    assert max(robot.contacts) == (4 if model is P3AT else 3)


@every_type
def test_a_robot_stalls_at_a_wall(model: RobotModel) -> None:
    spec = mujoco.MjSpec.from_string(mjcf_of(model, floor=True))
    spec.worldbody.add_geom(
        name="wall", type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.1, 2, 1], pos=[0.75, 0, 1]
    )
    robot = Drive(model, spec.compile())
    robot.drive(0.3, 0.0, 5.0)
    wheels = [
        float(robot.data.qvel[robot.compiled.joint(name).dofadr[0]])
        for name in wheel_joint_names(model)
    ]
    most = physics_of(model).side_torque
    assert [abs(robot.data.actuator(side).force[0]) for side in SIDES] == pytest.approx([most] * 2)
    assert max(map(abs, wheels)) * shape_of(model).wheel_radius < 0.03


def test_effective_tracks_are_those_of_the_theory() -> None:
    assert shape_of(P3AT).effective_track == pytest.approx(0.590, abs=0.001)
    assert shape_of(P3DX).effective_track == 0.330
    assert shape_of(P3AT).wheelbase == pytest.approx(0.268)
    shape = shape_of(P3AT)
    corner = hypot(shape.track, shape.wheelbase)
    assert shape.effective_track > corner**2 / shape.track


@every_type
def test_the_camera_stands_on_something(model: RobotModel) -> None:
    robot, shape = Drive(model, compiled(model)), shape_of(model)
    height = float(robot.data.cam_xpos[0, 2])
    carried = max(shape.height, shape.laser_height if model.laser else 0.0)
    assert 0.0 < height - carried < 0.15
