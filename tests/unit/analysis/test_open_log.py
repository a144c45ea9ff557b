"""Programs open logs by one door, and read the robots, the times and the messages in them."""

import os
from pathlib import Path
from shutil import copy

import pytest

import pioneer3
from pioneer3.analysis.anonymous import write_anonymous
from pioneer3.errors import ConfigError, PortNotFoundError
from pioneer3.log import OpenLog
from pioneer3.log.excerpt import write_excerpt
from pioneer3.log.folder import create_log, logs_folder
from pioneer3.log.index import LogIndex
from pioneer3.log.reader import RunLog
from pioneer3.log.tables import TableKind, write_tables
from pioneer3.log.topics import EVENT, LogEvent
from pioneer3.runtime.recording import CommandGiven, DecisionMade
from pioneer3.state import Scan
from tests.unit.analysis.support import (
    BEGAN,
    CLOCK,
    LAG,
    SECOND,
    decided,
    driven,
    given,
    scan,
    topic,
    write_log,
    write_parts,
)

TWO = {"amy/": "MobileSim", "bob/": "MobileSim"}


@pytest.fixture
def log(tmp_path: Path) -> OpenLog:
    """Return a log of two seconds ahead, that a key asked for."""
    messages = [
        *driven(2.0),
        (0.5, topic("command", CommandGiven), given("keyboard", "drive", 0.5)),
        (0.6, topic("decision", DecisionMade), decided("", 0.5)),
        (1.0, topic("scan/laser", Scan, steady="angles"), scan(0.9)),
        (1.5, topic("scan/laser2", Scan, steady="angles"), scan(1.4, laser="laser2")),
    ]
    return pioneer3.log.open(write_log(tmp_path / "a.mcap", messages))


def test_the_messages_are_objects_with_their_times(log: OpenLog) -> None:
    assert log.robots == ("bob",)
    assert log.began.timestamp() == BEGAN / SECOND
    assert [each.sequence for each in log.snapshots()] == [*range(21)]
    (second,) = [each for each in log.snapshots() if each.sequence == 10]
    assert log.time_at(second.stamp) == pytest.approx(1.0)
    assert list(log.commands()) == [(0.5, given("keyboard", "drive", 0.5))]
    assert list(log.decisions()) == [(0.6, decided("", 0.5))]
    assert [each.laser for each in log.scans()] == ["laser"]
    assert [each.laser for each in log.scans("laser2")] == ["laser2"]
    assert [event.text for _, event in log.events()] == ["robot: connected"]
    expected = ("command", "decision", "event", "scan/laser", "scan/laser2", "snapshot")
    assert log.topics() == expected


def test_a_part_has_the_messages_of_its_time(log: OpenLog) -> None:
    part = log.between(1, "1500ms")
    assert [each.sequence for each in part.snapshots()] == [10, 11, 12, 13, 14]
    assert [each.sequence for each in part.between(end=1.2).snapshots()] == [10, 11]
    assert list(part.commands()) == []
    clock = log.began.strftime("%H:%M:%S")
    assert len(list(log.between(end=clock).snapshots())) == 0
    assert len(list(log.between(begin=clock).snapshots())) == 21


@pytest.mark.parametrize("wrong", ["soon", "25:00", "3 parsecs", float("nan"), float("inf"), 1e300])
def test_what_is_no_time_is_told(log: OpenLog, wrong: float | str) -> None:
    with pytest.raises(ConfigError, match=r"no |time"):
        log.between(wrong)


def test_several_robots_are_read_by_their_names(tmp_path: Path) -> None:
    messages = [*driven(1.0, "amy/"), *driven(2.0, "bob/")]
    log = pioneer3.log.open(write_log(tmp_path / "a.mcap", messages, robots=TWO))
    assert log.robots == ("amy", "bob")
    assert [len(list(log.robot(name).snapshots())) for name in log.robots] == [11, 21]
    assert log.robot("bob").topics() == ("event", "snapshot")
    with pytest.raises(ConfigError, match=r"has the robots amy, bob: choose one.*\.robot\('amy'\)"):
        log.snapshots()
    with pytest.raises(ConfigError, match="has no robot 'eve'; there are: amy, bob"):
        log.robot("eve")


def test_the_newest_event_of_a_robot_is_not_that_of_another_one(tmp_path: Path) -> None:
    told = [
        (0.2, "amy/robot: closed"),
        (0.3, "bob/robot: closed"),
        (0.4, "amy/laser: closed"),
        (0.5, "bob/laser: closed"),
    ]
    events = [(time, EVENT, LogEvent("link", text)) for time, text in told]
    messages = [*driven(1.0, "amy/"), *driven(1.0, "bob/"), *events]
    log = pioneer3.log.open(write_log(tmp_path / "a.mcap", messages, robots=TWO))
    for robot in ("amy", "bob"):
        newest = log.robot(robot).newest("event")
        assert newest is not None
        assert newest[1].text == f"{robot}/laser: closed"


