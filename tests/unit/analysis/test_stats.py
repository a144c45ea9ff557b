"""The figures of a run are those of its messages, for each robot."""

from dataclasses import replace
from math import pi
from pathlib import Path

import pytest

import pioneer3
from pioneer3.analysis.stats import NOT_TOLD, RobotStats, stats_of
from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2, Twist2
from pioneer3.log.topics import LogTopic
from pioneer3.robot.explain import IDLE, STALLED, STOPPED
from pioneer3.runtime.recording import (
    EMERGENCY_STOP,
    CommandGiven,
    DecisionMade,
    StandsBecause,
)
from pioneer3.state import Battery, Bumpers, LinkQuality, Motors, Odometry, Snapshot
from tests.unit.analysis.support import (
    LAG,
    Message,
    decided,
    driven,
    given,
    snapshot,
    topic,
    write_log,
)

SNAPSHOTS = topic("snapshot", Snapshot)
REASONS = topic("standing", StandsBecause)


def figures(path: Path, *messages: Message) -> RobotStats:
    (found,) = stats_of(pioneer3.log.open(write_log(path / "a.mcap", messages)))
    return found


def test_the_way_and_the_time_under_way_are_those_of_odometry(tmp_path: Path) -> None:
    standing = [(3.0 + n / 10, SNAPSHOTS, snapshot(3.0 + n / 10, x=1.0)) for n in range(10)]
    found = figures(tmp_path, *driven(2.0, v=0.5), *standing)
    assert (found.robot, found.reports) == ("bob", 31)
    assert found.distance == pytest.approx(1.0)
    assert found.under_way == pytest.approx(2.0)
    assert found.fastest == 0.5
    assert found.stops == {NOT_TOLD: 1}


def test_turns_add_up_over_the_seam_of_headings(tmp_path: Path) -> None:
    def turned(number: int) -> Message:
        at = snapshot(number / 10)
        pose = Pose2(0.0, 0.0, pi / 2 * number)
        odometry = Odometry(
            robot_in_odom=pose, twist=Twist2(0.0, 1.0), left_speed=0.0, right_speed=0.0
        )
        return number / 10, SNAPSHOTS, replace(at, odometry=odometry)

    assert figures(tmp_path, *map(turned, range(9))).turned == pytest.approx(4 * pi)


def test_odometry_that_begins_anew_is_no_way(tmp_path: Path) -> None:
    messages = [(n / 10, SNAPSHOTS, snapshot(n / 10, x=1000.0 * (n > 5))) for n in range(10)]
    assert figures(tmp_path, *messages).distance == 0.0


def test_stops_are_counted_by_what_people_were_told(tmp_path: Path) -> None:
    told = [IDLE.about(""), None, STALLED, STOPPED.about("x"), None, STALLED, None, IDLE.about("")]
    reasons = [(n / 10, REASONS, StandsBecause(each)) for n, each in enumerate(told)]
    found = figures(tmp_path, *reasons, *driven(1.0))
    assert found.stops == {STALLED.text: 2, IDLE.about("").text: 1}


def test_stalls_bumps_stops_and_losses_are_counted_as_they_begin(tmp_path: Path) -> None:
    stalled, pressed = Motors(right_stalled=True), Motors(stop_button=True)
    bumped, touched = Bumpers(front=(True,)), Bumpers(rear=(False, True))
    commands = topic("command", CommandGiven)
    messages = [
        (0.1, SNAPSHOTS, snapshot(0.1)),
        (0.2, SNAPSHOTS, snapshot(0.2, motors=stalled, bumpers=bumped)),
        (0.3, SNAPSHOTS, snapshot(0.3, motors=stalled, bumpers=touched)),
        (0.4, SNAPSHOTS, snapshot(0.4, motors=pressed, link=LinkQuality(sessions=2))),
        (0.5, SNAPSHOTS, snapshot(0.5, motors=stalled, link=LinkQuality(sessions=4))),
        (0.6, commands, given("", EMERGENCY_STOP)),
        (0.7, commands, given("", EMERGENCY_STOP, refused="no")),
        (0.8, SNAPSHOTS, snapshot(0.8, battery=Battery(voltage=11.0))),
    ]
    found = figures(tmp_path, *messages)
    counts = found.stalls, found.bumps, found.emergency_stops, found.link_losses
    assert counts == (2, 1, 2, 3)
    assert found.voltage == (12.5, 11.0)


def test_the_slowest_answer_is_from_a_report_to_its_own_decision(tmp_path: Path) -> None:
    decisions, wire = topic("decision", DecisionMade), LogTopic("wire/robot/out", bytes)
    messages = [
        (0.1 + LAG, SNAPSHOTS, snapshot(0.1)),
        (0.1 + 2 * LAG, decisions, decided("", 0.1)),
        (0.1 + 3 * LAG, wire, b"x"),
        (0.2 + LAG, SNAPSHOTS, snapshot(0.2)),
        (0.29, decisions, decided("", 0.2)),  # of an input: long after the report
        (0.29, wire, b"x"),
    ]
    found = figures(tmp_path, *messages)
    assert found.report_to_decision == pytest.approx(0.02)
    assert found.report_to_wire == pytest.approx(0.03)


def test_each_robot_has_its_own_figures(tmp_path: Path) -> None:
    messages = [*driven(1.0, "amy/"), *driven(2.0, "bob/")]
    path = write_log(tmp_path / "a.mcap", messages, robots={"amy/": "", "bob/": ""})
    found = stats_of(pioneer3.log.open(path))
    assert [(each.robot, each.reports) for each in found] == [("amy", 11), ("bob", 21)]


def test_a_log_without_a_report_has_no_figures(tmp_path: Path) -> None:
    found = figures(tmp_path)
    assert found == RobotStats(robot="bob")


def test_a_damaged_message_is_told(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"a\.mcap: is damaged"):
        figures(tmp_path, (0.1, topic("snapshot", CommandGiven), given("", "drive")))
