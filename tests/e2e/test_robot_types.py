"""A robot of every type drives and measures in its own units, by its word and by its file."""

import asyncio
from math import cos, hypot, pi
from pathlib import Path

import pytest

from pioneer3 import connect_async
from pioneer3.models import model_names
from pioneer3.models.aria import aria_text
from tests.support import DISTINCT, SimulatedRobot, wall_at

WALL = 3.0
"""Distance of a wall in front of the robot, before it drives [m]."""


async def drive(robot: SimulatedRobot, model: str | None) -> None:
    async with robot, connect_async(robot.open, model=model) as driver:
        assert driver.info.model.refusal is None
        await asyncio.sleep(1.5)
        assert driver.snapshot is not None
        mounts = enumerate(robot.body.model.sonars)
        ahead = {number: mount for number, mount in mounts if abs(mount.theta) < 0.2 and mount.x}
        ranges = [driver.snapshot.sonar.ranges[number] for number in ahead]
        true = [(WALL - mount.x) / cos(mount.theta) for mount in ahead.values()]
        assert ranges == pytest.approx(true, abs=0.02)
        began = robot.body.robot_in_world
        await driver.move(1.0)
        now = robot.body.robot_in_world
        assert hypot(now.x - began.x, now.y - began.y) == pytest.approx(1.0, abs=0.01)
        await driver.turn(pi / 2)
        assert robot.body.robot_in_world.theta == pytest.approx(pi / 2, abs=0.03)
        assert driver.snapshot.odometry.robot_in_odom.theta == pytest.approx(pi / 2, abs=0.03)


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=() if name in DISTINCT else pytest.mark.thorough)
        for name in model_names()
    ],
)
async def test_a_metre_is_a_metre_and_sonar_hears_the_wall_where_it_is(name: str) -> None:
    await drive(SimulatedRobot(wall_at(WALL), model=name), None)


@pytest.mark.parametrize("name", ["p2at", "pion1m", "amigo"])
async def test_a_parameter_file_of_the_type_serves_as_well(name: str, tmp_path: Path) -> None:
    path = tmp_path / "it.p"
    path.write_text(aria_text(SimulatedRobot(model=name).body.model).replace(name, "nobody-knows"))
    await drive(SimulatedRobot(wall_at(WALL), model=str(path)), str(path))


@pytest.mark.parametrize("name", ["seekur", "seekurjr"])
async def test_a_mode_wakes_the_simulated_laser_of_a_type_without_sonars(name: str) -> None:
    async with (
        SimulatedRobot(wall_at(WALL), model=name) as robot,
        connect_async(robot.open) as driver,
    ):
        await driver.goto(0.8, 0.3)
        there = robot.body.robot_in_world
        assert hypot(there.x - 0.8, there.y - 0.3) < 0.2
