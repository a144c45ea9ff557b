"""The service of this computer: its unit, what is said of ports, and what is refused."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from pioneer3.cli.main import execute
from pioneer3.errors import ConfigError
from pioneer3.fleet import service
from pioneer3.fleet.service import PAUSES, LocalService, check_ports, unit_here

RUN = ["run", "--port", "/dev/ttyUSB0"]


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a home where systemd seems to run, and no unit of the system is."""
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setattr(service, "BOOTED", tmp_path)
    monkeypatch.setattr(service, "WITH_ROOT", str(tmp_path / "system.service"))
    return tmp_path


def test_the_unit_runs_the_command_as_it_was_typed_from_this_folder() -> None:
    environment = {"PIONEER3_LASER": "/dev/a b", "ROS_MASTER_URI": "http://x:11311", "HOME": "/x"}
    lines = unit_here(RUN, with_root=False, environment=environment).text().splitlines()
    assert lines[0] == "# Written by: pioneer3 setup service"
    assert f"ExecStart={sys.executable} -m pioneer3 run --port /dev/ttyUSB0" in lines
    assert 'Environment="PIONEER3_LASER=/dev/a b"' in lines
    assert f"WorkingDirectory={Path.cwd()}" in lines
    assert {"Restart=always", "WantedBy=default.target"} <= set(lines)
    assert not any(word in "".join(lines) for word in ("ROS_", "User=", "HOME", "--lan"))


def test_a_node_of_ros_keeps_the_variables_of_this_terminal() -> None:
    environment = {"ROS_MASTER_URI": "http://10.0.0.9:11311", "SUDO_USER": "pi"}
    text = unit_here(["ros1"], with_root=True, environment=environment).text()
    assert "Environment=ROS_MASTER_URI=http://10.0.0.9:11311\n" in text
    assert "User=pi\nSupplementaryGroups=dialout\n" in text


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "one of run, ros1, ros2, bridge: none is given"),
        (["wander"], "'wander' is none of them"),
        (["run", "--record", "x.bin"], "--record: a service starts again"),
        (["run", "--prot", "x"], "--prot"),
        (["run", "--status"], "'run': --status and --remove take no command"),
    ],
)
def test_what_cannot_go_on_is_refused(
    words: list[str], said: str, home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert execute(["setup", "service", *words]) == 2
    assert said in capsys.readouterr().err
    assert list(home.iterdir()) == []


def test_ros_arguments_come_through(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["ros2", "--ros-args", "-r", "a:=b"]
    assert execute(["setup", "service", "--print", *words]) == 0
    assert "-m pioneer3 ros2 --ros-args -r a:=b\n" in capsys.readouterr().out


def test_ports_are_looked_at_first() -> None:
    words = ["run", "--port=/dev/ttyUSB97", "--laser", "lms-200@/dev/ttyACM98"]
    found = [(each.check, each.found) for each in check_ports(words, with_root=False, runs=False)]
    assert found == [
        ("port", "/dev/ttyUSB97 does not exist"),
        ("name", "/dev/ttyUSB97 may have another number after a start"),
        ("port", "/dev/ttyACM98 does not exist"),
        ("name", "/dev/ttyACM98 may have another number after a start"),
    ]
    assert not list(check_ports(["run", "--port", "tcp://a:1"], with_root=False, runs=False))


def test_the_service_of_fleet_deploy_stays(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    unit = home / ".config/systemd/user/pioneer3.service"
    unit.parent.mkdir(parents=True)
    unit.write_text("# Written by: pioneer3 fleet deploy\n")
    disable = f"systemctl --user disable --now pioneer3 && rm {unit}"
    for words in (["run"], ["--remove"]):
        assert execute(["setup", "service", *words]) == 2
        assert disable in capsys.readouterr().err
    assert unit.read_text() == "# Written by: pioneer3 fleet deploy\n"


def test_one_computer_has_one_service(home: Path) -> None:
    there = LocalService(with_root=True)
    there.path.write_text(unit_here(RUN, with_root=True, environment={}).text())
    with pytest.raises(ConfigError, match=r"remove it first: sudo \S*pioneer3 setup service --rem"):
        LocalService(with_root=False).install(unit_here(RUN, with_root=False, environment={}))


def test_without_systemd_the_unit_is_shown_and_nothing_installed(
    home: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(service, "BOOTED", home / "nowhere")
    assert execute(["setup", "service", "run"]) == 2
    assert "systemd does not run this system" in capsys.readouterr().err
    assert execute(["setup", "service", "--status"]) == 1
    assert execute(["setup", "service", "--remove"]) == 0
    assert execute(["setup", "service", "--print", "run"]) == 0
    assert "ExecStart=" in capsys.readouterr().out
    assert list(home.iterdir()) == []


def test_who_is_not_root_is_told_the_command(home: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "geteuid", lambda: 1000)
    monkeypatch.setattr(sys, "argv", ["pioneer3", "setup", "service", "--system", "run"])
    unit = unit_here(["run"], with_root=True, environment={})
    with pytest.raises(PermissionError, match=r"sudo \S*pioneer3 setup service --system run"):
        LocalService(with_root=True).install(unit)


@pytest.mark.realtime
@pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="no systemd-analyze here")
@pytest.mark.parametrize("with_root", [True, False])
def test_systemd_takes_the_unit_and_knows_its_pauses(with_root: bool, tmp_path: Path) -> None:
    path = tmp_path / "pioneer3.service"
    path.write_text(unit_here(RUN, with_root=with_root, environment={}).text())
    words = ["systemd-analyze", "verify", "--man=no", str(path)]
    done = subprocess.run(words, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr
    assert "pioneer3.service" not in done.stderr, done.stderr


def test_newer_systemd_makes_longer_and_longer_pauses(monkeypatch: pytest.MonkeyPatch) -> None:
    for version, knows in ((252, False), (254, True)):
        monkeypatch.setattr(service, "_systemd_version", lambda version=version: version)
        assert tuple(unit_here(RUN, with_root=False, environment={}).pauses) == PAUSES[knows]
