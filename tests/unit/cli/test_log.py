"""`pioneer3 log` lists logs, tells what is in one, keeps it, and cuts it."""

import json
import os
import re
import time
from collections.abc import Callable
from datetime import datetime
from pathlib import Path

import pytest

from pioneer3.cli.log import _moment, cut, info, list_, pin
from pioneer3.cli.log_stats import stats
from pioneer3.errors import ConfigError
from pioneer3.log import folder
from pioneer3.log.cut import MAGIC
from pioneer3.log.folder import create_log, is_pinned, logs_folder, user_logs
from pioneer3.log.mcap import McapFile
from pioneer3.log.moment import time_of
from pioneer3.log.reader import open_log, whole_log
from pioneer3.log.topics import EVENT, LogEvent, LogTopic
from pioneer3.state import Snapshot
from tests.unit.analysis.support import write_parts

WIRE = LogTopic("wire/robot/in", bytes)
COMMAND = LogTopic("command", LogEvent)
SNAPSHOTS = LogTopic("snapshot", Snapshot)
SECOND = 10**9
BEGAN = 1_772_357_400 * SECOND
"""When the logs of these tests began [ns since 1970]."""
Output = Callable[[], str]


@pytest.fixture
def output(capsys: pytest.CaptureFixture[str]) -> Output:
    return lambda: capsys.readouterr().out


def a_log(title: str, *, seconds: int = 10, ended: bool = True) -> Path:
    """Make a log of the user with an event and bytes each second."""
    path, descriptor = create_log(logs_folder(), title, BEGAN / SECOND)
    file = McapFile(descriptor)
    file.add_metadata("program", {"command": f"pioneer3 {title}"})
    file.add_metadata("robot", {"name": "bob\x1b[31m", "model": "p3at-sh"})
    for second in range(seconds + 1):
        file.add(EVENT, [(BEGAN + second * SECOND, LogEvent("link", str(second)))])
        file.add(COMMAND, [(BEGAN + second * SECOND, LogEvent("drive", ""))])
        file.add(WIRE, [(BEGAN + second * SECOND, b"%d" % second)])
        file.flush()
    if ended:
        file.add_metadata("end", {"why": "left as usual"})
        file.finish()
    return path


def test_the_list_says_of_which_robot_how_long_and_why_it_ended(output: Output) -> None:
    assert list_() == 0
    assert output().startswith("No logs in ")
    a_log("drive")
    a_log("map build", seconds=3700)
    a_log("wander", ended=False)
    assert list_() == 0
    text = output()
    assert "\x1b" not in text
    for words in ("Z-drive", "0:10", "left as usual", "Z-map-build", "1:01:40", "goes on"):
        assert words in text
    assert list_(json=True) == 0
    known = json.loads(output())
    assert [each["seconds"] for each in known] == [10.0, 3700.0, 10.0]
    assert [each["messages"] and each["messages"]["event"] for each in known] == [11, 3701, None]


def test_a_log_in_two_files_is_one_in_the_list_and_whichever_is_named(output: Output) -> None:
    first, second = (
        each.rename(each.with_name(f"2026-03-01T09-30-0{number}Z-run.mcap"))
        for number, each in enumerate(write_parts(a_log("drive").parent))
    )
    assert list_(json=True) == 0
    _, listed = json.loads(output())
    assert listed["files"] == [str(first), str(second)]
    assert (round(listed["seconds"]), listed["end"]) == (4, "left as usual")
    for name in ("00Z-run", "01Z-run"):
        assert info(name, json=True) == 0
        assert json.loads(output()) == listed
        assert info(name) == 0
        text = output()
        assert re.search(rf"\ngoes on in +{second.name}\n", text)
        assert "\nThe end of a file is missing: " in text


