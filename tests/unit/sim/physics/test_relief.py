"""Robots with mass on ramps, steps, carpets and terrain, and among solids of some height."""

from math import hypot, pi, radians, tan
from pathlib import Path

import numpy as np
import pytest

from pioneer3.errors import ConfigError
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.maps.image import to_png
from pioneer3.models import load_model
from pioneer3.sim.body import Body
from pioneer3.sim.kernels.drives import TOUCHED
from pioneer3.sim.relief import (
    FLAT,
    Carpet,
    Cylinder,
    HeightField,
    Mesh,
    Ramp,
    Solid,
    Step,
    Table,
)
from pioneer3.sim.world import World
from pioneer3.sim.worldfile import Box, Wall, WorldFile
from tests.unit.sim.solid_files import write_block, write_hill, write_u

pytest.importorskip("mujoco")
from pioneer3.sim.physics import elements
from pioneer3.sim.physics.dynamics import MujocoDynamics

TICK = 0.02
HEIGHT = 0.3
LENGTH = HEIGHT / tan(radians(10))
RAMP = Ramp(pose=Pose2(1.0 + LENGTH / 2, 0.0), size=(LENGTH, 1.5), height=HEIGHT)
PLATFORM = Step(pose=Pose2(2.0 + LENGTH, 0.0), size=(2.0, 1.5), height=HEIGHT)
SINK = 0.004
"""Of a P3-AT's tires [m]."""


def powered(model: str = "p3dx-sh", pose: Pose2 = ORIGIN) -> Body:
    body = Body(load_model(model), pose)
    body.enable_motors(on=True)
    return body


def physical(*bodies: Body, solids: tuple[Solid, ...] = (), **others: tuple[object, ...]) -> World:
    return of_file(WorldFile(name="w", solids=solids, **others), *bodies)  # type: ignore[arg-type]


def of_file(file: WorldFile, *bodies: Body) -> World:
    line_map = file.line_map()
    dynamics = MujocoDynamics(file.physics_step)
    return World(line_map, bodies, dynamics=dynamics, relief=file.relief(line_map))


def run(world: World, seconds: float) -> None:
    for _ in range(round(seconds / TICK)):
        world.step(TICK)


def dynamics_of(world: World) -> MujocoDynamics:
    dynamics = world.dynamics
    assert isinstance(dynamics, MujocoDynamics)
    return dynamics


def height(world: World, number: int = 0) -> float:
    scene = dynamics_of(world).scene
    return float(scene.data.qpos[scene.base[number] + 2])


def box_height(world: World, number: int = 0) -> float:
    scene = dynamics_of(world).scene
    return float(scene.data.qpos[scene.boxes[number] + 2])


def geoms(world: World) -> dict[str, tuple[float, float]]:
    """Return the lowest and highest place of each geom that is upright [m]."""
    scene = dynamics_of(world).scene
    found = {}
    for number in range(scene.model.ngeom):
        z, half = scene.data.geom_xpos[number][2], scene.model.geom_size[number][2]
        found[scene.model.geom(number).name] = (float(z - half), float(z + half))
    return found


@pytest.mark.parametrize(("model", "sink"), [("p3at-sh", SINK), ("p3dx-sh", 0.0)])
def test_a_robot_drives_up_a_ramp_onto_the_platform(model: str, sink: float) -> None:
    body = powered(model)
    world = physical(body, solids=(RAMP, PLATFORM))
    body.drive.linear.travel(1.0 + LENGTH + 1.0)
    run(world, 18.0)
    assert height(world) == pytest.approx(HEIGHT - sink, abs=1e-3)
    assert body.robot_in_world.x > 1.0 + LENGTH
    assert abs(body.robot_in_world.y) < 0.01
    assert not body.stalled


@pytest.mark.parametrize(
    ("model", "sill", "speed"),
    [("p3dx-sh", 0.01, 0.15), ("p3dx-sh", 0.015, 0.15), ("p3at-sh", 0.02, 0.15)],
)
def test_a_robot_drives_over_a_door_sill(model: str, sill: float, speed: float) -> None:
    body = powered(model)
    world = physical(body, solids=(Step(pose=Pose2(0.8, 0.0), size=(0.04, 1.5), height=sill),))
    body.drive.linear.go(speed)
    run(world, 1.6 / speed)
    assert body.robot_in_world.x > 1.4
    assert abs(body.robot_in_world.theta) < 0.01


