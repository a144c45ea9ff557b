"""`pioneer3 ros2 bridge` as it is typed, without a network."""

import json
from pathlib import Path

import pytest

from pioneer3.cli.main import Exit, execute


def said(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, str, str]:
    code = execute(["ros2", "bridge", *words])
    out, err = capsys.readouterr()
    return code, out, err


def test_the_table_is_listed_as_lines_and_as_json(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = said(capsys, "--list")
    assert code == Exit.OK
    assert "ROS 1 /RosAria/pose <- ROS 2 /odom (nav_msgs/Odometry)" in out.splitlines()
    assert any(line.startswith("service ROS 1 /RosAria/enable_motors") for line in out.splitlines())
    _, out, _ = said(capsys, "--json", "--only", "tf_static", "--namespace", "robot1")
    table = json.loads(out)
    assert [(row["ros1"], row["ros2"], row["latched"]) for row in table["topics"]] == [
        ("/tf_static", "/robot1/tf_static", True)
    ]
    assert table["services"] == []


@pytest.mark.parametrize(
    ("words", "problem"),
    [
        (("--robot-in", "ros3"), "--robot-in is ros1 or ros2, not 'ros3'"),
        (("--profile", "lab"), "--profile is compatibility, standard or both, not 'lab'"),
        (("--profile", "ros2"), "--profile is compatibility, standard or both"),
        (("--only", "odm"), "no row is called 'odm', did you mean odom?"),
        (("--to-ros1", "/joy"), "a topic to bridge is such as /joy:sensor_msgs/Joy"),
        (("--namespace", "1robot"), "'1robot' is no namespace in ROS 2"),
        (("--ros1-node", "Ros Aria"), "'Ros Aria' is no name of a node"),
        (("--distro", "hydro"), "ROS 2 has no distribution 'hydro'"),
    ],
)
def test_options_that_are_wrong_are_told_in_a_line(
    capsys: pytest.CaptureFixture[str], words: tuple[str, ...], problem: str
) -> None:
    code, _, err = said(capsys, "--list", *words)
    assert code == Exit.USAGE
    assert problem in err
    assert err.count("\n") == 1


def test_a_wrong_file_is_told_by_file_line_and_key(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    path = tmp_path / "topics.toml"
    path.write_text('[[topic]]\nros1 = "/joy"\nway = "to_ros2"\ntype = "sensor_msgs/Joi"\n')
    code, _, err = said(capsys, "--list", "--topics", str(path))
    assert code == Exit.USAGE
    assert err.startswith(f"pioneer3: {path}:4: topic[0].type: ")
    path.unlink()
    code, _, err = said(capsys, "--list", "--topics", str(path))
    assert code == Exit.USAGE
    assert "topics.toml" in err


def test_a_master_that_is_none_and_a_timeout_that_is_too_short_end_it_at_once(
    capsys: pytest.CaptureFixture[str],
) -> None:
    code, _, err = said(capsys, "--master", "lab")
    assert code == Exit.USAGE
    assert "such as http://robot:11311, not lab" in err
    code, _, err = said(capsys, "--cmd-vel-timeout", "0.01")
    assert code == Exit.USAGE
    assert "at least 0.1 s, not 0.01" in err
