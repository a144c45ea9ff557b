"""Work on many computers: outcomes, exit codes, and the words around a remote command."""

import asyncio
import os
import signal
import subprocess
import time
from pathlib import Path

import pytest

from pioneer3.cli.fleet_output import RobotLines
from pioneer3.errors import HostError, RemoteError
from pioneer3.fleet.run import Done, Outcome, bound_to_stdin, exit_code, on_each
from pioneer3.fleet.spec import FleetRobot


def robot(name: str) -> FleetRobot:
    return FleetRobot(name=name, host=name, address="192.168.1.1", node=name)


def outcome(*, ok: bool, reached: bool = True) -> Outcome:
    return Outcome(robot="r", ok=ok, reached=reached, status=None, why="", seconds=0.0)


async def test_failures_of_one_robot_are_its_own_and_all_work_at_once() -> None:
    async def work(robot: FleetRobot) -> Done:
        await asyncio.sleep(10)
        match robot.name:
            case "off":
                raise HostError("it is off")
            case "full":
                raise RemoteError("the disk is full")
            case "false":
                return Done(status=1, said="exit status 1")
            case "bug":
                raise KeyError("nothing")
        return Done(said="fine")

    names = ["off", "full", "false", "bug", "well"]
    found = await on_each(map(robot, names), work)
    assert [each.robot for each in found] == names
    assert [each.ok for each in found] == [False, False, False, False, True]
    assert [each.reached for each in found] == [False, True, True, True, True]
    assert [each.why for each in found][:3] == ["it is off", "the disk is full", "exit status 1"]
    assert {each.seconds for each in found} == {10.0}
    assert asyncio.get_running_loop().time() == 10.0


@pytest.mark.parametrize(
    ("outcomes", "code"),
    [
        ([], 0),
        ([outcome(ok=True)], 0),
        ([outcome(ok=True), outcome(ok=False, reached=False)], 1),
        ([outcome(ok=False), outcome(ok=False, reached=False)], 1),
        ([outcome(ok=False, reached=False)] * 2, 3),
    ],
)
def test_exit_codes(outcomes: list[Outcome], code: int) -> None:
    assert exit_code(outcomes) == code


@pytest.mark.parametrize(
    ("line", "shown"),
    [
        ("plain äöü", "plain äöü"),
        ("\x1b[1;31mred\x1b[0m", "red"),
        ("\x1b]0;title\x07text\x1b]8;;x\x1b\\link", "textlink"),
        ("a\tb", "a       b"),
        ("\x07\x9b2J", r"\x9b2J"),
    ],
)
def test_a_terminal_obeys_no_robot(
    line: str, shown: str, capsys: pytest.CaptureFixture[str]
) -> None:
    RobotLines([robot("p3at-1")]).show(robot("p3at-1"), line, is_error=False)
    assert capsys.readouterr().out == f"p3at-1 | {shown}\n"


@pytest.mark.realtime
def test_a_bound_command_keeps_status_and_quotes_and_ends_with_stdin(tmp_path: Path) -> None:
    command = bound_to_stdin("printf '%s' \"it's $((1+1))\"; exit 3")
    with subprocess.Popen(
        ["sh", "-c", command], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stdout.read() == "it's 2"
        assert process.wait(10) == 3
    mark = tmp_path / "pid"
    command = bound_to_stdin(f"echo $$ >{mark}.new; mv {mark}.new {mark}; sleep 1000; echo never")
    with subprocess.Popen(
        ["bash", "-c", command], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdin is not None
        while not mark.exists():
            time.sleep(0.02)
        process.stdin.close()
        assert process.wait(10) == 128 + signal.SIGTERM
    with pytest.raises(ProcessLookupError):
        os.kill(int(mark.read_text()), 0)
