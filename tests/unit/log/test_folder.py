"""The user's logs: the oldest go first, never one that is pinned or being written."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from pioneer3.errors import ConfigError
from pioneer3.log.folder import (
    NAME,
    create_log,
    find_log,
    is_being_written,
    make_room,
    pin,
    user_logs,
)


def log_of(folder: Path, title: str, now: float, size: int) -> Path:
    """Make a log of so many bytes."""
    path, descriptor = create_log(folder, title, now)
    os.write(descriptor, bytes(size))
    os.close(descriptor)
    return path


@pytest.mark.parametrize("title", ["drive", "map build", "", "../../etc/passwd", "\n", "x" * 99])
def test_names_stay_in_the_folder_and_are_known_again(tmp_path: Path, title: str) -> None:
    path = log_of(tmp_path / "logs", title, 0.0, 1)
    assert path.parent == tmp_path / "logs"
    assert NAME.fullmatch(path.name)
    assert user_logs(path.parent) == [path]


def test_twelve_of_one_second_are_sorted_as_they_came(tmp_path: Path) -> None:
    made = [log_of(tmp_path, "drive", 0.0, 1) for _ in range(12)]
    assert user_logs(tmp_path) == made
    assert tmp_path.stat().st_mode
    assert made[11].name == "1970-01-01T00-00-00Z-drive.12.mcap"


def test_the_folder_is_its_users_alone(tmp_path: Path) -> None:
    path = log_of(tmp_path / "state" / "logs", "drive", 0.0, 1)
    assert (path.parent.stat().st_mode & 0o777, path.stat().st_mode & 0o777) == (0o700, 0o600)


def test_the_oldest_go_but_no_pinned_one_no_other_file_and_none_being_written(
    tmp_path: Path,
) -> None:
    logs = [log_of(tmp_path, "drive", float(day), 100) for day in range(4)]
    notes = tmp_path / "notes.txt"
    notes.write_bytes(bytes(1000))
    pin(logs[0], on=True)
    written, descriptor = create_log(tmp_path, "run", -1.0)
    os.write(descriptor, bytes(100))
    assert is_being_written(written)
    make_room(tmp_path, 350)
    assert user_logs(tmp_path) == [written, logs[0], logs[3]]
    os.close(descriptor)
    make_room(tmp_path, 250)
    assert user_logs(tmp_path) == [logs[0], logs[3]]
    pin(logs[0], on=False)
    make_room(tmp_path, 0)
    assert list(tmp_path.iterdir()) == [notes]


def test_a_link_in_the_folder_is_neither_followed_nor_removed(tmp_path: Path) -> None:
    folder, other = tmp_path / "logs", tmp_path / "other"
    log_of(folder, "drive", 0.0, 1)
    other.write_text("mine")
    (folder / "1970-01-01T00-00-00Z-run.mcap").symlink_to(other)
    make_room(folder, 0)
    assert other.read_text() == "mine"
    assert user_logs(folder) == []


@pytest.mark.realtime
def test_programs_that_make_room_at_once_leave_what_there_is_room_for(tmp_path: Path) -> None:
    """Each writes logs of its own and holds one open, as 64 programs do in one folder."""
    program = f"""
import os, time
from pathlib import Path
from pioneer3.log.folder import create_log, make_room
folder = Path({str(tmp_path)!r})
kept, descriptor = create_log(folder, "kept", float(os.getpid()))
os.write(descriptor, bytes(10))
for number in range(40):
    path, each = create_log(folder, "drive", 1e9 + number)
    os.write(each, bytes(100))
    os.close(each)
    make_room(folder, 1000)
assert kept.exists()
print("done")
"""
    command = [sys.executable, "-c", program]
    programs = [subprocess.Popen(command, stdout=subprocess.PIPE, text=True) for _ in range(4)]
    assert [program.communicate()[0] for program in programs] == ["done\n"] * 4
    make_room(tmp_path, 1000)
    assert sum(path.stat().st_size for path in user_logs(tmp_path)) <= 1000
    assert len(user_logs(tmp_path)) > 5


@pytest.mark.parametrize("name", ["../secret.mcap", "/etc/passwd", "..", "drive/../x"])
def test_a_name_finds_no_file_that_is_not_there_to_be_found(tmp_path: Path, name: str) -> None:
    log_of(tmp_path / "logs", "drive", 0.0, 1)
    with pytest.raises(ConfigError, match="names no log"):
        find_log(tmp_path / "logs", name)


def test_a_part_of_a_name_finds_the_newest_log_with_it(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="there are no logs yet"):
        find_log(tmp_path, "")
    logs = [log_of(tmp_path, title, at, 1) for at, title in enumerate(("drive", "drive", "run"))]
    found = [find_log(tmp_path, name) for name in ("drive", logs[0].stem, logs[0].name, "1970", "")]
    assert found == [logs[1], logs[0], logs[0], logs[2], logs[2]]


def test_a_log_of_a_clock_that_was_ahead_is_not_the_newest(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    past, ahead = (log_of(tmp_path, "drive", at, 1) for at in (0.0, 9000.0))
    times = 0.0, 8941.0, 8939.0
    assert [find_log(tmp_path, "", lambda at=at: at) for at in times] == [past, ahead, past]  # type: ignore[misc]
    assert caplog.messages == [f"{ahead.name}: passed over: it began when the clock was ahead"] * 2
    assert find_log(tmp_path, ahead.stem, lambda: 0.0) == ahead
    past.unlink()
    assert find_log(tmp_path, "", lambda: 0.0) == ahead
