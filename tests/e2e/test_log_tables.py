"""`--csv` leaves the tables of a run, whole, however it ends; a failure of theirs is told."""

import asyncio
import csv
import re
import signal
import sys
from pathlib import Path

import pytest

from pioneer3.errors import ConfigError
from pioneer3.log import tables
from pioneer3.log.folder import GIB, ROOM, logs_folder, user_logs
from pioneer3.navigation.connect import connect_async
from pioneer3.runtime.recording import WithTables
from pioneer3.sim.server.start import simulator
from tests.e2e.processes import environment
from tests.support import SimulatedRobot, until


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return [*csv.DictReader(file)]


@pytest.mark.realtime
@pytest.mark.parametrize("sent", [None, signal.SIGTERM])
async def test_a_command_leaves_tables_as_it_ends(tmp_path: Path, sent: int | None) -> None:
    folder = tmp_path / "run"
    async with simulator(port=0) as simulated:
        words = ("wander", "--port", simulated.url, "--csv", str(folder))
        process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-m", "pioneer3", *words),
            *(() if sent else ("--seconds", "2")),
            env=environment(),
            stdout=asyncio.subprocess.DEVNULL,
            stderr=asyncio.subprocess.PIPE,
        )
        body = simulated.robots[0].body
        if sent:
            await until(lambda: body.speeds[0] > 0)
            process.send_signal(sent)
        _, err = await process.communicate()
        assert process.returncode == (128 + sent if sent else 0), err
        assert body.speeds == (0, 0)
    assert f"writing tables to {folder}" in err.decode()
    assert {"snapshot.csv", "decision.csv", "wire-robot-in.csv"} <= {*map(str, names(folder))}
    told = rows(folder / "snapshot.csv")
    assert float(told[-1]["odometry.robot_in_odom.x [m]"]) >= 0
    assert len(user_logs(logs_folder())) == 1


def names(folder: Path) -> set[str]:
    return {each.name for each in folder.iterdir()}


async def test_a_folder_that_is_there_is_refused_before_anything_is_sent(tmp_path: Path) -> None:
    async with SimulatedRobot() as sim:
        with pytest.raises(ConfigError, match="is there already"):
            async with connect_async(sim.open, record=WithTables(tmp_path)):
                pytest.fail("connected")  # pragma: no cover


@pytest.mark.parametrize("fails", [False, True])
async def test_tables_that_cannot_be_written_hide_no_other_error(
    fails: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object, **__: object) -> None:
        raise ConfigError("no space left")

    monkeypatch.setattr(tables, "write_tables", full)
    told: list[str] = []
    record = WithTables(tmp_path / "run", tmp_path / "a.mcap", told.append)

    async def run() -> None:
        async with SimulatedRobot() as sim, connect_async(sim.open, record=record):
            if fails:
                raise KeyError

    with pytest.raises(KeyError if fails else ConfigError):
        await run()
    assert (told[-1] == "no tables: no space left") == fails
    assert (tmp_path / "a.mcap").exists()


async def test_the_tables_of_a_long_log_begin_with_the_files_that_are_left(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(ROOM, str(100_000 / GIB))
    told: list[str] = []
    record = WithTables(tmp_path / "run", True, told.append)
    async with SimulatedRobot() as sim, connect_async(sim.open, record=record) as robot:
        log = robot.arbiter.log
        assert log is not None
        while not log.log.files or log.log.files[0].exists():  # noqa: ASYNC110 - a thread writes
            await asyncio.sleep(1)
    assert re.search("without the log's first [0-9]+ files", told[-1])
    begin = float(rows(tmp_path / "run" / "snapshot.csv")[0]["stamp [s]"])
    assert begin > 1
