"""`pioneer3 log why` tells what the robot told at the time, whatever stopped it."""

import asyncio
from pathlib import Path

import pytest

import pioneer3
from pioneer3.analysis.why import told_at
from pioneer3.behaviors.modes import wander
from pioneer3.errors import MotionError
from pioneer3.navigation.connect import connect_async
from pioneer3.robot.explain import Reason, ReasonKind
from pioneer3.runtime.arbiter import SENT_AFTER
from tests.support import SimulatedRobot, wall_at


async def test_the_reasons_of_a_log_are_those_that_people_were_told(tmp_path: Path) -> None:
    told: list[tuple[float, Reason | None]] = []
    path, clock = tmp_path / "a.mcap", asyncio.get_running_loop().time
    async with (
        SimulatedRobot(wall_at(1.0)) as sim,
        connect_async(sim.open, record=path) as robot,
    ):

        async def during(seconds: float) -> None:
            told.extend([(clock(), robot.why_not_moving()) async for _ in robot.snapshots(seconds)])

        async def until_refused() -> None:
            async for _ in robot.snapshots(4.0):
                robot.drive(0.7, 0.0)

        await during(1.0)
        robot.drive(0.3, 0.0)
        await during(1.5)
        robot.emergency_stop()
        await during(1.0)
        robot.reset_emergency_stop()
        robot.drive(0.7, 0.0)
        with pytest.raises(MotionError, match="the wheels stalled"):
            await until_refused()
        await during(1.0)
        async with asyncio.TaskGroup() as group:
            group.create_task(robot.run(wander(), seconds=3.0))
            await during(2.5)
    log = pioneer3.log.open(path)
    found = [told_at(log, log.time_at(time) + 2 * SENT_AFTER) for time, _ in told]
    assert all(each.was_told for each in found)
    assert [each.stands for each in found] == [reason for _, reason in told]
    kinds = {reason.kind for _, reason in told if reason}
    assert {ReasonKind.IDLE, ReasonKind.FAULT} <= kinds
    last = found[-1]
    assert last.decision is not None
    assert last.decision[1].mode == "wander"
    assert last.mode_since is not None
    assert last.mode_since > found[0].time
