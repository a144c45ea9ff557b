"""`pioneer3 fleet`: files are written with consent, tables and JSON show the same."""

import io
import json
from pathlib import Path

import pytest

from pioneer3.cli.main import execute
from pioneer3.fleet.inventory import read_fleet
from tests.e2e.processes import free_port


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Work in a folder, and home, of the test's own."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    for name in ("PIONEER3_FLEET", "ROS_MASTER_URI"):
        monkeypatch.delenv(name, raising=False)
    return tmp_path


def answers(monkeypatch: pytest.MonkeyPatch, *lines: str) -> None:
    monkeypatch.setattr("sys.stdin", io.StringIO("".join(f"{line}\n" for line in lines)))


def test_a_script_writes_a_fleet_without_being_asked(folder: Path) -> None:
    words = ["fleet", "init", "p3at-1=10.0.0.1", "p3at-2=10.0.0.2", "--ros", "1"]
    assert execute([*words, "--operator", "laptop=10.0.0.9", "--yes"]) == 0
    fleet = read_fleet(folder / "fleet.toml")
    assert [(robot.name, robot.address, robot.ros) for robot in fleet.robots] == [
        ("p3at-1", "10.0.0.1", "1"),
        ("p3at-2", "10.0.0.2", "1"),
    ]
    assert (fleet.operator.name, fleet.operator.address) == ("laptop", "10.0.0.9")


def test_robots_without_ros_get_a_bridge(folder: Path) -> None:
    assert execute(["fleet", "init", "p3at-1=10.0.0.1", "--yes"]) == 0
    assert read_fleet(folder / "fleet.toml").robots[0].endpoint == ("10.0.0.1", 8101)