def test_a_step_of_10_cm_stops_a_robot() -> None:
    body = powered()
    world = physical(body, solids=(Step(pose=Pose2(1.5, 0.0), size=(1.0, 1.5), height=0.1),))
    body.drive.linear.go(0.2)
    run(world, 8.0)
    assert body.robot_in_world.x < 1.0
    assert body.stalled


def test_robots_and_boxes_that_are_put_somewhere_stand_on_the_ground_there() -> None:
    body = powered("p3at-sh", Pose2(1.0 + LENGTH / 2, 0.0, 0.7))
    world = physical(body, solids=(RAMP, PLATFORM))
    box = world.add_obstacle(Box(pose=Pose2(1.0 + LENGTH / 2, 0.5), size=(0.2, 0.2), movable=True))
    run(world, 0.5)
    pose = body.robot_in_world
    assert (pose.x, pose.theta) == pytest.approx((1.0 + LENGTH / 2, 0.7), abs=0.005)
    assert height(world) == pytest.approx(HEIGHT / 2 - SINK, abs=2e-3)
    assert box_height(world) == pytest.approx(HEIGHT / 2 + 0.25, abs=0.01)
    for place, z in ((Pose2(PLATFORM.pose.x, 0.0, 1.0), HEIGHT), (Pose2(-3.0, 0.0, 1.0), 0.0)):
        body.robot_in_world = place
        world.move_obstacle(box, Pose2(place.x, 0.6))
        run(world, 0.5)
        assert height(world) == pytest.approx(z - SINK, abs=1e-3)
        assert box_height(world) == pytest.approx(z + 0.25, abs=1e-3)
        pose = body.robot_in_world
        assert (pose.x, pose.y, pose.theta) == pytest.approx((place.x, 0.0, 1.0), abs=1e-3)


def test_a_robot_is_put_upon_a_bridge_and_drives_below_it() -> None:
    bridge = Step(pose=Pose2(2.0, 0.0), size=(1.5, 2.0), height=0.05, z=1.0)
    upon, below = powered(pose=bridge.pose), powered()
    world = physical(upon, below, solids=(bridge,))
    below.drive.linear.travel(2.0)
    run(world, 6.0)
    assert height(world, 0) == pytest.approx(1.05, abs=1e-3)
    assert height(world, 1) == pytest.approx(0.0, abs=1e-3)
    assert below.robot_in_world.x > 1.8


def test_a_robot_keeps_its_heading_on_any_slope() -> None:
    slope = Ramp(pose=Pose2(0.0, 0.0, 0.4), size=(4.0, 4.0), height=0.7)
    for theta in np.linspace(-3.0, 3.0, 7).tolist():
        world = physical(powered("p3at-sh", Pose2(0.3, -0.2, theta)), solids=(slope,))
        assert dynamics_of(world)._poses()[2, 0] == pytest.approx(theta, abs=1e-9)


def test_another_map_takes_its_own_ground() -> None:
    body = powered("p3at-sh", PLATFORM.pose)
    world = physical(body, solids=(RAMP, PLATFORM))
    file = WorldFile(name="w", solids=(Step(pose=PLATFORM.pose, size=(1.0, 1.0), height=0.05),))
    line_map = file.line_map()
    world.change_map(line_map, file.relief(line_map))
    assert height(world) == pytest.approx(0.05)
    world.change_map(line_map)
    assert world.relief is FLAT
    assert height(world) == 0.0
    run(world, 0.3)
    assert height(world) == pytest.approx(-SINK, abs=1e-3)


