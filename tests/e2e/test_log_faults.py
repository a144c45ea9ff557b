"""Whatever happens to a log, the robot drives on and stops as it must, and what was written stays.

Disks that are full or read-only are mounted for it, which needs root.
"""

import asyncio
import logging
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from pioneer3.errors import ConfigError
from pioneer3.log import mcap
from pioneer3.log.folder import logs_folder
from pioneer3.log.reader import open_log
from pioneer3.log.writer import JUST_MOVED, SYNC_PERIOD
from pioneer3.navigation.connect import connect_async
from pioneer3.runtime.recording import RobotLog, recorded
from pioneer3.runtime.verification import verify
from pioneer3.sim.server.start import simulator
from tests.e2e.processes import environment
from tests.support import SLOW, SimulatedRobot, hold, until

ROBOTS = 64
PAGE = 4096
"""Size that files on a tmpfs grow by [bytes]."""


@contextmanager
def mounted(folder: Path, *options: str) -> Iterator[Path]:
    """Mount a small disk of its own on a folder."""
    folder.mkdir()
    size = ",".join(("size=256k", *options))
    command = ["mount", "-t", "tmpfs", "-o", size, "tmpfs", str(folder)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        pytest.skip(f"nothing can be mounted here: {done.stderr.strip()}")
    try:
        yield folder
    finally:
        subprocess.run(["umount", "--lazy", folder], check=True)


def fill(folder: Path) -> None:
    """Leave no room on a disk."""
    with (folder / "filled").open("wb", buffering=0) as file:
        try:
            while True:
                file.write(bytes(PAGE))
        except OSError as error:
            assert error.strerror == "No space left on device"  # noqa: PT017 - the loop ends by it


@pytest.mark.realtime
async def test_a_disk_that_runs_full_ends_the_log_alone(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with mounted(tmp_path / "disk") as disk:
        path = disk / "run.mcap"
        async with SimulatedRobot() as sim:
            async with connect_async(sim.open, record=path) as robot:
                await hold(robot, 0.3, seconds=2.5)
                fill(disk)
                ended = "the recording has ended, and nothing else: No space left on device"
                await until(lambda: any(ended in each.message for each in caplog.records))
                await hold(robot, 0.3)
                assert sim.speed > 0.1
                robot.stop()
                await until(lambda: abs(sim.speed) < SLOW)
            assert abs(sim.speed) < SLOW
        lines = [each for each in caplog.records if each.name == "pioneer3.log.writer"]
        assert len(lines) == 1
        (found,) = await asyncio.to_thread(verify, open_log(path))
    assert found.difference is None
    assert found.compared > 10


@pytest.mark.realtime
async def test_on_a_read_only_disk_nothing_is_recorded_and_a_file_that_was_named_is_an_error(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("PIONEER3_RECORD")
    with mounted(tmp_path / "disk", "ro") as disk:
        monkeypatch.setenv("XDG_STATE_HOME", str(disk))
        async with SimulatedRobot() as sim:
            async with connect_async(sim.open) as robot:
                await hold(robot, 0.3)
                assert sim.speed > 0.1
            assert abs(sim.speed) < SLOW
            lines = [each.message for each in caplog.records if "recorded" in each.message]
            assert lines == [f"{logs_folder()}: nothing is recorded: Read-only file system"]
            with pytest.raises(ConfigError, match="cannot record there: Read-only file system"):
                async with connect_async(sim.open, record=disk / "mine.mcap"):
                    raise AssertionError


async def driven(record: RobotLog) -> int:
    """Drive a robot for a moment, and stop it; return how many readings came."""
    async with SimulatedRobot() as sim, connect_async(sim.open, record=record) as robot:
        await hold(robot, 0.3)
        assert sim.speed > 0.1
        robot.stop()
        await until(lambda: abs(sim.speed) < SLOW)
        assert robot.snapshot is not None
        return robot.snapshot.sequence


async def test_64_robots_of_one_program_are_in_one_log(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.WARNING)
    path = tmp_path / "all.mcap"
    with recorded(path, asyncio.get_running_loop().time) as log:
        assert log is not None
        seen = await asyncio.gather(*(driven(log.of(f"robot-{n}")) for n in range(ROBOTS)))
        assert log.log.dropped == 0
    assert not caplog.records
    counts = open_log(path).info().counts
    assert counts is not None
    for number, snapshots in enumerate(seen):
        assert counts[f"robot-{number}/snapshot"] >= snapshots
        assert counts[f"robot-{number}/decision"] >= 2
        assert counts[f"wire/robot-{number}/robot/out"] >= 1


PROGRAM = """
import sys
import time
from pathlib import Path
import pioneer3
with pioneer3.connect(sys.argv[1], record=Path(sys.argv[2])) as robot:
    while True:
        robot.drive(0.2)
        print(robot.snapshot.sequence, flush=True)
        time.sleep(0.1)
"""


@pytest.mark.realtime
async def test_of_a_program_that_is_killed_the_log_lacks_a_second_and_the_robot_stops(
    tmp_path: Path,
) -> None:
    path = tmp_path / "killed.mcap"
    async with simulator(map_name="empty", robot="p3dx-sh", port=0) as sim:
        process = await asyncio.create_subprocess_exec(
            sys.executable,
            "-c",
            PROGRAM,
            sim.url,
            str(path),
            stdout=asyncio.subprocess.PIPE,
            env=environment(),
        )
        assert process.stdout is not None
        for _ in range(40):
            last = int(await process.stdout.readline())
        process.send_signal(signal.SIGKILL)
        killed = time.time_ns()
        await process.wait()
        log = open_log(path)
        info = log.info()
        assert info.end == "cut off: killed, or without power"
        *_, kept = log.snapshots()
        assert kept.sequence >= last - 25  # a second, and what a busy machine takes
        assert killed - info.ended < 2.5e9
        (found,) = await asyncio.to_thread(verify, log)
        assert found.difference is None
        await until(lambda: abs(sim.body.speeds[0]) < SLOW)


@pytest.mark.realtime
@pytest.mark.parametrize("moves", [True, False])
async def test_while_a_robot_moves_each_second_is_brought_to_the_disk(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, moves: bool
) -> None:
    synced: list[float] = []

    def sync(descriptor: int) -> None:
        synced.append(time.monotonic())
        os.fsync(descriptor)

    monkeypatch.setattr(mcap, "SYNC", sync)
    path = tmp_path / "run.mcap"
    async with SimulatedRobot() as sim, connect_async(sim.open, record=path) as robot:
        await hold(robot, 0.2 if moves else 0.0, seconds=JUST_MOVED + 2.0)
    assert len(synced) >= 3 if moves else len(synced) <= 1 + (JUST_MOVED + 2.0) // SYNC_PERIOD
