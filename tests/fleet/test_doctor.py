"""`pioneer3 fleet status`, `doctor` and `logs` on real computers."""

import json
import signal
import subprocess

import pytest

from tests.fleet.lab import OPERATOR_ADDRESS, PATIENCE, Lab

pytestmark = pytest.mark.realtime


def mend(lab: Lab) -> None:
    """Let all be well on the first robot."""
    hosts = [f"{each.address} {each.name}" for each in lab.robots]
    text = "\n".join(["127.0.0.1 localhost", f"{OPERATOR_ADDRESS} laptop", *hosts])
    (lab.robots[0].etc / "hosts").write_text(text + "\n")
    lab.write_fleet(port="/run/robot")
    lab.robots[0].sh("touch /run/robot; chgrp dialout /run/robot; chmod 660 /run/robot")
    lab.robots[0].sh("mount -o remount,size=4g /home")
    lab.robots[0].set_password_login(on=False)


def test_a_mended_robot_is_well_and_the_faults_of_others_are_found(lab: Lab) -> None:
    mend(lab)
    wrong, off = lab.robots[1], lab.robots[2]
    wrong.sh("touch /run/robot; chmod 600 /run/robot")
    wrong.replace_program("/usr/bin/date", 'exec $0.real -d "now + 5 seconds" "$@"\n')
    off.stop()
    done = lab.operator.p3("fleet", "doctor", "--json")
    told = {
        each["robot"]: {f["check"]: f["level"] for f in each["findings"]}
        for each in json.loads(done.stdout)
    }
    assert set(told["p3at-1"].values()) == {"ok"}, done.stdout
    assert {"ssh", "disk", "names", "firewall", "clock", "serial port", "passwords"} <= set(
        told["p3at-1"]
    )
    assert told["p3at-2"] | {"disk": "warn"} == {
        "ssh": "ok",
        "disk": "warn",
        "own name": "ok",
        "names": "warn",
        "firewall": "ok",
        "clock": "fail",
        "serial port": "fail",
        "passwords": "warn",
    }
    assert told["p3at-3"] == {"ssh": "fail"}
    assert done.returncode == 1
    one = lab.operator.p3("fleet", "doctor", "--on", "p3at-1")
    assert one.stdout.split("\n")[0] == "p3at-1 8 checks are well"
    assert one.returncode == 0


@pytest.mark.parametrize(
    "floods", ["exec yes", "yes >&2"], ids=["standard output", "standard error"]
)
def test_output_without_end_is_a_finding_about_that_robot_alone(lab: Lab, floods: str) -> None:
    (lab.robots[1].user_home / ".bashrc").write_text(f"{floods}\n")
    done = subprocess.run(
        ["prlimit", "--as=2000000000", *lab.operator.command("fleet", "doctor", "--on", "front")],
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        env=lab.operator.environment,
        check=False,
    )
    assert "p3at-1" in done.stdout
    assert "stopped: it wrote more than 16 MB" in " ".join(done.stdout.split())
    assert done.returncode == 1


def test_status_is_a_row_for_each_robot_that_answers(lab: Lab) -> None:
    lab.robots[1].cable.plugged = False
    done = lab.operator.p3("fleet", "status", "--timeout", "5")
    rows = [line.split()[0] for line in done.stdout.splitlines()]
    assert rows == ["robot", "p3at-1", "p3at-3"]
    assert "no computer at 192.168.1.112" in done.stderr
    assert done.returncode == 1
    data = json.loads(lab.operator.p3("fleet", "status", "--json", "--on", "p3at-1").stdout)
    assert data["robots"]["p3at-1"]["hostname"] == "p3at-1"
    assert abs(data["robots"]["p3at-1"]["clock_offset"]) < 0.5
    assert data["problems"] == {}


def test_logs_follow_all_robots_until_ctrl_c(lab: Lab) -> None:
    for robot in lab.robots:
        robot.replace_program(
            "/usr/bin/journalctl",
            'echo "$@"; n=0; while sleep 0.1; do echo "line $((n += 1))"; done\n',
        )
    with subprocess.Popen(
        lab.operator.command("fleet", "logs", "-f", "--on", "front", "--lines", "5"),
        stdout=subprocess.PIPE,
        text=True,
        env=lab.operator.environment,
    ) as process:
        assert process.stdout is not None
        lines = [process.stdout.readline().rstrip() for _ in range(12)]
        process.send_signal(signal.SIGINT)
        assert process.wait(20) == 130
    options = "--user -u pioneer3 -n 5 -o short-iso --no-pager --no-hostname -f"
    assert {f"p3at-1 | {options}", f"p3at-2 | {options}"} <= set(lines)
    assert {"p3at-1 | line 2", "p3at-2 | line 2"} <= set(lines)
    assert [robot.processes("journalctl") for robot in lab.robots] == [[], [], []]
