"""Readings of a log are arrays with named columns of one dimension each, in SI units."""

from math import inf, isfinite, nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pioneer3
from pioneer3.analysis.arrays import MOST_NUMBERED, TABLES, TIME
from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.log import OpenLog
from pioneer3.navigation.recording import EstimateMade
from pioneer3.runtime.recording import CommandGiven, DecisionMade, TruePoseTold
from pioneer3.state import Battery, Bumpers, Charging, Motors, Scan, Snapshot, Sonar
from tests.unit.analysis.support import (
    Message,
    decided,
    driven,
    given,
    scan,
    snapshot,
    topic,
    write_log,
)

SNAPSHOTS = topic("snapshot", Snapshot)
LASER = topic("scan/laser", Scan, steady="angles")


def opened(path: Path, *messages: Message) -> OpenLog:
    return pioneer3.log.open(write_log(path / "a.mcap", messages))


def test_odometry_has_a_line_for_each_snapshot_at_its_time(tmp_path: Path) -> None:
    array = opened(tmp_path, *driven(2.0, v=0.5)).array("odometry")
    assert array["time"] == pytest.approx(np.arange(21) * 0.1)
    assert array["x"] == pytest.approx(np.arange(21) * 0.05)
    assert set(array["v"]) == {0.5}
    assert array.dtype.names == ("time", "x", "y", "heading", "v", "w", "left_speed", "right_speed")


def test_every_array_is_there_and_empty_where_nothing_was_logged(tmp_path: Path) -> None:
    log = opened(tmp_path)
    for name in [*(table.name for table in TABLES if table.name != "event"), "scan", "scan/laser2"]:
        array = log.array(name)
        assert (array.shape, array.dtype.names[0]) == ((0,), TIME.name)
    assert log.array("event")["text"].tolist() == ["robot: connected"]
    with pytest.raises(ConfigError, match="no array 'odom'; there are: odometry, battery, "):
        log.array("odom")


def test_all_columns_have_one_dimension_as_data_frames_want_it(tmp_path: Path) -> None:
    log = opened(tmp_path, *driven(1.0), (0.5, LASER, scan(0.4)))
    for name in [*(table.name for table in TABLES), "scan"]:
        array = log.array(name)
        assert {array[column].ndim for column in array.dtype.names} == {1}


def test_what_is_not_known_is_nan(tmp_path: Path) -> None:
    messages = [
        (0.1, SNAPSHOTS, snapshot(0.1, sonar=Sonar(ranges=(1.0,)))),
        (0.2, SNAPSHOTS, snapshot(0.2, sonar=Sonar(ranges=(inf, nan, 3.0)))),
        (0.3, SNAPSHOTS, snapshot(0.3, battery=Battery(voltage=12.0, charge=0.5, low=True))),
    ]
    log = opened(tmp_path, *messages)
    sonar, battery = log.array("sonar"), log.array("battery")
    assert sonar.dtype.names == ("time", "range_0", "range_1", "range_2")
    np.testing.assert_equal(sonar["range_0"], [1.0, inf, nan])
    np.testing.assert_equal(sonar["range_2"], [nan, 3.0, nan])
    np.testing.assert_equal(battery["charge"], [nan, nan, 0.5])
    assert battery["low"].tolist() == [False, False, True]
    assert set(battery["charging"]) == {Charging.UNKNOWN}


def test_stalls_and_contacts_are_truth_values(tmp_path: Path) -> None:
    parts: dict[str, Any] = {
        "motors": Motors(left_stalled=True),
        "bumpers": Bumpers(rear=(False, True)),
    }
    messages = [(0.1, SNAPSHOTS, snapshot(0.1)), (0.2, SNAPSHOTS, snapshot(0.2, **parts))]
    array = opened(tmp_path, *messages).array("motors")
    assert array[["left_stalled", "right_stalled", "bumped"]].tolist() == [
        (False, False, False),
        (True, False, True),
    ]


def test_decisions_and_commands_tell_who_wanted_which_speed(tmp_path: Path) -> None:
    log = opened(
        tmp_path,
        (0.5, topic("command", CommandGiven), given("keyboard", "drive", 0.4, "it is latched")),
        (0.6, topic("decision", DecisionMade), decided("wander", 0.3)),
    )
    (command,), (decision,) = log.array("command"), log.array("decision")
    assert command.tolist() == (0.5, "keyboard", "drive", 0.4, 0.0, 0.5, "it is latched")
    assert decision.tolist() == (0.6, "wander", 0.3, 0.0, "", "")


def test_the_place_on_a_map_is_nan_where_nothing_is_known(tmp_path: Path) -> None:
    estimates, truths = topic("estimate", EstimateMade), topic("truth", TruePoseTold)
    lost = EstimateMade(map="office", robot_in_map=None, odom_in_map=None, sure=False)
    found = EstimateMade(
        map="office", robot_in_map=Pose2(1.0, 2.0, 0.5), odom_in_map=None, sure=True, spread=0.1
    )
    true = TruePoseTold(Pose2(1.1, 2.0, 0.5))
    log = opened(tmp_path, (0.1, estimates, lost), (0.6, estimates, found), (0.7, truths, true))
    array = log.array("estimate")
    np.testing.assert_equal(array["x"], [nan, 1.0])
    assert array[1].tolist() == (0.6, 1.0, 2.0, 0.5, True, 0.1, "office")
    assert log.array("truth").tolist() == [(0.7, 1.1, 2.0, 0.5)]
    assert next(log.messages("estimate"))[1].robot_in_map is None


@pytest.mark.parametrize("beam_time", [0.01, -0.01, 0.0])
def test_a_scan_has_a_line_for_each_reading_where_its_echo_was(
    tmp_path: Path, beam_time: float
) -> None:
    moved = scan(0.4, beam_time=beam_time, last_in_odom=Pose2(1.1, 0.1, 3.0))
    array = opened(tmp_path, (0.5, LASER, moved), (0.6, LASER, scan(0.5))).array("scan")
    assert array["time"][:3] == pytest.approx([0.4, 0.4 + beam_time, 0.4 + 2 * beam_time])
    np.testing.assert_equal(array["range"][:3], moved.ranges)
    echoes = array[np.isfinite(array["x"])]
    expected = [point for each in (moved, scan(0.5)) for point in each.points_in_odom()]
    assert np.array(echoes[["x", "y"]].tolist()) == pytest.approx(np.array(expected))
    assert len(array) == 6
    assert [isfinite(each) for each in array["range"]] == [True, False, True] * 2


def test_a_robot_with_a_thousand_sonars_is_damage(tmp_path: Path) -> None:
    wide = snapshot(0.1, sonar=Sonar(ranges=(1.0,) * (MOST_NUMBERED + 1)))
    with pytest.raises(ConfigError, match="is damaged: sonar of 65 columns"):
        opened(tmp_path, (0.1, SNAPSHOTS, wide)).array("sonar")
