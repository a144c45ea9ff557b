"""The worlds that ship with heights: their places can be reached on a plane, and with physics."""

from dataclasses import replace
from math import pi

import pytest

from pioneer3.geometry import Pose2
from pioneer3.models import load_model
from pioneer3.sim.body import Body
from pioneer3.sim.kernels import Kernels
from pioneer3.sim.map_check import check_world
from pioneer3.sim.relief import Step, Table
from pioneer3.sim.world import World
from pioneer3.sim.worldfile import load_world


def goal(name: str, world: str) -> Pose2:
    return next(place.pose for place in load_world(world).places if place.name == name)


def physical(body: Body, name: str) -> World:
    pytest.importorskip("mujoco")
    from pioneer3.sim.physics.dynamics import MujocoDynamics

    file = load_world(name)
    line_map = file.line_map()
    body.enable_motors(on=True)
    return World(line_map, [body], dynamics=MujocoDynamics(), relief=file.relief(line_map))


def run(world: World, seconds: float) -> None:
    for _ in range(round(seconds / 0.02)):
        world.step(0.02)


@pytest.mark.parametrize("name", ["ramps", "dining"])
@pytest.mark.parametrize("model", ["p3dx-sh", "p3at-sh"])
def test_all_places_can_be_reached(name: str, model: str) -> None:
    assert check_world(name, load_model(model)) == ()


def test_a_robot_drives_up_to_the_platform_and_backs_down() -> None:
    body = Body(load_model("p3at-sh"), goal("foot of the ramp", "ramps"))
    world = physical(body, "ramps")
    top = goal("platform", "ramps")
    body.drive.linear.travel(top.x - body.robot_in_world.x)
    run(world, 16.0)
    assert body.robot_in_world.x > top.x - 0.4
    body.drive.linear.travel(-3.2)
    run(world, 16.0)
    assert body.robot_in_world.x < 9.9
    assert not body.stalled


@pytest.mark.parametrize(
    ("model", "sill"),
    [
        *(("p3at-sh", sill) for sill in ("low", "middle", "high")),
        *(("p3dx-sh", sill) for sill in ("low", "middle")),
    ],
)
def test_a_robot_drives_over_the_sills_of_the_rooms(model: str, sill: str) -> None:
    to = goal(f"{sill} sill", "ramps")
    body = Body(load_model(model), Pose2(to.x, to.y - 2.4, pi / 2))
    world = physical(body, "ramps")
    body.drive.linear.go(0.2)
    run(world, 12.0)
    assert body.robot_in_world.y > to.y - 0.5
    assert body.robot_in_world.x == pytest.approx(to.x, abs=0.05)


def test_the_sills_are_as_high_as_the_file_says() -> None:
    steps = [solid for solid in load_world("ramps").solids if isinstance(solid, Step)]
    assert [step.height for step in steps] == [0.01, 0.015, 0.02, 0.25]


def test_sonars_look_below_the_tables_between_their_legs() -> None:
    table = next(s for s in load_world("dining").solids if isinstance(s, Table) and s.size[0] > 2)
    at = table.pose @ Pose2(2.2, 0.0, pi)
    body = Body(load_model("p3dx-sh"), at)
    world = World(load_world("dining").line_map(), [body], Kernels())
    ahead = world.sonar(body)[3:5]
    assert (ahead > table.size[0] / 2 + 0.5).all()


def test_a_robot_drives_below_the_long_table_and_not_below_the_low_one() -> None:
    tables = [solid for solid in load_world("dining").solids if isinstance(solid, Table)]
    long = next(table for table in tables if table.size[0] > 2)
    low = next(table for table in tables if table.height < 0.4)
    model = replace(load_model("p3dx-sh"), laser=None)
    body = Body(model, long.pose @ Pose2(2.0, 0.0, pi))
    world = physical(body, "dining")
    body.drive.linear.go(0.3)
    run(world, 8.0)
    assert body.robot_in_world.x < long.pose.x + 0.3
    high = Body(load_model("p3at-sh"), low.pose @ Pose2(0.0, -1.3, pi / 2))
    world = physical(high, "dining")
    high.drive.linear.go(0.2)
    run(world, 8.0)
    own = low.pose.inverse() @ high.robot_in_world
    assert own.y < -low.size[1] / 2
    assert high.stalled
