"""The lab itself: what the other tests take for granted."""

import subprocess
import time

import pytest

from tests.fleet.lab import Lab, OnBoard

pytestmark = pytest.mark.realtime


def ssh(lab: Lab, robot: OnBoard, command: str) -> "subprocess.CompletedProcess[str]":
    words = ["ssh", "-o", "BatchMode=yes", "-o", "ConnectTimeout=2", f"pioneer@{robot.address}"]
    return subprocess.run(
        [*lab.operator.inside, *words, command],
        capture_output=True,
        text=True,
        check=False,
        env=lab.operator.environment,
        timeout=60,
    )


def test_each_computer_has_its_own_name_home_and_full_disk(lab: Lab) -> None:
    told = [ssh(lab, robot, "hostname; pwd; id -Gn").stdout.split("\n") for robot in lab.robots]
    assert [name for name, *_ in told] == ["p3at-1", "p3at-2", "p3at-3"]
    assert {home for _, home, *_ in told} == {"/home/pioneer"}
    assert "dialout" in told[0][2]
    ssh(lab, lab.robots[0], "echo mine >file")
    assert ssh(lab, lab.robots[1], "cat file").returncode == 1
    full = ssh(lab, lab.robots[0], "head -c 1000000 /dev/zero >/opt/small/file")
    assert "No space left on device" in full.stderr


def test_a_delay_counts_each_way(lab: Lab) -> None:
    robot = lab.robots[0]
    assert ssh(lab, robot, "true").returncode == 0
    robot.cable.delay = 0.1
    connect = ["bash", "-c", f"true </dev/tcp/{robot.address}/22"]
    began = time.monotonic()
    subprocess.run([*lab.operator.inside, *connect], check=True)
    assert time.monotonic() - began >= 0.2


def test_a_frozen_computer_accepts_and_says_nothing_and_a_partition_is_silent(lab: Lab) -> None:
    hung, cut, well = lab.robots
    hung.freeze()
    cut.cable.plugged = False
    assert "timed out" in ssh(lab, hung, "true").stderr
    assert ssh(lab, cut, "true").returncode == 255
    assert ssh(lab, well, "true").returncode == 0


def test_nothing_is_left_of_a_lab(lab: Lab) -> None:
    processes = [process for robot in lab.robots for process in robot.processes()]
    assert len(processes) >= 6
    for robot in lab.robots:
        robot.stop()
        assert ssh(lab, lab.robots[0], "true").returncode == 255
    assert [p for p in processes if _alive(p)] == []


def _alive(process: int) -> bool:
    try:
        with open(f"/proc/{process}/stat") as stat:  # noqa: PTH123
            return stat.read().rpartition(")")[2].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False
