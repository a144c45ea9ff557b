"""`pioneer3 fleet list` where computers are cut off, hang, or are far away."""

import json
import time

import pytest

from tests.fleet.lab import Lab

pytestmark = pytest.mark.realtime


def listed(lab: Lab, *words: str) -> tuple[dict[str, dict[str, dict[str, object]]], int, float]:
    """Return what each robot answered, the exit code, and the time it took [s]."""
    began = time.monotonic()
    file = str(lab.operator.home / "fleet.toml")
    done = lab.operator.p3("fleet", "list", "--json", "--fleet", file, *words)
    took = time.monotonic() - began
    assert done.stdout, done.stderr
    rows = json.loads(done.stdout)
    return {row["robot"]["name"]: row["live"] for row in rows}, done.returncode, took


def test_a_partition_and_a_host_that_hangs_are_told_apart_and_delay_nobody(lab: Lab) -> None:
    cut, hung, well = lab.robots
    cut.cable.plugged = False
    hung.freeze()
    live, code, took = listed(lab, "--timeout", "2")
    assert live[well.name]["ssh"] == {"ok": True, "said": "yes"}
    assert live[hung.name]["up"]["ok"]
    assert live[hung.name]["ssh"] == {"ok": False, "said": "silent"}
    assert live[cut.name]["up"] == {"ok": False, "said": "no answer"}
    assert code == 1
    assert took < 8


def test_half_a_second_of_delay_is_no_fault(lab: Lab) -> None:
    for robot in lab.robots:
        robot.cable.delay = 0.25  # each way
    live, code, _ = listed(lab)
    assert [one["ssh"]["ok"] for one in live.values()] == [True] * 3
    assert code == 0


def test_where_packets_get_lost_the_list_comes_all_the_same(lab: Lab) -> None:
    for robot in lab.robots:
        robot.cable.loss = 0.3
    live, code, took = listed(lab, "--timeout", "8")
    assert len(live) == 3
    assert code in {0, 1}
    assert took < 20


def test_without_any_computer_the_code_is_3(lab: Lab) -> None:
    for robot in lab.robots:
        robot.cable.plugged = False
    live, code, _ = listed(lab, "--timeout", "1")
    assert [one["up"]["ok"] for one in live.values()] == [False] * 3
    assert code == 3


def test_the_clocks_of_computers_that_let_the_operator_in_are_told(lab: Lab) -> None:
    live, _, _ = listed(lab, "--timeout", "10")
    clocks = [one["clock"] for one in live.values()]
    assert all(isinstance(ahead, float) and abs(ahead) < 1.0 for ahead in clocks)