@pytest.mark.parametrize("odd", ["wire", "scan", "robot", "event"])
def test_robots_may_have_names_that_topics_have(odd: str, tmp_path: Path) -> None:
    parts = [
        (each, topic(f"{name}/scan/laser", Scan, steady="angles"), scan(each))
        for name in ("bob", odd)
        for each in (0.3, 0.6)
    ]
    messages = [*driven(1.0, f"{odd}/"), *driven(1.0, "bob/"), *parts]
    names = {"bob/": "bob", f"{odd}/": odd}
    log = pioneer3.log.open(write_log(tmp_path / "a.mcap", messages, robots=names))
    robot = log.robot(odd)
    assert robot.topics() == ("event", "scan/laser", "snapshot")
    assert len([*robot.snapshots()]) == 11
    assert len(robot.array("scan")) == 6
    assert len(write_tables(log.source, tmp_path / "csv", TableKind.CSV)) == 7
    assert write_anonymous(log, tmp_path / "b.mcap") == 27


def test_a_topic_that_is_not_there_is_told_before_anything_is_read(log: OpenLog) -> None:
    for wrong in ("snapshots", "scan", "snapshot/x", "wire/robot/in", ""):
        with pytest.raises(ConfigError, match=r"has no messages '.*'; there are: command, d"):
            log.messages(wrong)


def test_a_log_without_its_end_is_read_as_well(tmp_path: Path) -> None:
    log = pioneer3.log.open(write_log(tmp_path / "cut.mcap", driven(2.0), ended=False))
    assert log.topics() == ("event", "snapshot")
    assert len(log.array("odometry")) == 21
    data = log.path.read_bytes()
    short, counts = tmp_path / "short.mcap", []
    for size in range(len(data), 8, -97):
        short.write_bytes(data[:size])
        if not [*RunLog(short).chunks()]:
            break
        counts.append(len(list(pioneer3.log.open(short).snapshots())))
    assert counts == sorted(counts, reverse=True)
    assert (counts[0], counts[-1]) == (21, 10)
    with pytest.raises(ConfigError, match="no messages were logged"):
        pioneer3.log.open(short).snapshots()


def test_a_log_is_named_as_on_the_command_line() -> None:
    path, descriptor = create_log(logs_folder(), "drive", BEGAN / SECOND)
    os.close(descriptor)
    path.unlink()
    write_log(path, driven(1.0))
    assert pioneer3.log.open("drive").path == path
    with pytest.raises(ConfigError, match="wander: names no log"):
        pioneer3.log.open("wander")


def test_what_is_no_log_is_told_in_a_sentence(tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_text("no log")
    with pytest.raises(ConfigError, match=r"a\.txt: is no log: expected is an MCAP file"):
        pioneer3.log.open(tmp_path / "a.txt")
    with pytest.raises(PortNotFoundError):
        OpenLog(tmp_path / "b.mcap")


def test_a_log_that_does_not_tell_its_clock_has_the_times_of_its_messages(tmp_path: Path) -> None:
    for clock in ("", "soon", "nan", "1e300"):
        path = tmp_path / f"{clock}.mcap"
        write_log(path, driven(1.0), texts={"program": {"clock": clock}})
        log = pioneer3.log.open(path)
        assert log.array("odometry")["time"][5] == pytest.approx(0.5 + LAG)
    with pytest.raises(ConfigError, match="does not tell the clock of its program"):
        pioneer3.log.open(tmp_path / ".mcap").time_at(CLOCK)


def test_a_log_in_two_files_is_one(tmp_path: Path) -> None:
    parts = write_parts(tmp_path)
    log = pioneer3.log.open(parts[1])
    assert (log.path, *log.more) == parts
    assert len([*log.snapshots()]) == 41
    assert log.array("odometry")["x"][-1] == pytest.approx(2.0)
    write_excerpt(LogIndex(*parts), tmp_path / "b.mcap", BEGAN + 2 * SECOND, BEGAN + 4 * SECOND)
    copy(parts[1], tmp_path / "c.mcap")
    for part in parts:
        log = pioneer3.log.open(part)
        assert (log.path, *log.more) == parts
    assert pioneer3.log.open(tmp_path / "b.mcap").more == ()
    newest = log.between(end=1.0).newest("snapshot")
    assert newest is not None
    assert newest[0] == pytest.approx(0.91)