def test_a_person_is_asked_for_all_of_it(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    answers(monkeypatch, "robot", "", "1", "p3at-1=10.0.0.1", "", "laptop", "10.0.0.9")
    assert execute(["fleet", "init"]) == 0
    fleet = read_fleet(folder / "fleet.toml")
    assert (fleet.operator.name, fleet.defaults.user, fleet.defaults.ros) == (
        "laptop",
        "robot",
        "1",
    )
    assert [robot.name for robot in fleet.robots] == ["p3at-1"]


def test_a_wrong_robot_is_told_at_once_and_asked_for_again(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    robots = ("p3at-1", "p3at-1=10.0.0", "p3at-1=10.0.0.1", "p3at-2=10.0.0.1", "p3at-2=10.0.0.2")
    answers(monkeypatch, "", "", "", *robots, "", "laptop", "10.0.0.9")
    assert execute(["fleet", "init"]) == 0
    fleet = read_fleet(folder / "fleet.toml")
    assert [robot.address for robot in fleet.robots] == ["10.0.0.1", "10.0.0.2"]
    told = capsys.readouterr().err
    assert "expected NAME=ADDRESS" in told
    assert "expected an IP address" in told
    assert "10.0.0.1 is robot[0]'s already; each robot has a computer of its own" in told
    assert "127.0.0.2, ..., and `pioneer3 sim --fleet FILE` starts them" in told


def test_a_file_that_is_there_is_never_lost(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    mine = folder / "fleet.toml"
    mine.write_text("# mine\n")
    assert execute(["fleet", "init", "a=10.0.0.1", "--yes"]) == 2
    assert "fleet.toml: it is there already" in capsys.readouterr().err
    answers(monkeypatch, "", "", "", "", "l", "10.0.0.9", "no")
    assert execute(["fleet", "init", "a=10.0.0.1"]) == 1
    assert mine.read_text() == "# mine\n"
    answers(monkeypatch, "", "", "", "", "l", "10.0.0.9", "yes")
    assert execute(["fleet", "init", "a=10.0.0.1"]) == 0
    assert [robot.name for robot in read_fleet(mine).robots] == ["a"]
    assert (folder / "fleet.toml.before-fleet-1").read_text() == "# mine\n"
    assert "-# mine" in capsys.readouterr().out


def test_what_is_wrong_is_refused_before_anything_is_written(folder: Path) -> None:
    assert execute(["fleet", "init", "p3at_1=10.0.0.1", "--yes"]) == 2
    assert execute(["fleet", "init", "p3at-1", "--yes"]) == 2
    assert list(folder.iterdir()) == []


def test_without_a_file_the_way_to_make_one_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    assert execute(["fleet", "list"]) == 2
    assert "make one with pioneer3 fleet init" in capsys.readouterr().err
    Path("fleet.toml").touch()
    assert execute(["fleet", "list"]) == 2
    assert "fleet.toml: it has no robot yet" in capsys.readouterr().err


@pytest.mark.realtime
def test_the_list_shows_file_and_answers(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    text = f'[[robot]]\nname = "a"\naddress = "127.0.0.1"\nport = "tcp://a:{free_port()}"\n'
    (folder / "fleet.toml").write_text(text)
    assert execute(["fleet", "list", "--timeout", "2"]) == 0
    head, row = capsys.readouterr().out.splitlines()
    assert head.split() == ["name", "address", "port", "up", "ssh", "driver"]
    assert row.split()[-1] == "refused"
    assert execute(["fleet", "list", "--offline", "--json"]) == 0
    (listed,) = json.loads(capsys.readouterr().out)
    assert (listed["robot"]["name"], listed["live"]) == ("a", None)
    assert execute(["fleet", "list", "a", "--json", "--timeout", "2"]) == 0
    (listed,) = json.loads(capsys.readouterr().out)
    assert listed["live"]["driver"] == {"ok": False, "said": "refused"}
    assert execute(["fleet", "list", "b"]) == 2
    assert "no robot 'b', known are a" in capsys.readouterr().err


def test_ssh_finds_the_robots_after_apply_and_a_second_time_changes_nothing(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "fleet.toml").write_text('[[robot]]\nname = "a"\naddress = "10.0.0.1"\n')
    ssh = folder / "home/.ssh"
    assert execute(["fleet", "ssh-config"]) == 0
    assert not ssh.exists()
    assert "Host a\n    HostName 10.0.0.1" in capsys.readouterr().out
    assert execute(["fleet", "ssh-config", "--apply"]) == 0
    assert (ssh / "config").read_text() == "Include config.d/pioneer3\n"
    assert (ssh / "config").stat().st_mode & 0o777 == 0o600
    assert ssh.stat().st_mode & 0o777 == 0o700
    assert "Host a" in (ssh / "config.d/pioneer3").read_text()
    assert "+Host a" in capsys.readouterr().out
    assert execute(["fleet", "ssh-config", "--apply"]) == 0
    assert capsys.readouterr().out.count("is so already") == 2


def test_aliases_are_printed_and_written(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "fleet.toml").write_text('[[robot]]\nname = "a"\naddress = "10.0.0.1"\n')
    assert execute(["fleet", "aliases"]) == 0
    assert capsys.readouterr().out == "alias CR_1='ssh pioneer@10.0.0.1'\n"
    start = folder / "bashrc"
    start.write_text("# mine\n")
    assert execute(["fleet", "aliases", "--apply", "--file", str(start)]) == 0
    assert start.read_text().startswith("# mine\n")
    assert "alias CR_1=" in start.read_text()
    assert execute(["fleet", "aliases", "--prefix", "a b"]) == 2


def test_names_are_checked_printed_and_written(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "fleet.toml").write_text('[[robot]]\nname = "a"\naddress = "10.0.0.1"\n')
    names = folder / "hosts"
    names.write_text("127.0.1.1 a\n")
    words = ["fleet", "hosts", "--file", str(names), "--name", "a"]
    assert execute(words) == 1
    said = capsys.readouterr()
    assert said.out == "10.0.0.1\ta\n"
    assert "line 1: a means this computer itself" in said.err
    assert execute([*words, "--apply"]) == 0
    assert names.read_text().startswith("# 127.0.1.1 a\n")
    assert execute(words) == 0


def test_a_keyboard_for_all_needs_a_terminal(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert execute(["fleet", "init", "p3at-1=10.0.0.1", "--yes"]) == 0
    assert execute(["fleet", "drive"]) == 2
    assert "needs a terminal" in capsys.readouterr().err


def test_who_was_not_stopped_is_named(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rows = (
        '[[robot]]\nname = "off"\naddress = "127.0.0.2"\n'
        f'port = "tcp://127.0.0.1:{free_port()}"\n'
        '[[robot]]\nname = "far"\naddress = "192.0.2.1"\n'
    )
    (folder / "fleet.toml").write_text(rows, "utf-8")
    assert execute(["fleet", "stop", "--timeout", "1"]) == 3
    told = capsys.readouterr().out
    assert "off    NOT REACHED" in told
    assert "nobody listens there" in told
    assert "a device of far (192.0.2.1) and not of this computer" in told
    assert "2 of 2 robots may still move" in told
    assert execute(["fleet", "stop", "off", "--json"]) == 3
    (answer,) = json.loads(capsys.readouterr().out)
    assert (answer["robot"], answer["ok"], answer["reached"]) == ("off", False, False)
