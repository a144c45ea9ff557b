"""A log is written beside the driver: whatever its disk does, nobody waits; one line is said."""

import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from mcap.reader import make_reader

from pioneer3.errors import ConfigError
from pioneer3.log import reader, writer
from pioneer3.log.index import LogIndex
from pioneer3.log.reader import open_log, whole_log
from pioneer3.log.target import NamedFile, UserFolder
from pioneer3.log.topics import EVENT, LogEvent, LogTopic, unpack_pieces
from pioneer3.log.writer import LogWriter, named_log, user_log
from tests.support import disk_of
from tests.unit.analysis.support import write_parts

BYTES = LogTopic("wire/robot/in", bytes)
PATIENCE = 20.0

pytestmark = pytest.mark.realtime


def until(condition: Callable[[], object]) -> None:
    """Wait for the thread that writes."""
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.01)


@contextmanager
def logged(path: Path, **options: object) -> Iterator[LogWriter]:
    """Write a log, to its end."""
    log = LogWriter(NamedFile(path, patience=PATIENCE), time.monotonic, **options)  # type: ignore[arg-type]
    yield log
    log.close("done")


def events(path: Path) -> list[LogEvent]:
    return [event for _, event in open_log(path).of(EVENT)]


def test_what_is_put_is_there_in_its_order_and_at_its_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, before = tmp_path / "a.mcap", time.time_ns()
    sent = [bytes([number]) for number in range(100)]
    monkeypatch.setattr("sys.argv", ["/usr/bin/pioneer3", "drive", "--password", "secret"])
    with logged(path) as log:
        for data in sent:
            log.put(BYTES, data)
        log.describe("robot", {"name": "bob"})
    messages = list(open_log(path).messages())
    assert [each.data for each in messages] == sent
    assert before <= messages[0].time <= messages[-1].time <= time.time_ns()
    info = open_log(path).info()
    assert info.counts is not None
    assert info.counts.keys() == {"wire/robot/in"}
    assert info.command == "pioneer3 drive --password '***'"
    assert (info.robot, info.end) == ("bob", "done")
    assert not info.being_written
    assert path.stat().st_mode & 0o777 == 0o600


def test_a_log_without_messages_began_when_it_was_written(tmp_path: Path) -> None:
    path, before = tmp_path / "a.mcap", time.time_ns()
    with logged(path):
        pass
    (tmp_path / "cut.mcap").write_bytes(path.read_bytes()[:8])
    for info in (open_log(path).info(), open_log(tmp_path / "cut.mcap").info()):
        assert abs(info.began - before) < PATIENCE * 1e9
        assert info.seconds == 0.0