def test_walls_and_boxes_have_their_heights_and_solids_are_not_extruded() -> None:
    file = WorldFile(
        name="w",
        wall_height=2.0,
        walls=(
            Wall(points=((5.0, 0.0), (5.0, 2.0))),
            Wall(points=((6.0, 0.0), (6.0, 2.0)), height=0.4),
        ),
        boxes=(
            Box(pose=Pose2(3.0, 3.0), size=(1.0, 1.0), height=0.6),
            Box(pose=Pose2(3.0, 6.0), size=(1.0, 1.0), z=0.1, height=0.2),
            Box(pose=Pose2(8.0, 6.0), size=(1.0, 1.0)),
        ),
        solids=(
            Cylinder(pose=Pose2(0.0, 5.0), radius=0.2, height=0.9),
            Table(pose=Pose2(0.0, 8.0), size=(1.0, 0.8), height=0.75, thickness=0.05, back=0.3),
        ),
    )
    found = geoms(of_file(file))
    assert [found[f"wall_{n}"][1] for n in range(6)] == pytest.approx([2.0, 0.4, *[0.6] * 4])
    assert "wall_6" not in found  # a side of the box that stands on something
    assert found["wall_10"] == pytest.approx((0.0, 2.0))
    assert not any(f"wall_{n}" in found for n in range(14, 14 + 16 + 16))
    assert found["box_0"] == pytest.approx((0.0, 0.6))
    assert found["box_1"] == pytest.approx((0.1, 0.3))
    assert found["box_2"] == pytest.approx((0.0, 2.0))
    assert found["table_0_top"] == pytest.approx((0.7, 0.75))
    assert found["table_0_leg_3"] == pytest.approx((0.0, 0.7))
    assert found["table_0_back"] == pytest.approx((0.75, 1.05))
    assert "cylinder_0" in found


def test_a_large_map_has_all_its_walls() -> None:
    walls = tuple(Wall(points=((float(n), 0.0), (float(n), 1.0))) for n in range(4500))
    world = of_file(WorldFile(name="w", walls=walls, wall_height=0.7), powered())
    scene = dynamics_of(world).scene
    for number in (0, 1999, 2000, 4499):
        at = scene.data.geom(f"wall_{number}").xpos
        assert at.tolist() == pytest.approx([number, 0.5, 0.35])


def test_a_robot_drives_below_a_table_between_its_legs_and_stops_at_a_column() -> None:
    body = powered()
    world = physical(
        body,
        solids=(
            Table(pose=Pose2(2.0, 0.0), size=(1.4, 1.0), height=0.75),
            Cylinder(pose=Pose2(4.0, 0.0), radius=0.2, height=0.5),
        ),
    )
    body.drive.linear.go(0.4)
    run(world, 12.0)
    assert 3.4 < body.robot_in_world.x < 3.8
    assert body.stalled


def test_the_column_of_a_peoplebot_meets_the_top_of_a_table() -> None:
    body = powered("peoplebot-sh")
    world = physical(body, solids=(Table(pose=Pose2(2.0, 0.0), size=(1.4, 1.0), height=0.75),))
    body.drive.linear.go(0.2)
    run(world, 12.0)
    assert body.robot_in_world.x < 1.3  # its wheels may slip, as the top presses so high


@pytest.mark.parametrize("friction", [0.2, 0.8])
def test_a_box_slides_as_far_as_the_friction_of_the_carpet_lets_it(friction: float) -> None:
    carpet = Carpet(pose=ORIGIN, size=(8.0, 3.0), friction=friction)
    world = physical(solids=(carpet,))
    box = world.add_obstacle(Box(pose=ORIGIN, size=(0.4, 0.4), movable=True))
    run(world, 0.4)
    dynamics = dynamics_of(world)
    speeds = dynamics.scene.joints[dynamics._names[box]][1]
    dynamics.scene.data.qvel[speeds[0]] = 1.0
    run(world, 2.0)
    assert box.pose.x == pytest.approx(1.0 / (2 * 9.81 * friction), rel=0.05)


@pytest.mark.parametrize(("model", "sink"), [("p3at-sh", SINK), ("p3dx-sh", 0.0)])
def test_tires_keep_their_softness_on_a_carpet_and_never_reach_the_floor(
    model: str, sink: float
) -> None:
    body = powered(model)
    world = physical(body, solids=(Carpet(pose=ORIGIN, size=(3.0, 3.0), friction=0.7),))
    scene = dynamics_of(world).scene
    assert height(world) == pytest.approx(0.008)
    body.drive.angular.go(1.0)
    run(world, 1.0)
    upward, number, floor = [], [], 0
    for _ in range(50):
        world.step(TICK)
        pairs = scene.data.contact.geom
        upward.append(scene.data.qacc[2])
        number.append(len(pairs))
        floor += int((pairs == 0).any())
        assert scene.data.contact.friction[:, 0].tolist() == pytest.approx([0.7] * len(pairs))
    assert height(world) == pytest.approx(0.008 - sink, abs=2e-3)
    assert np.std(upward) < 0.05
    assert {*number} == {4 if model == "p3at-sh" else 3}
    assert floor == 0