def test_a_file_of_a_log_that_has_gone_is_told(output: Output, tmp_path: Path) -> None:
    first, _ = write_parts(tmp_path, seconds=6.0, gone=25)
    assert info(str(first)) == 0
    assert re.search(r"\nlacks +\d\d:30:02 to \d\d:30:04: files that have gone\n", output())


def test_a_log_that_is_damaged_does_not_hide_the_others(output: Output) -> None:
    a_log("drive")
    (logs_folder() / "2026-03-01T09-30-00Z-run.mcap").write_bytes(b"no log")
    assert list_(json=True) == 0
    assert len(json.loads(output())) == 1


def test_empty_logs_are_told_by_one_line_and_one_that_begins_or_has_gone_by_none(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    path = a_log("drive")
    for _ in range(3):
        os.close(create_log(logs_folder(), "run", BEGAN / SECOND)[1])
    _, begins = create_log(logs_folder(), "run", BEGAN / SECOND)
    gone = path.with_name("2026-03-01T09-30-00Z-gone.mcap")
    monkeypatch.setattr(folder, "user_logs", lambda where: [*user_logs(where), gone])
    assert list_(json=True) == 0
    told = capsys.readouterr()
    assert [each["file"] for each in json.loads(told.out)] == [str(path)]
    assert told.err.splitlines() == [
        "WARNING: 3 logs are empty: killed, without power, or without room on the disk"
    ]
    os.close(begins)


def test_info_tells_what_was_started_and_counts_messages(output: Output) -> None:
    path = a_log("drive")
    assert info("drive") == 0
    facts, _, counts = output().partition("messages")
    lines = dict(line.split("  ", 1) for line in facts.splitlines())
    assert lines["command"].strip() == "pioneer3 drive"
    assert lines["robot"].strip() == r"bob\x1b[31m, p3at-sh"
    assert counts.split() == ["command", "11", "event", "11", "wire/robot/in", "11"]
    assert info(str(path), json=True) == 0
    assert json.loads(output())["end"] == "left as usual"


def test_the_newest_log_is_one_with_messages_and_a_line_tells_of_a_newer_one(
    capsys: pytest.CaptureFixture[str], caplog: pytest.LogCaptureFixture
) -> None:
    path, later = a_log("drive"), BEGAN / SECOND + 60
    assert info() == 0
    assert not caplog.messages
    for title, content in (("run", b""), ("wander", bytes(10**6)), ("run", MAGIC + bytes(10**6))):
        empty, descriptor = create_log(logs_folder(), title, later)
        os.write(descriptor, content)
        os.close(descriptor)
        caplog.clear()
        assert info() == 0
        assert str(path) in capsys.readouterr().out
        assert caplog.messages == [f"{empty.name}: passed over: it is newer, but has no messages"]
    with pytest.raises(ConfigError, match="is no log"):
        info("wander")
    stats()
    assert "run" not in capsys.readouterr().err


def test_a_pinned_log_is_kept_until_it_is_let_go() -> None:
    path = a_log("drive")
    assert pin("drive") == 0
    assert is_pinned(path)
    assert pin("drive", off=True) == 0
    assert not is_pinned(path)


def test_all_files_of_a_log_are_pinned_whichever_is_named_and_a_damaged_one() -> None:
    parts = [
        each.rename(each.with_name(f"2026-03-01T09-30-0{number}Z-run.mcap"))
        for number, each in enumerate(write_parts(a_log("drive").parent))
    ]
    for name in ("00Z-run", "01Z-run"):
        for on in (True, False):
            assert pin(name, off=not on) == 0
            assert [is_pinned(each) for each in parts] == [on, on]
    parts[0].write_bytes(b"no log")
    assert pin("00Z-run") == 0
    assert [is_pinned(each) for each in parts] == [True, False]


def test_no_file_but_a_log_of_the_user_is_pinned(tmp_path: Path) -> None:
    mine = tmp_path / "thesis.mcap"
    mine.touch(mode=0o644)
    with pytest.raises(ConfigError, match="names no log"):
        pin(str(mine))
    assert mine.stat().st_mode & 0o777 == 0o644


@pytest.mark.parametrize(
    ("begin", "end", "kept"),
    [("2s", "4s", range(2, 5)), (None, "1s", range(2)), ("9s", None, range(9, 11))],
)
def test_a_part_is_a_log_of_its_own(
    tmp_path: Path, begin: str | None, end: str | None, kept: range
) -> None:
    a_log("drive")
    part = tmp_path / "part.mcap"
    assert cut("drive", output=part, begin=begin, end=end) == 0
    log = open_log(part)
    assert [event.text for _, event in log.of(EVENT)] == [str(second) for second in kept]
    bytes_kept = [each.data for each in log.messages(WIRE.name.__eq__)]
    assert bytes_kept == [b"%d" % second for second in kept]
    assert log.info().command == "pioneer3 drive"
    with pytest.raises(ConfigError, match=r"part\.mcap: cannot be written: File exists"):
        cut("drive", output=part)


def test_a_part_may_be_of_two_files(tmp_path: Path) -> None:
    parts = write_parts(tmp_path)
    log = whole_log(parts[0])
    whole, began = [*log.of(SNAPSHOTS)], log.info().began
    for path in parts:
        part = tmp_path / f"part-{path.name}"
        assert cut(str(path), output=part, begin="1s", end="3s") == 0
        kept = [each for each in whole if SECOND <= each[0] - began <= 3 * SECOND]
        assert [*open_log(part).of(SNAPSHOTS)] == kept
        assert len(kept) > 10


def test_a_part_without_messages_leaves_no_file(tmp_path: Path) -> None:
    a_log("drive")
    with pytest.raises(ConfigError, match="nothing was logged then"):
        cut("drive", output=tmp_path / "part.mcap", begin="1h")
    assert list(tmp_path.iterdir()) == []


def test_a_time_of_day_is_that_of_this_computer_also_after_midnight(tmp_path: Path) -> None:
    known = open_log(a_log("drive")).info()
    began = time.localtime(BEGAN / SECOND)
    text = time.strftime("%H:%M:%S", began)
    assert _moment("begin", text, known) == BEGAN
    before = time.strftime("%H:%M:%S", time.localtime(BEGAN / SECOND - 3600))
    assert _moment("begin", before, known) == BEGAN + 23 * 3600 * SECOND
    for wrong in ("25:00", "soon"):
        with pytest.raises(ConfigError, match=f"--begin.*{wrong}"):
            _moment("begin", wrong, known)


@pytest.mark.parametrize(
    ("began", "text", "expected"),
    [
        ("2026-03-29T01:50+01:00", "03:10", "2026-03-29T03:10+02:00"),
        ("2026-10-24T23:50+02:00", "03:30", "2026-10-25T03:30+01:00"),
        ("2026-10-25T02:50+02:00", "02:30", "2026-10-25T02:30+01:00"),
        ("2026-10-25T02:50+02:00", "02:55", "2026-10-25T02:55+02:00"),
        ("2026-10-24T12:00+02:00", "11:00", "2026-10-25T11:00+01:00"),
        ("2026-10-24T12:00+02:00", "2026-10-26 12:00:00.5", "2026-10-26T12:00:00.5+01:00"),
        ("2026-10-24T12:00+02:00", "2026-10-25T12:00:00+00:00", "2026-10-25T13:00+01:00"),
    ],
)
def test_a_time_of_day_is_right_where_clocks_are_set_in_spring_and_autumn(
    began: str, text: str, expected: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def ns(text: str) -> int:
        return round(datetime.fromisoformat(text).timestamp() * SECOND)

    with monkeypatch.context() as changed:
        changed.setenv("TZ", "CET-1CEST,M3.5.0,M10.5.0/3")
        time.tzset()
        found = time_of(text, ns(began))
    time.tzset()
    assert found == ns(expected)
