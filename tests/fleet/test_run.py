"""`pioneer3 fleet run`: lines as they come, faults told in words, and nothing waits for a fault."""

import shlex
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.fleet.lab import Lab, OnBoard

pytestmark = pytest.mark.realtime


def test_lines_begin_with_the_robot_and_failures_give_the_exit_code(lab: Lab) -> None:
    done = lab.operator.p3("fleet", "run", "hostname; test $(hostname) != p3at-2 || exit 7")
    assert sorted(done.stdout.splitlines()) == [
        "p3at-1 | p3at-1",
        "p3at-2 | p3at-2",
        "p3at-3 | p3at-3",
    ]
    assert "p3at-2  FAIL" in done.stderr
    assert "exit status 7" in done.stderr
    assert "1 of 3 failed: p3at-2" in done.stderr
    assert done.returncode == 1


def test_groups_and_words_after_dashes(lab: Lab) -> None:
    done = lab.operator.p3("fleet", "run", "--on", "front", "--", "printf", "'%s\n'", "-n", "a")
    assert sorted(done.stdout.splitlines()) == [
        "p3at-1 | -n",
        "p3at-1 | a",
        "p3at-2 | -n",
        "p3at-2 | a",
    ]
    assert done.returncode == 0
    wrong = lab.operator.p3("fleet", "run", "--on", "frnt", "true")
    assert "did you mean front?" in wrong.stderr
    assert wrong.returncode == 2


def test_output_obeys_no_terminal_and_comes_line_by_line(lab: Lab) -> None:
    command = r"printf 'a\033[31mred\033[0m\007\r\nlong'; head -c 20000 /dev/zero | tr '\0' x"
    done = lab.operator.p3("fleet", "run", "--on", "p3at-1", command)
    first, *rest = done.stdout.splitlines()
    assert first == "p3at-1 | ared"
    assert "".join(line.removeprefix("p3at-1 | ") for line in rest) == "long" + 20000 * "x"


def freeze(robot: OnBoard, lab: Lab) -> None:
    robot.freeze()


def refuse(robot: OnBoard, lab: Lab) -> None:
    robot.stop_sshd()


def cut(robot: OnBoard, lab: Lab) -> None:
    robot.cable.plugged = False


def drop(robot: OnBoard, lab: Lab) -> None:
    card = robot.sh("cat /sys/class/net/eth0/address").strip()
    lab.operator.sh(f"ip neigh replace {robot.address} lladdr {card} dev eth0 nud permanent")
    robot.cable.plugged = False


def switch_off(robot: OnBoard, lab: Lab) -> None:
    robot.stop()
    lab.operator.sh(f"ip neigh flush to {robot.address}")


def change_host_key(robot: OnBoard, lab: Lab) -> None:
    robot.new_host_key()


def forget_host_key(robot: OnBoard, lab: Lab) -> None:
    known = lab.operator.known_hosts.read_text().splitlines(keepends=True)
    lab.operator.known_hosts.write_text("".join(line for line in known if robot.name not in line))


def refuse_key(robot: OnBoard, lab: Lab) -> None:
    (robot.user_home / ".ssh/authorized_keys").unlink()


def garbage(robot: OnBoard, lab: Lab) -> None:
    robot.stop_sshd()
    script = (
        "import socket; s = socket.create_server(('', 22))\n"
        "while True: c, _ = s.accept(); c.sendall(b'HTTP/1.1 400 No\\r\\n' * 2000); c.close()"
    )
    robot.sh(f"python3 -c {shlex.quote(script)} </dev/null >/dev/null 2>&1 &")
    robot.sh("while ! bash -c 'true </dev/tcp/127.0.0.1/22'; do sleep 0.05; done 2>/dev/null")


@pytest.mark.parametrize(
    ("fault", "told"),
    [
        (freeze, "accepts the connection, then says nothing for 5 s"),
        (refuse, "refuses ssh: no ssh server runs there"),
        (cut, "no computer at 192.168.1.112: it is off, out of reach"),
        (drop, "no answer from 192.168.1.112 for 5 s"),
        (switch_off, "no computer at 192.168.1.112: it is off"),
        (change_host_key, "another host key than before (SHA256:"),
        (forget_host_key, "its host key is not known here yet"),
        (refuse_key, "pioneer@192.168.1.112 does not accept your key"),
        (garbage, "hung up before the login"),
    ],
)
def test_one_robot_at_fault_costs_the_others_nothing(
    fault: Callable[[OnBoard, Lab], None], told: str, lab: Lab
) -> None:
    fault(lab.robots[1], lab)
    began = time.monotonic()
    with subprocess.Popen(
        lab.operator.command("fleet", "run", "--timeout", "5", "hostname"),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=lab.operator.environment,
    ) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        lines = {process.stdout.readline(), process.stdout.readline()}
        others = time.monotonic() - began
        why = " ".join(process.stderr.read().split())
    assert lines == {"p3at-1 | p3at-1\n", "p3at-3 | p3at-3\n"}
    assert told in why
    assert "1 of 3 failed: p3at-2" in why
    assert process.returncode == 1
    if fault in {freeze, drop}:  # the others did not wait for it
        assert others < time.monotonic() - began - 1.0