def test_tires_spin_on_a_slippery_carpet() -> None:
    ways = []
    for friction in (0.03, 0.8):
        body = powered()
        carpet = Carpet(pose=ORIGIN, size=(6.0, 3.0), friction=friction)
        world = physical(body, solids=(carpet,))
        body.drive.linear.acceleration = 2.0
        body.drive.linear.go(0.6)
        run(world, 1.0)
        ways.append(body.robot_in_world.x)
    assert ways[0] < 0.6 * ways[1]


def test_a_driver_touches_nothing_on_carpets_and_ramps() -> None:
    body = powered("p3dx-sh")
    world = physical(body, solids=(Carpet(pose=ORIGIN, size=(3.0, 3.0)), RAMP))
    body.drive.linear.go(0.3)
    for _ in range(250):
        world.step(TICK)
        assert not world.drives.flags[TOUCHED].any()


def test_a_height_field_has_the_heights_of_its_picture(tmp_path: Path) -> None:
    write_hill(tmp_path / "hill.png")
    pose = Pose2(1.0, -2.0, 0.3)
    hill = HeightField(file=tmp_path / "hill.png", pose=pose, size=(6.0, 4.0), height=0.4, z=0.05)
    body = powered("p3dx-sh", pose)
    world = physical(body, solids=(hill,))
    ground = dynamics_of(world)._ground
    assert ground is not None
    for own in ((0.0, 0.0), (2.0, 1.5), (-2.5, -1.0)):
        at = pose @ Pose2(*own)
        shade = 55 + 150 * (own[0] + 3.0) / 6.0
        assert ground.height(at.x, at.y) == pytest.approx(0.05 + 0.4 * shade / 255, abs=2e-3)
    run(world, 1.0)
    assert height(world) == pytest.approx(0.05 + 0.4 * 130 / 255, abs=5e-3)
    assert ground.height(pose.x + 9.0, pose.y) == 0.0


def test_the_top_of_a_picture_is_the_far_side(tmp_path: Path) -> None:
    shades = np.zeros((20, 30, 3), dtype=np.uint8)
    shades[:10] = 255
    (tmp_path / "h.png").write_bytes(to_png(shades))
    hill = HeightField(file=tmp_path / "h.png", pose=ORIGIN, size=(3.0, 2.0), height=0.3)
    world = physical(powered(), solids=(hill,))
    ground = dynamics_of(world)._ground
    assert ground is not None
    assert ground.height(0.0, 0.6) == pytest.approx(0.3, abs=1e-6)
    assert ground.height(0.0, -0.6) == pytest.approx(0.0, abs=1e-6)


def test_a_robot_stops_at_a_mesh(tmp_path: Path) -> None:
    write_block(tmp_path / "rock.stl", (1000.0, 500.0, 600.0))
    rock = Mesh(file=tmp_path / "rock.stl", pose=Pose2(1.5, 0.0), scale=0.001)
    body = powered("p3at-sh")
    world = physical(body, solids=(rock,))
    body.drive.linear.go(0.3)
    run(world, 6.0)
    assert 0.6 < body.robot_in_world.x < 0.8
    assert body.stalled


def test_a_world_keeps_its_solids_when_their_files_are_gone(tmp_path: Path) -> None:
    write_hill(tmp_path / "hill.png")
    write_block(tmp_path / "rock.stl", (1000.0, 500.0, 600.0))
    world = physical(
        powered(),
        solids=(
            HeightField(file=tmp_path / "hill.png", pose=Pose2(5.0, 5.0), size=(3, 3), height=0.1),
            Mesh(file=tmp_path / "rock.stl", pose=Pose2(-5.0, 0.0), scale=0.001),
        ),
    )
    before = geoms(world)
    write_block(tmp_path / "rock.stl", (1000.0, 500.0, 900.0))
    (tmp_path / "hill.png").unlink()
    world.add(powered(pose=Pose2(-3.0, 0.0)))
    world.add_obstacle(Box(pose=Pose2(2.0, 2.0), size=(0.5, 0.5), movable=True))
    run(world, 0.1)
    after = geoms(world)
    for name in ("heightfield_0", "mesh_0"):
        assert after[name] == before[name]
    assert len(dynamics_of(world).scene.base) == 2


