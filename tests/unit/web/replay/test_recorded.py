"""A robot of a log at a time is the same however that time was reached; its events are told."""

from itertools import count
from pathlib import Path
from random import Random

import msgspec
import numpy as np
import pytest

from pioneer3.arcos.reports import Config
from pioneer3.errors import ConfigError
from pioneer3.log.index import LogIndex
from pioneer3.log.reader import LogMessage
from pioneer3.maps import LineMap
from pioneer3.models import load_model
from pioneer3.models.model import UnknownModel
from pioneer3.models.own import own_path
from pioneer3.navigation.recording import MapUsed
from pioneer3.robot.explain import STOPPED, ReasonKind
from pioneer3.robot.supervisor import Connection
from pioneer3.runtime.recording import StandsBecause, described
from pioneer3.web import messages
from pioneer3.web.replay import view
from pioneer3.web.replay.marks import MarkFinder
from pioneer3.web.replay.recorded import RecordedRobot, robots_of
from tests.unit.web.replay.logs import BEGAN, SECOND, SPEED, LogFile, drive, snapshot, truth

WALLS = np.array([[0.0, -2.0, 20.0, -2.0], [0.0, 2.0, 20.0, 2.0]])
HALL = LineMap(name="hall", walls=WALLS, lines=WALLS)


def robots(*paths: Path) -> list[RecordedRobot]:
    """Return the robots of logs."""
    numbers = count(1)
    found = [robots_of(LogIndex(path), lambda: next(numbers), path.stem) for path in paths]
    return [robot for each in found for robot in each]