def test_of_five_robots_with_four_faults_the_fifth_answers_at_once(
    possible: None, tmp_path: Path
) -> None:
    with Lab(tmp_path, 5) as lab:
        frozen, strange, refusing, lost, well = lab.robots
        freeze(frozen, lab)
        change_host_key(strange, lab)
        refuse_key(refusing, lab)
        drop(lost, lab)
        well.cable.delay = 0.05
        began = time.monotonic()
        with subprocess.Popen(
            lab.operator.command("fleet", "run", "--timeout", "10", "hostname"),
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env=lab.operator.environment,
        ) as process:
            assert process.stdout is not None
            assert process.stderr is not None
            assert process.stdout.readline() == "p3at-5 | p3at-5\n"
            first = time.monotonic() - began
            why = " ".join(process.stderr.read().split())
        whole = time.monotonic() - began
    assert "p3at-1 NOT REACHED" in why
    assert "says nothing" in why
    assert "another host key than before" in why
    assert "does not accept your key" in why
    assert "no answer from 192.168.1.114" in why
    assert "4 of 5 failed: p3at-1, p3at-2, p3at-3, p3at-4" in why
    assert first < whole - 3.0
    assert whole < 10 + 10  # all faults at once cost as much as one, and the start


def test_no_key_no_agent_and_a_locked_key_are_told_apart(lab: Lab) -> None:
    key = lab.operator.home / ".ssh/id_ed25519"
    change = ["ssh-keygen", "-q", "-p", "-P", "", "-N", "secret", "-f", str(key)]
    subprocess.run(change, check=True, capture_output=True)
    locked = lab.operator.p3("fleet", "run", "--on", "p3at-1", "true")
    assert "has a passphrase, and no agent holds it" in " ".join(locked.stderr.split())
    assert locked.returncode == 3
    key.unlink()
    none = lab.operator.p3("fleet", "run", "--on", "p3at-1", "true")
    assert "you have no ssh key; to make one and install it run: pioneer3 fleet key" in " ".join(
        none.stderr.split()
    )


def test_half_a_second_of_delay_and_lost_packets_are_no_fault(lab: Lab) -> None:
    lab.operator.p3("fleet", "run", "true")  # a computer that was never there may be taken for off
    lab.robots[0].cable.delay = 0.5
    lab.robots[1].cable.loss = 0.15  # each way: 28 % of the questions stay without an answer
    done = lab.operator.p3("fleet", "run", "--timeout", "40", "hostname")
    assert len(done.stdout.splitlines()) == 3, done.stderr
    assert done.returncode == 0


def running(robot: OnBoard, words: str) -> list[int]:
    return [process for process in robot.processes(words) if process != robot.process]


def test_ctrl_c_ends_the_commands_everywhere(lab: Lab) -> None:
    with subprocess.Popen(
        lab.operator.command("fleet", "run", "echo on; sleep 1000 & sleep 1001"),
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        env=lab.operator.environment,
    ) as process:
        assert process.stdout is not None
        assert [process.stdout.readline()[9:] for _ in lab.robots] == ["on\n"] * 3
        assert all(running(robot, "sleep 100") for robot in lab.robots)
        process.send_signal(signal.SIGINT)
        assert process.wait(20) == 130
    assert [running(robot, "sleep 100") for robot in lab.robots] == [[], [], []]


def test_a_command_is_stopped_at_its_limit_even_if_it_ignores_that(lab: Lab) -> None:
    done = lab.operator.p3(
        "fleet", "run", "--limit", "1", "trap '' TERM; while :; do sleep 1; done"
    )
    assert done.stderr.count("stopped: it took longer than 1 s") == 3
    assert done.returncode == 1
    assert [running(robot, "trap") for robot in lab.robots] == [[], [], []]


def test_a_robot_that_freezes_meanwhile_is_given_up_and_the_others_go_on(lab: Lab) -> None:
    command = "echo on; sleep 6; echo done"
    with subprocess.Popen(
        lab.operator.command("fleet", "run", "--timeout", "3", command),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=lab.operator.environment,
    ) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        assert [process.stdout.readline()[9:] for _ in lab.robots] == ["on\n"] * 3
        lab.robots[2].freeze()
        assert sorted(process.stdout.read().split("\n")) == ["", "p3at-1 | done", "p3at-2 | done"]
        why = " ".join(process.stderr.read().split())
    assert "the connection to 192.168.1.113 was lost" in why
    assert process.returncode == 1
