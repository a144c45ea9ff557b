"""Sensors in three dimensions: as on the plane where the floor is flat, and otherwise not."""

from dataclasses import replace
from math import pi, radians

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.maps.materials import Material
from pioneer3.models import load_model, shape_of
from pioneer3.sim.body import Body
from pioneer3.sim.kernels import laser_fan
from pioneer3.sim.realism import Realism, SonarErrors
from pioneer3.sim.world import World
from pioneer3.sim.worldfile import Box, Person, WorldFile
from pioneer3.sim.worldfile.spec import Wall

pytest.importorskip("mujoco")
from pioneer3.sim.physics import rays
from pioneer3.sim.physics.dynamics import MujocoDynamics

MODELS = ["p3at-sh", "p3dx-sh", "amigo-sh", "peoplebot-sh"]
FAN = laser_fan((0.0, 0.0, 0.0), -pi / 2, pi / 180, 181)
ROOM = WorldFile(
    name="room",
    walls=(Wall(points=((-3.0, -2.0), (4.0, -2.0), (4.0, 3.0), (-3.0, 3.0)), closed=True),),
)
EXACT = SonarErrors(noise=0.0, quantum=0.0, drop_out=0.0, cross_talk=0.0, cycle=0.0)
poses = st.builds(Pose2, st.floats(-2.0, 3.0), st.floats(-1.0, 2.0), st.floats(-pi, pi))


def pair(model: str, pose: Pose2 = ORIGIN, *others: Body, world: WorldFile = ROOM) -> list[World]:
    """The same world with physics, and on the plane."""
    line_map, realism = world.line_map(), Realism(sonar=EXACT)
    return [
        World(
            line_map,
            [Body(load_model(model), pose), *(Body(o.model, o.robot_in_world) for o in others)],
            dynamics=dynamics,
            realism=realism,
            relief=world.relief(line_map),
        )
        for dynamics in (MujocoDynamics(), None)
    ]


def exact(world: World) -> list[np.ndarray]:
    """Exact ranges of the sonars and of a laser of the first robot."""
    body = world.robots[0]
    mount = body.model.laser or ORIGIN
    fan = laser_fan((mount.x, mount.y, 0.0), -pi / 2, pi / 180, 181)
    return [world.sonar(body), world.look(body, fan, 30.0)[0]]


@pytest.mark.parametrize("model", MODELS)
def test_among_walls_alone_it_is_as_on_the_plane(model: str) -> None:
    physical, planar = pair(model, Pose2(0.5, 0.3, 0.7))
    for one, other in zip(exact(physical), exact(planar), strict=True):
        assert one.tolist() == other.tolist()


@pytest.mark.parametrize("material", Material)
def test_fixed_boxes_are_as_on_the_plane_whatever_they_are_made_of(material: Material) -> None:
    box = Box(pose=Pose2(2.0, 0.3, 0.4), size=(0.5, 0.8), material=material)
    world = replace(ROOM, boxes=(box,))
    for y in (-1.0, 0.0, 1.0):
        physical, planar = pair("p3dx-sh", Pose2(0.0, y), world=world)
        for one, other in zip(
            *(each.look(each.robots[0], FAN, 30.0) for each in (physical, planar)), strict=True
        ):
            assert one.tolist() == other.tolist()


@settings(max_examples=20, deadline=None)
@given(poses)
def test_rays_in_three_dimensions_agree_with_the_kernels(pose: Pose2) -> None:
    physical, planar = pair("p3dx-sh", pose)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(rays, "LEVEL", 2.0)  # no robot is level: all rays are cast by MuJoCo
        three = physical.look(physical.robots[0], FAN, 30.0)[0]
    plane = planar.look(planar.robots[0], FAN, 30.0)[0]
    # walls are 1 cm thick there
    assert three == pytest.approx(plane, abs=0.006 / np.sin(radians(5)))
    assert np.median(abs(three - plane)) < 0.008