def test_meshes_of_one_file_share_a_hull_that_is_computed_once(tmp_path: Path) -> None:
    write_block(tmp_path / "rock.stl", (1000.0, 500.0, 600.0))
    rocks = tuple(
        Mesh(file=tmp_path / "rock.stl", pose=Pose2(x, 3.0), scale=scale)
        for x, scale in ((1.0, 0.001), (3.0, 0.001), (6.0, 0.002))
    )
    elements._hull_volume.cache_clear()
    world = physical(powered(), solids=rocks)
    world.add_obstacle(Box(pose=Pose2(2.0, 0.0), size=(0.5, 0.5), movable=True))
    world.step(TICK)
    assert elements._hull_volume.cache_info().misses == 2
    model, data = dynamics_of(world).scene.model, dynamics_of(world).scene.data
    first, second, large = (model.geom(f"mesh_{number}") for number in range(3))
    assert first.dataid == second.dataid != large.dataid
    for geom, x, z in ((first, 1.0, 0.3), (second, 3.0, 0.3), (large, 6.0, 0.6)):
        assert data.geom_xpos[geom.id].tolist() == pytest.approx([x, 3.0, z])


def test_a_mesh_that_its_hull_is_much_larger_than_is_refused(tmp_path: Path) -> None:
    write_u(tmp_path / "u.stl")
    solids = (Mesh(file=tmp_path / "u.stl", pose=ORIGIN),)
    with pytest.raises(ConfigError, match=r"w\.toml: mesh 0: its convex hull.* 3\.6 times.*cut it"):
        of_file(WorldFile(name="w", solids=solids, source="w.toml"), powered())


@pytest.mark.parametrize(
    ("solid", "name"),
    [
        (Cylinder(pose=ORIGIN, radius=0.0, height=1.0), "cylinder 0"),
        (Step(pose=ORIGIN, size=(1.0, 1.0), height=-1.0), "step 0"),
        (Table(pose=ORIGIN, size=(1.0, 1.0), height=0.02), "table 0"),
    ],
)
def test_what_mujoco_refuses_is_named(solid: Solid, name: str) -> None:
    with pytest.raises(ConfigError, match=rf"^w\.toml: {name}: MuJoCo refuses it: size"):
        of_file(WorldFile(name="w", solids=(solid,), source="w.toml"), powered())


def test_a_map_that_physics_refuse_changes_nothing() -> None:
    body = powered("p3dx-sh")
    world = physical(body, solids=(PLATFORM,))
    before, relief = world.map, world.relief
    bad = WorldFile(name="w", solids=(Cylinder(pose=ORIGIN, radius=0.0, height=1.0),))
    line_map = bad.line_map()
    with pytest.raises(ConfigError, match="cylinder 0"):
        world.change_map(line_map, bad.relief(line_map))
    assert (world.map, world.relief) == (before, relief)
    body.drive.linear.go(0.3)
    run(world, 2.0)
    assert body.robot_in_world.x > 0.3


def test_a_box_has_its_mass_height_and_place() -> None:
    boxes = (Box(pose=ORIGIN, size=(0.3, 0.3), movable=True, mass=2.0, height=0.2, z=0.75),)
    world = physical(solids=(Table(pose=ORIGIN, size=(1.0, 1.0), height=0.75),))
    world.add_obstacle(boxes[0])
    run(world, 0.5)
    scene = dynamics_of(world).scene
    assert scene.model.body_mass.sum() == pytest.approx(2.0)
    assert box_height(world) == pytest.approx(0.85, abs=1e-3)


@pytest.mark.parametrize("step", [0.0005, 0.0025])
def test_the_step_of_physics_can_be_chosen(step: float, capfd: pytest.CaptureFixture[str]) -> None:
    body = powered("p3dx-sh")
    world = of_file(WorldFile(name="w", physics_step=step), body)
    assert dynamics_of(world).scene.model.opt.timestep == step
    body.drive.linear.travel(0.5)
    run(world, 4.0)
    assert hypot(body.robot_in_world.x - 0.5, body.robot_in_world.y) < 0.01
    assert capfd.readouterr() == ("", "")


def test_a_robot_drives_across_a_slope() -> None:
    slope = Ramp(pose=ORIGIN, size=(6.0, 6.0), height=6.0 * tan(radians(8)))
    body = powered("p3at-sh", Pose2(0.0, 0.0, pi / 2))
    world = physical(body, solids=(slope,))
    body.drive.linear.go(0.2)
    run(world, 5.0)
    assert body.robot_in_world.y > 0.7
