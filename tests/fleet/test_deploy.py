"""`pioneer3 fleet deploy` to computers without internet; systemd is a script here, sshd is real.

The script starts what the unit says, once; that systemd takes the unit is tested elsewhere.
"""

import shutil
import subprocess
import sys
import time
from collections.abc import Iterator

import pytest

from tests.fleet.lab import PATIENCE, ROOT, Lab, OnBoard

pytestmark = [pytest.mark.realtime, pytest.mark.timeout(400)]
SYSTEMCTL = r"""
[ "$1" = --user ] && shift
unit=$HOME/.config/systemd/user/pioneer3.service
pid=$HOME/service.pid
end() { [ -e $pid ] && kill $(cat $pid) 2>/dev/null; rm -f $pid; true; }
echo "$@" >>$HOME/asked
case $1 in
  enable | daemon-reload) ;;
  disable) end ;;
  restart)
    end
    setsid $(sed -n 's/^ExecStart=//p' $unit) >>$HOME/service.log 2>&1 </dev/null &
    echo $! >$pid ;;
  is-active)
    if [ -e $pid ] && kill -0 $(cat $pid) 2>/dev/null; then echo active
    else echo failed; exit 3; fi ;;
  show) echo 0 ;;
esac
"""


@pytest.fixture
def ready(lab: Lab) -> Iterator[Lab]:
    """Each robot's computer has a robot, simulated, and a service manager."""
    lab.write_fleet(tcp=True)
    simulators = []
    for robot in lab.robots[:2]:
        robot.replace_program("/usr/bin/systemctl", SYSTEMCTL)
        robot.replace_program("/usr/bin/loginctl", "exit 0\n")
        robot.replace_program("/usr/bin/journalctl", "tail -n 3 $HOME/service.log\n")
        (robot.etc / "hosts").write_text(f"127.0.0.1 localhost {robot.name}\n")
        words = [*robot.inside, sys.executable, "-m", "pioneer3", "sim"]
        simulators.append(
            subprocess.Popen(words, env=lab.operator.environment, stdout=subprocess.DEVNULL)
        )
    try:
        yield lab
    finally:
        for simulator in simulators:
            simulator.terminate()
            simulator.wait()


def version(robot: OnBoard) -> str:
    return (robot.user_home / ".local/share/pioneer3/current").readlink().name


def asked(robot: OnBoard) -> list[str]:
    return (robot.user_home / "asked").read_text().splitlines()


def break_package(lab: Lab) -> None:
    """Let the operator have a version of pioneer3 that does not start."""
    copy = lab.operator.folder / "src"
    shutil.copytree(ROOT / "src", copy, ignore=shutil.ignore_patterns("__pycache__"))
    command = copy / "pioneer3/cli/run.py"
    text = command.read_text()
    assert "return run_until_told_to_leave(" in text
    command.write_text(text.replace("return run_until_told_to_leave(", "return gone("))
    lab.operator.source = copy


def test_it_installs_serves_and_does_nothing_the_second_time(ready: Lab) -> None:
    robot = ready.robots[0]
    done = ready.operator.p3("fleet", "deploy", "--on", "front")
    assert done.returncode == 0, done.stderr
    assert done.stderr.count("drives the robot from the start") == 2
    log = robot.user_home / "service.log"
    end = time.monotonic() + PATIENCE
    while "Connected to a SIMULATOR" not in log.read_text():
        assert time.monotonic() < end, log.read_text()
        time.sleep(0.1)
    assert version(robot) == version(ready.robots[1])
    assert not list((robot.user_home / ".local/share/pioneer3").glob("*.tar.gz"))
    (service,) = [pid for pid in robot.processes("-m pioneer3 run") if pid]
    restarts = asked(robot).count("restart pioneer3")
    again = ready.operator.p3("fleet", "deploy", "--on", "p3at-1")
    assert again.returncode == 0, again.stderr
    assert "was there, and runs" in again.stderr
    assert asked(robot).count("restart pioneer3") == restarts == 1
    assert robot.processes("-m pioneer3 run") == [service]
    told = ready.operator.p3("fleet", "status", "--on", "p3at-1").stdout
    assert f"{version(robot)}  active" in told


def test_a_version_that_does_not_start_gives_way_to_the_one_before(ready: Lab) -> None:
    robot, other = ready.robots[:2]
    assert ready.operator.p3("fleet", "deploy", "--on", "p3at-1").returncode == 0
    good = version(robot)
    break_package(ready)
    done = ready.operator.p3("fleet", "deploy", "--on", "front")
    words = " ".join(done.stderr.split())
    assert f"The version before, {good}, runs again" in words
    assert "The service is switched off again; nothing ran there before" in words
    assert "NameError" in words
    assert done.returncode == 1
    assert version(robot) == good
    assert len(robot.processes("-m pioneer3 run")) == 1
    assert not (other.user_home / ".local/share/pioneer3/current").is_symlink()
    assert other.processes("-m pioneer3 run") == []


def test_what_cannot_be_is_told_and_leaves_nothing_behind(ready: Lab) -> None:
    old, full, off = ready.robots
    for name in ("python3.11", "python3"):
        old.sh(f"mount --bind /bin/false /usr/bin/{name}")
    full.sh("mount -o remount,size=20m /home")
    off.stop()
    done = ready.operator.p3("fleet", "deploy")
    words = " ".join(done.stderr.split())
    assert "p3at-1 FAIL" in words
    assert "it has no Python; pioneer3 needs 3.11 or newer" in words
    assert "the disk there is full" in words or "No space left on device" in words
    assert "no computer at 192.168.1.113" in words
    assert "3 of 3 failed" in words
    assert done.returncode == 1
    left = full.user_home / ".local/share/pioneer3"
    assert not [path for path in left.iterdir() if path.name != "releases"]
    assert not (left / "current").exists()