@pytest.mark.parametrize("model", MODELS)
def test_a_robot_senses_no_part_of_itself(model: str) -> None:
    world = World(None, [Body(load_model(model))], dynamics=MujocoDynamics())
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(rays, "LEVEL", 2.0)
        sonar = world.sonar(world.robots[0])
        laser = world.look(world.robots[0], laser_fan((0.0, 0.0, 0.0), 0.0, pi / 180, 360), 30.0)[0]
    assert (sonar == 5.0).all()
    assert (laser == 30.0).all()


def test_a_laser_passes_above_a_robot_without_one_and_a_sonar_does_not() -> None:
    other = Body(load_model("amigo-sh"), Pose2(1.0, 0.0))
    physical, planar = pair("p3dx-sh", ORIGIN, other)
    assert planar.look(planar.robots[0], FAN, 30.0)[0][90] < 1.0
    assert physical.look(physical.robots[0], FAN, 30.0)[0][90] == pytest.approx(4.0)


def test_boxes_and_people_are_met_at_the_height_of_the_sensor() -> None:
    physical, planar = pair("p3dx-sh")
    for world in (physical, planar):
        world.add_obstacle(Box(pose=Pose2(2.0, 0.0), size=(0.4, 0.4), movable=True))
        world.add_obstacle(Person(path=((0.0, 1.5),)))
    for one, other in zip(exact(physical), exact(planar), strict=True):
        assert one == pytest.approx(other, abs=0.02)


def test_ghosts_are_not_sensed() -> None:
    other = Body(load_model("p3dx-sh"), Pose2(1.2, 0.0))
    physical, _ = pair("p3dx-sh", ORIGIN, other)
    before = physical.sonar(physical.robots[0])
    physical.robots[1].ghost = True
    assert before[3] < 1.2
    assert physical.sonar(physical.robots[0])[3] > 3.0


def test_a_tilted_laser_sees_the_floor() -> None:
    body = Body(load_model("p3dx-sh"))
    dynamics = MujocoDynamics()
    world = World(ROOM.line_map(), [body], dynamics=dynamics)
    scene, down = dynamics.scene, radians(10)
    scene.data.qpos[scene.base[0] + 3 : scene.base[0] + 7] = [
        np.cos(down / 2),
        0,
        np.sin(down / 2),
        0,
    ]
    ahead = world.look(body, laser_fan((0.0, 0.0, 0.0), 0.0, 0.1, 1), 30.0)[0][0]
    assert ahead == pytest.approx(shape_of(body.model).laser_height / np.tan(down), rel=0.05)


def test_light_goes_through_glass_at_a_slant() -> None:
    glass = Wall(points=((2.0, -1.5), (2.0, 2.5)), material=Material.GLASS)
    world = WorldFile(name="glass", walls=(*ROOM.walls, glass))
    for level in (False, True):
        physical, planar = pair("p3dx-sh", Pose2(0.0, 0.0), world=world)
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(rays, "LEVEL", rays.LEVEL if level else 2.0)
            three, codes = physical.look(physical.robots[0], FAN, 30.0)
        plane, expected = planar.look(planar.robots[0], FAN, 30.0)
        assert codes.tolist() == expected.tolist()
        assert three[70:110] == pytest.approx(plane[70:110], abs=0.01)


@pytest.mark.parametrize(("turned", "front", "rear"), [(0.0, True, False), (pi, False, True)])
def test_a_bumper_is_pressed_where_it_touches(turned: float, front: bool, rear: bool) -> None:
    body = Body(load_model("peoplebot-sh"), Pose2(0.0, 0.0, turned))
    body.enable_motors(on=True)
    wall = WorldFile(name="wall", walls=(Wall(points=((0.6, -2.0), (0.6, 2.0))),))
    world = World(wall.line_map(), [body], dynamics=MujocoDynamics())
    assert (body.front_bumpers, body.rear_bumpers) == (0, 0)
    body.drive.linear.go(0.2 if front else -0.2)
    for _ in range(150):
        world.step(0.02)
    assert (body.front_bumpers > 0, body.rear_bumpers > 0) == (front, rear)
    pressed = body.front_bumpers or body.rear_bumpers
    body.robot_in_world = Pose2(-3.0, 0.0)
    assert (body.front_bumpers, body.rear_bumpers) == (0, 0)
    assert pressed & 0b001000, f"the middle segment of five, not {pressed:b}"