def at(robot: RecordedRobot, second: float) -> messages.SnapshotMessage:
    """Return the message about a robot at a time since the begin."""
    robot.seek(BEGAN + round(second * SECOND))
    told = view.snapshot(robot)
    assert told is not None
    return told


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the log of a drive on a map."""
    return drive(tmp_path_factory.mktemp("logs") / "drive.mcap", line_map=HALL)


def test_any_time_is_the_same_if_it_is_played_or_gone_to(path: Path) -> None:
    (played,), (sought,), random = robots(path), robots(path), Random(3)
    now = played.began
    played.seek(now)
    while now < played.index.ended:
        now += random.randint(1, SECOND)
        played.advance(now)
        sought.seek(now)
        for message in (view.snapshot, view.status, view.navigation, view.sweeps):
            assert message(played) == message(sought)


def test_a_snapshot_tells_what_was_decided_then(path: Path) -> None:
    (robot,) = robots(path)
    now = at(robot, 3.05)
    assert (now.mode, now.decided) == ("wander", ("0.2 m/s: wander",))
    assert now.driver == messages.Driver(None, "wander")
    assert now.commanded is not None
    assert (now.commanded.v, now.twist.v, now.battery.voltage) == (SPEED, SPEED, 12.5)
    assert at(robot, 8.55).driver == messages.Driver(None, "keyboard")
    assert at(robot, 15.0).driver is None


def test_the_outline_is_that_of_the_robot_that_answered_then(tmp_path: Path) -> None:
    log = LogFile(tmp_path / "a.mcap")
    log.add("model", [(0.0, load_model("amigo-sh")), (5.0, load_model("p3at-sh"))])
    log.add("snapshot", [(float(second), snapshot(float(second))) for second in range(10)])
    log.close()
    (robot,) = robots(log.path)
    shapes = []
    for second in (1.0, 6.0, 1.0):
        at(robot, second)
        shapes.append(view.listed(robot).shape)
    assert shapes[0] == shapes[2] != shapes[1]


def test_the_emergency_stop_is_latched_until_it_is_reset(path: Path) -> None:
    (robot,) = robots(path)
    latched = [at(robot, second).emergency_stop for second in (11.9, 12.1, 13.5, 14.1)]
    assert latched == [False, True, True, False]


def test_a_robot_that_stands_tells_why(path: Path) -> None:
    (robot,) = robots(path)
    assert at(robot, 3.0).why is None
    assert at(robot, 16.5).why == "The wheels are stalled: something blocks them."


def test_newer_logs_tell_it_in_the_words_of_that_time(tmp_path: Path) -> None:
    log = LogFile(tmp_path / "new.mcap")
    log.add("snapshot", [(0.0, snapshot(0.0, stalled=True))])
    log.add("standing", [(0.0, StandsBecause(STOPPED.about("ann stopped it")))])
    log.close()
    (robot,) = robots(tmp_path / "new.mcap")
    now = at(robot, 0.0)
    assert now.why == "Waiting for a fresh command: ann stopped it."
    assert now.standing is ReasonKind.STOPPED


def test_it_is_drawn_where_it_was_on_its_map(path: Path) -> None:
    (robot,) = robots(path)
    now = at(robot, 10.05)
    assert now.robot_in_map.x == pytest.approx(10.0 + SPEED * 10.0)
    assert now.target == messages.Target(15.0, 0.0, None, False)
    told = view.navigation(robot)
    assert told is not None
    assert (told.sure, told.place) == (True, "Kitchen")
    assert told.way == ((11.0, 0.0), (13.0, 0.0), (15.0, 0.0))
    assert at(robot, 12.5).target is None
    drawn = view.drawn_map(robot.told(MapUsed))
    assert drawn is not None
    assert drawn.walls.tolist() == WALLS.tolist()
    (sweep,) = view.sweeps(robot)
    assert sweep.ranges == (1000, 2000, 1000)
    assert sweep.sensor_in_map[0] == pytest.approx(12_600, abs=2)


def test_a_true_pose_counts_more_and_without_a_map_that_of_odometry(tmp_path: Path) -> None:
    (robot,) = robots(drive(tmp_path / "old.mcap"))
    assert at(robot, 5.0).robot_in_map.x == pytest.approx(SPEED * 5.0)
    assert (robot.told(MapUsed), view.navigation(robot)) == (None, None)
    log = LogFile(tmp_path / "true.mcap")
    log.add("snapshot", [(0.0, snapshot(0.0))])
    log.add("truth", [(0.0, truth(3.0))])
    log.close()
    (robot,) = robots(tmp_path / "true.mcap")
    assert at(robot, 0.0).robot_in_map.y == 5.0


def test_the_link_and_what_is_outside_of_the_log_are_told(path: Path) -> None:
    (robot,) = robots(path)
    at(robot, 5.0)
    assert view.status(robot).state is Connection.CONNECTED
    at(robot, 18.5)
    assert view.status(robot) == messages.Status(1, Connection.LOST, "no report for 2 s")
    robot.seek(BEGAN - SECOND)
    assert view.status(robot).message == "The log tells nothing of it then"
    assert view.snapshot(robot) is None


def test_its_events_are_found(path: Path) -> None:
    found = robots(path)
    finder = MarkFinder(found)
    marks = [mark for _, part in found[0].index.chunks(finder.topics) for mark in finder.look(part)]
    assert [(round(mark.at - BEGAN / SECOND), mark.kind, mark.text) for mark in marks] == [
        (2, "mode", "Wander began"),
        (8, "mode", "Wander ended"),
        (9, "mode", "Goto began"),
        (9, "goal", "Goal Kitchen, by ann"),
        (12, "emergency", "Emergency stop by ann"),
        (12, "goal", "Goal Kitchen given up: the emergency stop was pressed"),
        (14, "emergency", "Reset the emergency stop by ann"),
        (16, "stall", "The wheels stalled"),
        (18, "link", "Link lost: no report for 2 s"),
    ]
    assert {mark.robot for mark in marks} == {1}


def test_robots_of_one_log_have_their_names_and_marks(tmp_path: Path) -> None:
    log = LogFile(tmp_path / "two.mcap", "bob/")
    for name in ("bob", "amy"):
        log._prefix = f"{name}/"
        log.add("snapshot", [(0.0, snapshot(0.0)), (1.0, snapshot(1.0, stalled=name == "amy"))])
        log.event(0.5, "link", f"robot: lost: {name} is silent")
    log.close()
    amy, bob = robots(tmp_path / "two.mcap")
    assert (amy.name, bob.name) == ("amy", "bob")
    finder = MarkFinder([amy, bob])
    marks = [m for _, part in amy.index.chunks(finder.topics) for m in finder.look(part)]
    assert {(mark.robot, mark.text) for mark in marks} == {
        (amy.number, "Link lost: amy is silent"),
        (bob.number, "Link lost: bob is silent"),
        (amy.number, "The wheels stalled"),
    }
    bob.seek(BEGAN + SECOND)
    assert view.status(bob).message == "bob is silent"


@pytest.mark.parametrize("model", ["../../etc/passwd", "/etc/passwd", "x.toml", "spaceship", ""])
def test_no_file_is_read_because_a_log_names_it(tmp_path: Path, model: str) -> None:
    log = LogFile(tmp_path / "odd.mcap", model=model, limits="[1]", configuration='{"a":1}')
    log.add("snapshot", [(0.0, snapshot(0.0))])
    log.close()
    (robot,) = robots(tmp_path / "odd.mcap")
    assert isinstance(robot.info.model, UnknownModel)
    assert view.listed(robot).kind == "REPLAY"


def test_a_log_without_robots_says_so(tmp_path: Path) -> None:
    log = LogFile(tmp_path / "none.mcap")
    log.event(0.0, "clock", "it was set")
    log.close()
    with pytest.raises(ConfigError, match="no robot was connected"):
        robots(tmp_path / "none.mcap")


def test_a_map_that_is_none_is_not_drawn() -> None:
    assert view.drawn_map(MapUsed(name="x", file="", sha256="", text="P5 no map")) is None
    assert view.drawn_map(None) is None


def test_a_mode_that_is_no_text_is_none(path: Path) -> None:
    found = MarkFinder(robots(path))
    for mode in (b"\x80ander", b"wander\\"):
        decision = LogMessage(BEGAN, "decision", b'{"mode":"' + mode + b'"}')
        (mark,) = found.look([decision])
        assert mark.text == " began"


@pytest.mark.parametrize("own", ["this is no TOML", 'like = "p3at-sh"\nserial_number = "B"\n'])
def test_an_own_file_that_is_wrong_or_of_another_robot_spoils_no_log(own: str) -> None:
    path = own_path("rosalind")
    assert path is not None
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(own, encoding="utf-8")
    try:
        config = msgspec.json.encode(Config(family="Pioneer", model="p3dx-sh", serial_number="A"))
        texts = {"name": "rosalind", "model": "p3dx-sh", "configuration": config.decode()}
        assert described(texts).model == load_model("p3dx-sh")
    finally:
        path.unlink()
