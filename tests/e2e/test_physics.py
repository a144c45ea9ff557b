"""The driver and the firmware of a robot that moves by physics cannot tell the difference."""

import asyncio
from dataclasses import replace

import pytest

from pioneer3.errors import CommandError, MotionError
from pioneer3.geometry import Pose2
from pioneer3.navigation.connect import connect_async
from pioneer3.sim.server.start import simulator
from pioneer3.sim.worldfile import Box, RobotSpec
from pioneer3.sim.worldfile.arguments import WorldOverrides
from tests.support import SimulatedRobot, until, wall_at

pytest.importorskip("mujoco")


@pytest.mark.parametrize("model", ["p3at-sh", "p3dx-sh"])
async def test_a_program_moves_and_turns_it(model: str) -> None:
    async with (
        SimulatedRobot(model=model, physics="mujoco") as robot,
        connect_async(robot.open) as driver,
    ):
        await driver.move(0.5)
        await driver.turn(1.0)
        pose, snapshot = robot.body.robot_in_world, driver.snapshot
        assert pose.x == pytest.approx(0.5, abs=0.05)
        assert snapshot is not None
        assert snapshot.odometry.robot_in_odom.x == pytest.approx(0.5, abs=0.05)
        assert pose.theta == pytest.approx(1.0, abs=0.1)


async def test_a_wall_ends_a_motion_by_a_stall() -> None:
    async with (
        SimulatedRobot(wall_at(1.0), physics="mujoco") as robot,
        connect_async(robot.open) as driver,
    ):
        with pytest.raises(MotionError, match="stall"):
            await driver.move(5.0)
        await asyncio.sleep(2.0)
        assert robot.body.speeds == pytest.approx((0.0, 0.0), abs=0.01)


async def test_a_lost_host_leaves_it_standing() -> None:
    async with (
        SimulatedRobot(physics="mujoco") as robot,
        connect_async(robot.open) as driver,
    ):
        driver.drive(0.4)
        await asyncio.sleep(0.4)
        assert robot.body.speeds[0] > 0.05
        robot.silent = True
        await asyncio.sleep(5.0)
        assert robot.body.speeds == pytest.approx((0.0, 0.0), abs=0.01)


@pytest.mark.realtime
async def test_a_world_with_heights_runs_with_physics_and_needs_no_words() -> None:
    overrides = WorldOverrides(physics=True)
    async with simulator(map_name="ramps", port=0, overrides=overrides) as world:
        assert world.notes == []


@pytest.mark.realtime
async def test_many_robots_drive_come_and_go_while_another_thread_steps() -> None:
    robots = tuple(RobotSpec(model="p3dx-sh", start=Pose2(0.0, 2.0 * n)) for n in range(5))
    overrides = WorldOverrides(physics=True, robots=robots)
    async with simulator(map_name="empty", port=0, overrides=overrides) as here:
        for robot in here.robots:
            robot.body.enable_motors(on=True)
            robot.body.drive.linear.go(0.4)
        await until(lambda: here.world.time > 1.0)
        added = await here.add_robot(RobotSpec(model="p3at-sh", start=Pose2(-3.0, 0.0)))
        here.robots[0].body.robot_in_world = Pose2(0.0, -4.0)
        await here.remove_robot(here.robots[4])
        began = here.world.time
        await until(lambda: here.world.time > began + 1.0)
        poses = [robot.body.robot_in_world for robot in here.robots]
        assert added.body.robot_in_world.x == pytest.approx(-3.0, abs=0.01)
        assert poses[0].y == pytest.approx(-4.0, abs=0.01)
        assert all(pose.x > 0.2 for pose in poses[:4])


@pytest.mark.realtime
async def test_a_box_cannot_be_put_into_another_one() -> None:
    async with simulator(map_name="empty", port=0, overrides=WorldOverrides(physics=True)) as here:
        box = Box(pose=Pose2(2.0, 0.0), size=(0.5, 0.5))
        here.add_box(box)
        for pose in (box.pose, Pose2(2.3, 0.3, 0.7)):
            with pytest.raises(CommandError, match="a box stands"):
                here.add_box(replace(box, pose=pose))
        here.add_box(replace(box, pose=Pose2(2.0, 0.6)))