def test_several_robots_are_told_by_their_names(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    with logged(path) as log:
        for name in ("bob", "amy"):
            log.describe(f"{name}/robot", {"name": "MobileSim"})
    info = open_log(path).info()
    assert info.robot == "bob, amy"


def test_the_librarys_own_reader_finds_its_checksums_right(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    with logged(path) as log:
        log.put(BYTES, b"abc")
        log.event("link", "lost")
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        found = {channel.topic: message.data for _, channel, message in reader.iter_messages()}
        (piece,) = unpack_pieces(0, found.pop("wire/robot/in"))
        summary = reader.get_summary()
    assert piece == (0, b"abc")
    assert found == {"event": b'{"kind":"link","text":"lost"}'}
    assert summary is not None
    assert summary.statistics is not None
    assert summary.statistics.message_count == 2


def test_a_program_that_is_killed_loses_the_last_second_at_most(tmp_path: Path) -> None:
    path = tmp_path / "killed.mcap"
    program = f"""
import time
from pathlib import Path
from pioneer3.log.topics import LogTopic
from pioneer3.log.writer import named_log
log = named_log(Path({str(path)!r}), time.monotonic)
topic = LogTopic("wire/robot/in", bytes)
while True:
    now = str(time.time_ns()).encode()
    log.put(topic, now)
    print(now.decode(), flush=True)
    time.sleep(0.02)
"""
    command = [sys.executable, "-c", program]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        put = [int(process.stdout.readline()) for _ in range(150)]
        assert open_log(path).info().being_written
        process.kill()
        put += map(int, process.stdout.read().split())
    kept = [int(each.data) for each in open_log(path).messages()]
    assert kept == put[: len(kept)]
    assert put[-1] - kept[-1] < 1.5e9  # a second, and what a busy machine takes
    info = open_log(path).info()
    assert info.end == "cut off: killed, or without power"
    assert info.ended == pytest.approx(kept[-1], abs=1.5e9)


def test_a_full_disk_ends_the_log_with_one_line_and_keeps_what_was_there(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path, sent = tmp_path / "full.mcap", [os.urandom(1000) for _ in range(60)]
    with disk_of(30_000), logged(path) as log:
        for data in sent:
            log.put(BYTES, data)
            log._wake.set()
            time.sleep(0.01)
        until(lambda: log.failure)
        log.put(BYTES, b"and it goes on")
    assert [record.message for record in caplog.records] == [
        f"{path}: the recording has ended, and nothing else: File too large"
    ]
    kept = [each.data for each in open_log(path).messages()]
    assert kept == sent[: len(kept)]
    assert len(kept) > 10
    assert open_log(path).info().end == "the recording ended: File too large"


def test_where_the_next_file_cannot_be_opened_the_last_one_tells_it_and_no_other_file_suffers(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = UserFolder(tmp_path / "logs", "drive", 100_000, time.time)
    log = LogWriter(target, time.monotonic)
    until(lambda: log.files)
    others: list[int] = []

    def refused(target: UserFolder) -> int:
        others.append(os.open(tmp_path / "other", os.O_CREAT | os.O_RDWR))
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(UserFolder, "open", refused)
    log.put(BYTES, os.urandom(20_000))
    until(lambda: log.failure)
    log.close("done")
    (other,) = others
    assert os.fstat(other).st_size == 0  # is still open
    os.close(other)
    assert open_log(log.files[0]).info().end == "the recording ended: Operation not permitted"


def test_a_folder_that_cannot_be_made_is_told_once(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    (tmp_path / "file").write_text("")
    target = UserFolder(tmp_path / "file" / "logs", "drive", 1 << 30, time.time)
    log = LogWriter(target, time.monotonic)
    log.put(BYTES, b"abc")
    until(lambda: log.failure)
    log.put(BYTES, b"abc")
    log.close("done")
    (record,) = caplog.records
    assert record.message == f"{tmp_path}/file/logs: nothing is recorded: Not a directory"


def test_a_file_that_is_there_is_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    path.write_text("mine")
    with pytest.raises(ConfigError, match=r"a\.mcap: cannot record there: File exists"):
        named_log(path, time.monotonic)
    assert path.read_text() == "mine"


class HangingDisk:
    """Opens a file, and takes nothing until it is `mended`."""

    most: int | None = None
    patience = 0.05

    def __init__(self, path: Path) -> None:
        self.path, self.mended = path, threading.Event()

    def open(self) -> int:
        self.mended.wait(PATIENCE)
        return NamedFile(self.path).open()

    def tidy(self) -> None:
        """Do nothing."""


def test_a_disk_that_hangs_holds_nobody_up_and_the_oldest_is_lost_and_counted(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(writer, "MOST_WAITING", 10_000)
    monkeypatch.setattr(writer, "FEW", 8)
    disk = HangingDisk(tmp_path / "slow.mcap")
    log = LogWriter(disk, time.monotonic)
    for number in range(1000):
        log.put(BYTES, b"%0100d" % number)
    assert 850 < log.dropped < 1000
    (record,) = caplog.records
    assert "the disk is too slow to record all: the oldest is lost" in record.message
    disk.mended.set()
    log.close("done", PATIENCE)
    kept = [int(each.data) for each in open_log(disk.path).messages(lambda t: t == BYTES.name)]
    assert kept == list(range(log.dropped, 1000))
    assert events(disk.path) == [LogEvent("dropped", f"{log.dropped} messages: a slow disk")]


def test_a_clock_that_is_set_is_told_and_times_go_on_evenly(tmp_path: Path) -> None:
    path, wall = tmp_path / "a.mcap", [1_000_000_000_000]
    with logged(path, wall=lambda: wall[0] + time.monotonic_ns()) as log:
        log.put(BYTES, b"1")
        wall[0] += 3_600_000_000_000
        until(lambda: log._set_by)
        log.put(BYTES, b"2")
        wall[0] -= 7_200_000_000_000
        until(lambda: log._set_by < 0)
    assert [event.text for event in events(path)] == [
        "the computer's clock was set by +3600.000 s",
        "the computer's clock was set by -7200.000 s",
    ]
    first, last = (each.time for each in open_log(path).messages(lambda t: t == BYTES.name))
    assert 0 < last - first < PATIENCE * 1e9


def test_a_long_log_goes_on_in_more_files_and_the_oldest_go(tmp_path: Path) -> None:
    folder, room = tmp_path / "logs", 2_000_000
    log = LogWriter(UserFolder(folder, "drive", room, time.time), time.monotonic)
    log.describe("robot", {"name": "bob"})
    kept = LogTopic("map", LogEvent, make=lambda text: LogEvent("map", text), repeated=True)
    log.put(kept, "old")
    log.put(kept, "new")
    for _ in range(40):
        log.put(BYTES, os.urandom(room // 20))
        log._wake.set()
        until(lambda: not log._queue)
    log.close("done", PATIENCE)
    files = sorted(folder.iterdir())
    assert 4 < len(files) <= 16
    assert sum(file.stat().st_size for file in files) <= room
    assert {open_log(file).info().robot for file in files} == {"bob"}
    assert {[*open_log(file).of(kept)][-1][1].text for file in files} == {"new"}
    ends = sorted(open_log(file).info().end for file in files)
    assert ends == ["done", *["goes on in the next file"] * (len(files) - 1)]
    (tmp_path / "logs" / "broken.mcap").write_bytes(b"\x89MCAP0\r\n")
    with logged(folder / "other.mcap") as other:
        other.put(BYTES, b"other")
    whole = whole_log(min(files, key=lambda file: open_log(file).info().began))
    assert {*whole.files} == {*files}
    assert (whole.info().end, whole.info().robot) == ("done", "bob")
    pieces = [*whole.messages(BYTES.name.__eq__)]
    assert whole.info().counts == {BYTES.name: len(pieces), kept.name: len(files)}
    assert [each.time for each in pieces] == sorted({each.time for each in pieces})
    index = LogIndex(*whole.files)
    assert (index.began, index.ended) == (whole.info().began, whole.info().ended)
    assert [*index.walk(kept.name, 0, index.ended)] == [*whole.messages(kept.name.__eq__)]
    assert open_log(whole.files[0]).info().end == "goes on in the next file"


def test_the_files_of_a_log_are_found_among_many_others(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(reader, "MOST_BESIDE", 2)
    parts = write_parts(tmp_path)
    for name in "0123456789":
        (tmp_path / f"{name}.mcap").write_bytes(b"")
    for path in parts:
        assert {*whole_log(path).files} == {*parts}


def test_what_changes_while_another_file_begins_counts_more_than_what_is_repeated(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    kept = LogTopic("map", LogEvent, make=lambda text: LogEvent("map", text), repeated=True)
    folder = UserFolder(tmp_path, "drive", 10**9, time.time)
    log = LogWriter(folder, time.monotonic)
    until(lambda: log.files)
    begin = UserFolder.open

    def changed(folder: UserFolder) -> int:
        log.put(kept, "new")
        return begin(folder)

    monkeypatch.setattr(UserFolder, "open", changed)
    log.put(kept, "old")
    folder.most = 1
    until(lambda: len(log.files) > 1)
    folder.most = None
    log.close("done", PATIENCE)
    told = [event.text for _, event in open_log(log.files[1]).of(kept)]
    assert told == ["old", "new"]


def test_a_log_in_one_file_is_whole_by_itself(tmp_path: Path) -> None:
    for name in ("a", "b"):
        with logged(tmp_path / f"{name}.mcap") as log:
            log.put(BYTES, b"1")
    assert whole_log(tmp_path / "a.mcap").files == (tmp_path / "a.mcap",)


def test_nothing_is_recorded_where_it_is_switched_off(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PIONEER3_RECORD", "0")
    assert user_log(time.monotonic) is None
    monkeypatch.setenv("PIONEER3_LOG_ROOM", "much")
    with pytest.raises(ConfigError, match=r"PIONEER3_LOG_ROOM=much: a number of GiB is expected"):
        user_log(time.monotonic, always=True)
