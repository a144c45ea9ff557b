"""A drive that was recorded is played back once, with its losses, and then it is over."""

import asyncio
import sys
from pathlib import Path

import pytest

from pioneer3.cli import live, monitor
from pioneer3.cli.options import LinkOptions
from pioneer3.errors import MotionError
from pioneer3.navigation.connect import connect_async
from pioneer3.robot.supervisor import Connection
from pioneer3.state import Snapshot
from tests.e2e.test_waits import Terminal
from tests.support import SimulatedRobot


async def record(path: Path, *, away: float = 0.0) -> list[Snapshot]:
    """Record a drive, if so with a robot that is away for a while; return its readings."""
    async with SimulatedRobot() as robot:
        async with connect_async(robot.open, record=path) as driver:
            seen: list[Snapshot] = []

            async def look() -> None:
                seen.extend([each async for each in driver.snapshots(patience=60)])

            looking = asyncio.ensure_future(look())
            await driver.move(0.5)
            if away:
                await robot.unplug()
                await asyncio.sleep(away)
                robot.plugged = True
                await asyncio.sleep(4)
                await driver.move(0.5)
        await looking
    return seen


@pytest.mark.parametrize("away", [0.0, 5.0, 20.0])
async def test_a_recording_ends_and_the_robot_of_it_was_where_it_was(
    tmp_path: Path, away: float
) -> None:
    path = tmp_path / "drive.txt"
    recorded = await record(path, away=away)
    async with connect_async(f"replay:{path}") as driver:
        last = None
        async for snapshot in driver.snapshots(patience=60):
            last = snapshot
        assert last is not None
        ended = recorded[-1].odometry.robot_in_odom
        assert last.odometry.robot_in_odom.x == pytest.approx(ended.x, abs=0.02)
        assert last.link.sessions == (2 if away else 1)
        await asyncio.sleep(60)
        status = driver.supervisor.status.latest
        assert status is not None
        assert status.connection is Connection.CLOSED
        assert status.message.endswith("drive.txt: the recording is over")
        assert driver.snapshot is None
        with pytest.raises(MotionError, match="the recording is over"):
            driver.drive(0.1)


async def test_monitor_shows_a_recording_to_its_end_and_is_content(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "drive.txt"
    readings = await record(path)
    out = Terminal(isatty=False)
    monkeypatch.setattr(sys, "stdout", out)
    assert await monitor._monitor(LinkOptions(port=f"replay:{path}"), 1000.0, json=False) == 0
    assert abs(len(out.texts) - len(readings)) <= 2
    assert not any("LOST" in text for _, text in out.texts)


async def test_a_motion_over_a_recording_ends_with_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "drive.txt"
    await record(path)
    monkeypatch.setattr(sys, "stdout", Terminal(isatty=False))
    async with connect_async(f"replay:{path}") as driver:
        with pytest.raises(MotionError):
            await live.show_while(driver, driver.goto(50, 0))
