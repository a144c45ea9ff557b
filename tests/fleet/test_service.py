"""`pioneer3 setup service` on an on-board computer with the real systemd of its user."""

import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from sysconfig import get_path

import pytest

from tests.fleet.lab import PATIENCE, ROOT, USER, Lab, OnBoard
from tests.fleet.manager import as_user, managed, why_no_manager

pytestmark = [pytest.mark.realtime, pytest.mark.thorough, pytest.mark.timeout(300)]
PACKAGES = f"{ROOT / 'src'}:{get_path('purelib')}"
RUN = ("run", "--port", "tcp://127.0.0.1:8101", "--web-port", "0", "--no-announce")


@pytest.fixture
def robot(possible: None, tmp_path: Path) -> Iterator[OnBoard]:
    """A robot's computer with a service manager; the robot is simulated at its port 8101."""
    if reason := why_no_manager():
        pytest.skip(reason)
    with Lab(tmp_path, number=1) as lab, managed(lab.robots):
        simulator = [*lab.robots[0].inside, sys.executable, "-m", "pioneer3", "sim"]
        with subprocess.Popen(simulator, stdout=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None
            assert process.stdout.readline()
            yield lab.robots[0]
            process.terminate()


def setup(robot: OnBoard, *words: str) -> tuple[int, str]:
    """Run `pioneer3 setup service` as the computer's user; return its code and output."""
    program = [
        "env",
        "-C",
        f"/home/{USER}",
        f"PYTHONPATH={PACKAGES}",
        "/usr/bin/python3",
        "-m",
        "pioneer3",
    ]
    command = as_user(robot, *program, "setup", "service", *words)
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr


def property_of(robot: OnBoard, name: str) -> str:
    words = as_user(robot, "systemctl", "--user", "show", "-p", name, "--value", "pioneer3")
    return subprocess.run(words, capture_output=True, text=True, check=True).stdout.strip()


def test_a_robot_is_driven_from_the_start_until_that_is_removed(robot: OnBoard) -> None:
    unit = robot.user_home / ".config/systemd/user/pioneer3.service"
    code, said = setup(robot, *RUN)
    assert (code, ": active, restarts: 0" in said) == (0, True), said
    assert "http://127.0.0.1:" in said
    assert "sudo loginctl enable-linger" in said  # this lab has no logind
    assert unit.stat().st_mode & 0o777 == 0o600

    kill = ("systemctl", "--user", "kill", "-s", "KILL", "pioneer3")
    subprocess.run(as_user(robot, *kill), check=True)
    end = time.monotonic() + PATIENCE
    while property_of(robot, "ActiveState") != "active" or property_of(robot, "NRestarts") != "1":
        assert time.monotonic() < end, "it does not come back"
        time.sleep(0.2)
    assert "restarts: 1" in setup(robot, "--status")[1]

    code, said = setup(robot, *RUN[:2], "tcp://127.0.0.1:9", *RUN[3:])  # nobody is there
    assert (code, "is started again" in said) == (1, True), said
    assert "127.0.0.1:9" in said
    assert setup(robot, "--remove") == (0, f"removed {unit_path()}\n")
    assert not unit.exists()
    assert property_of(robot, "ActiveState") == "inactive"


def unit_path() -> str:
    return f"/home/{USER}/.config/systemd/user/pioneer3.service"
