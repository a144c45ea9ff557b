"""A drive that was recorded is played back once, with its losses, and then it is over."""

import asyncio
import sys
from pathlib import Path
from threading import Event

import pytest

from pioneer3.arcos import commands
from pioneer3.cli import live, monitor
from pioneer3.cli.options import LinkOptions
from pioneer3.errors import MotionError
from pioneer3.log.writer import LogWriter
from pioneer3.navigation.connect import connect_async
from pioneer3.robot.supervisor import Connection
from pioneer3.runtime.recording import RobotLog
from pioneer3.state import Snapshot
from tests.e2e.test_waits import Terminal
from tests.support import SimulatedRobot, until


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


class HangingDisk:
    """A disk that takes nothing, as long as it `hangs`."""

    path = Path("/nowhere/drive.mcap")
    most: int | None = None
    patience = 0.05

    def __init__(self) -> None:
        self.hangs = Event()

    def open(self) -> int:
        self.hangs.wait()
        raise OSError(5, "Input/output error")

    def tidy(self) -> None:
        """Do nothing."""


async def test_a_disk_that_hangs_delays_no_stop() -> None:
    disk, clock = HangingDisk(), asyncio.get_running_loop().time
    log = LogWriter(disk, clock)
    try:
        async with SimulatedRobot() as robot:
            async with connect_async(robot.open, record=RobotLog(log)) as driver:
                while robot.speed < 0.2:
                    driver.drive(0.3)
                    await asyncio.sleep(0.1)
                asked = clock()
                driver.stop()
                await until(lambda: robot.speed == pytest.approx(0, abs=0.01), within=2.0)
                assert clock() - asked < 0.6
                driver.drive(0.3)
                await asyncio.sleep(0.3)
                assert robot.speed > 0.05
            await until(lambda: robot.speed == pytest.approx(0, abs=0.01), within=2.0)
            assert commands.Close() in robot.wires[-1].commands
        log.close("done")
        assert log._thread.is_alive()  # it hung all the time
    finally:
        disk.hangs.set()
        log.close("done", 20.0)
