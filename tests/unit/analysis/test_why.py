"""Why a robot stood is told by its log, or by its readings where the log is older."""

from pathlib import Path

import pytest

import pioneer3
from pioneer3.analysis.why import GONE, MomentTold, told_at
from pioneer3.behaviors.action import Contribution
from pioneer3.log.topics import EVENT, LogEvent
from pioneer3.robot.explain import IDLE, PRESSED, STALLED, STOPPED, Reason
from pioneer3.runtime.recording import CommandGiven, DecisionMade, StandsBecause
from pioneer3.state import Motors, Snapshot
from tests.unit.analysis.support import (
    BEGAN,
    SECOND,
    Message,
    decided,
    driven,
    given,
    snapshot,
    topic,
    write_log,
    write_parts,
)

SNAPSHOTS = topic("snapshot", Snapshot)
DECISIONS = topic("decision", DecisionMade)
REASONS = topic("standing", StandsBecause)
BLOCKED = STOPPED.about("the wheels stalled")


def at(path: Path, time: float, *messages: Message) -> MomentTold:
    return told_at(pioneer3.log.open(write_log(path / "a.mcap", messages)), time)


def standing(seconds: float, **motors: bool) -> Message:
    return seconds, SNAPSHOTS, snapshot(seconds, motors=Motors(**motors))


def test_the_reason_is_the_one_that_was_logged_last(tmp_path: Path) -> None:
    messages = [
        (0.1, REASONS, StandsBecause(IDLE.about(""))),
        (0.5, REASONS, StandsBecause(BLOCKED)),
        (0.9, REASONS, StandsBecause(None)),
        *(standing(time / 10, enabled=True) for time in range(12)),
    ]
    log = pioneer3.log.open(write_log(tmp_path / "a.mcap", messages))
    found = [told_at(log, time) for time in (0.2, 0.5, 0.8, 0.95)]
    assert [each.stands for each in found] == [IDLE.about(""), BLOCKED, BLOCKED, None]
    assert all(each.was_told for each in found)


@pytest.mark.parametrize(
    ("motors", "reason"),
    [
        ({"enabled": True}, IDLE.about("")),
        ({}, IDLE.about(", and the motors are off")),
        ({"enabled": True, "left_stalled": True}, STALLED),
        ({"stop_button": True, "left_stalled": True}, PRESSED),
    ],
)
def test_readings_tell_the_reason_where_none_was_logged(
    tmp_path: Path, motors: dict[str, bool], reason: Reason
) -> None:
    told = at(tmp_path, 0.3, standing(0.2, **motors))
    assert (told.stands, told.was_told) == (reason, False)


def test_a_decision_to_stand_is_told_with_the_limit_that_took_the_speed(tmp_path: Path) -> None:
    wants = Contribution("wander", "v", 0.3, 1.0, "onwards")
    limit = Contribution("limiter", "v_max", 0.0, 1.0, "0.20 m ahead")
    told = at(
        tmp_path,
        0.6,
        (0.1, DECISIONS, decided("", 0.0)),
        (0.3, DECISIONS, decided("wander", 0.3, wants)),
        (0.5, DECISIONS, decided("wander", 0.0, limit, wants)),
        (0.7, DECISIONS, decided("other", 0.0)),
        standing(0.55, enabled=True),
    )
    assert str(told.stands) == "It stands because of limiter, 0.20 m ahead."
    assert [part.took for part in told.parts] == ["0.30 m/s", ""]
    assert told.decision is not None
    assert (told.decision[1].mode, told.mode_since) == ("wander", 0.3)


def test_a_robot_that_fell_silent_is_told_by_its_link(tmp_path: Path) -> None:
    lost = LogEvent("link", "robot: lost: unplugged")
    messages = [*driven(1.0), (2.5, EVENT, lost), (4.0, EVENT, LogEvent("page", "ann came"))]
    log = pioneer3.log.open(write_log(tmp_path / "a.mcap", messages))
    assert told_at(log, 0.9).stands is None
    assert str(told_at(log, 2.0).stands).startswith("The robot has said nothing for 1.0 s")
    assert str(told_at(log, 3.0).stands) == "No robot is connected: robot: lost: unplugged."


def test_a_file_that_has_gone_is_told_in_place_of_a_robot_that_fell_silent(tmp_path: Path) -> None:
    first, _ = write_parts(tmp_path, seconds=6.0, gone=25)  # from 2.0 s to 4.6 s
    log = pioneer3.log.open(first)
    stands = [told_at(log, time).stands for time in (1.9, 2.1, 4.5, 4.7)]
    assert stands == [None, GONE, GONE, None]
    (gap,) = log.info().gaps
    assert [(each - BEGAN) / SECOND for each in gap] == pytest.approx([2.01, 4.61])


def test_before_the_first_report_nothing_is_known_but_the_link(tmp_path: Path) -> None:
    told = at(tmp_path, 0.0, *driven(1.0))
    assert str(told.stands) == "No robot is connected: robot: connected."
    assert (told.snapshot, told.decision, told.command, told.parts) == (None, None, None, ())


def test_the_command_before_is_told(tmp_path: Path) -> None:
    commands = topic("command", CommandGiven)
    first, second = given("keyboard", "drive", 0.4), given("keyboard", "let go")
    told = at(tmp_path, 0.5, (0.2, commands, first), (0.8, commands, second), *driven(1.0))
    assert told.command == (0.2, first)
