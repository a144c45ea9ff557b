"""The true pose of a simulated robot, asked for now and then."""

import asyncio
from pathlib import Path

import pytest

from pioneer3 import connect_async
from pioneer3.arcos.reports import Report, SimStat
from pioneer3.geometry import Pose2
from pioneer3.log.reader import open_log
from pioneer3.log.topics import LogTopic
from pioneer3.navigation.simulator import TruePose
from pioneer3.runtime.recording import TruePoseTold
from pioneer3.sim.worldfile import load_map
from pioneer3.tasks import running
from tests.support import SimulatedRobot

TRUTH = LogTopic("truth", TruePoseTold)
HOME = Pose2(3.0, 3.1, 0.5)


async def test_odometry_begins_where_the_robot_began_while_it_drives_and_after_it_was_moved() -> (
    None
):
    heard: list[Report] = []
    async with (
        SimulatedRobot(load_map("office"), home=HOME) as sim,
        connect_async(sim.open) as robot,
    ):
        robot.supervisor.reports.hand_to(lambda report, _: heard.append(report), SimStat)
        true = TruePose(robot, 0.5)
        async with running(true.follow()):
            for _ in range(30):
                robot.drive(0.1, 0.2)
                await asyncio.sleep(0.1)
            found = true.odom_in_world
            assert found is not None
            assert (found.x, found.y) == pytest.approx((HOME.x, HOME.y), abs=0.03)
            assert found.theta == pytest.approx(HOME.theta, abs=0.05)
            assert len(heard) <= 8  # not with every report
            robot.stop()
            await asyncio.sleep(1.0)
            sim.body.robot_in_world = Pose2(10.0, 7.0, 0.0)
            await asyncio.sleep(1.0)
            now, snapshot = true.odom_in_world, robot.snapshot
            assert now is not None
            assert snapshot is not None
            assert (now @ snapshot.odometry.robot_in_odom).x == pytest.approx(10.0, abs=0.02)


async def test_a_log_tells_where_the_robot_of_another_programs_simulator_truly_is(
    tmp_path: Path,
) -> None:
    path = tmp_path / "drive.mcap"
    async with SimulatedRobot(load_map("office"), home=HOME) as sim:
        async with connect_async(sim.open, record=path) as robot:
            for _ in range(20):
                robot.drive(0.2, 0.2)
                await asyncio.sleep(0.1)
            robot.stop()
            await asyncio.sleep(1.0)
        told = [pose.robot_in_world for _, pose in open_log(path).of(TRUTH)]
        assert len(told) > 15
        last, there = told[-1], sim.body.robot_in_world
        assert (last.x, last.y) == pytest.approx((there.x, there.y), abs=0.01)
        assert last.theta == pytest.approx(there.theta, abs=0.02)
        assert last.x > HOME.x + 0.2
