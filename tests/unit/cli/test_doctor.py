"""`pioneer3 doctor`: findings on stdout, the outcome in the exit code."""

import json

import pytest

from pioneer3.cli.diagnosis import doctor
from pioneer3.cli.options import RobotOptions
from pioneer3.cli.tables import verdict
from pioneer3.doctor.facts import Finding, Level


def test_a_port_that_is_not_there_ends_with_3_and_says_what_to_do(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert doctor(which=RobotOptions(port="/dev/no-such-port")) == 3
    out = capsys.readouterr().out
    assert "FAIL  port" in out
    assert "→ Plug it in, then run: p3 find-port" in out
    assert "Mend first: port." in out


def test_json_is_all_there_is_on_stdout(capsys: pytest.CaptureFixture[str]) -> None:
    assert doctor(which=RobotOptions(port="/dev/no-such-port"), json=True) == 3
    report = json.loads(capsys.readouterr().out)
    assert report["exit_code"] == 3
    assert [finding["level"] for finding in report["findings"]] == ["fail"]


def test_a_wrong_variable_of_ros_is_told_with_the_right_value(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_MASTER_URI", "robot:11311")
    assert doctor(which=RobotOptions(port="/dev/no-such-port")) == 3
    out = capsys.readouterr().out
    assert "warn  ROS 1" in out
    assert "export ROS_MASTER_URI=http://robot:11311" in out


@pytest.mark.parametrize(
    ("levels", "words"),
    [
        ([Level.OK], "All fine."),
        ([Level.OK, Level.WARN], "It works; 1 thing to look at."),
        ([Level.WARN, Level.WARN], "It works; 2 things to look at."),
        ([Level.WARN, Level.FAIL], "Mend first: check 1."),
    ],
)
def test_the_sum_of_it_is_one_line(levels: list[Level], words: str) -> None:
    findings = [
        Finding(check=f"check {number}", level=level, found="")
        for number, level in enumerate(levels)
    ]
    assert verdict(findings).plain.strip() == words
