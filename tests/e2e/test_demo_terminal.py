"""`pioneer3 demo` as people start it: in a terminal, through a pipe; every way out stops."""

import asyncio
import re
import signal
import subprocess
import sys
import termios
from contextlib import AbstractAsyncContextManager
from pathlib import Path

import pytest

from pioneer3.sim.server.start import simulator
from tests.e2e.at_terminal import Person, person
from tests.e2e.processes import PATIENCE, environment, p3, until

pytestmark = pytest.mark.realtime

UP, ESCAPE, CTRL_C = b"\x1b[A", b"\x1b", b"\x03"
FOCUS_LOST = b"\x1b[O"
SHOW_CURSOR, MAIN_SCREEN = b"\x1b[?25h", b"\x1b[?1049l"


def at_demo(tmp_path: Path, *options: str) -> AbstractAsyncContextManager[Person]:
    return person(tmp_path, *options, command="demo", ready=b"motors enabled")


async def drive(the: Person) -> None:
    """Set half speed and wait until the robot drives."""
    the.type(UP * 10)
    await until(lambda: the.speed > 0.2)


async def test_it_starts_drives_and_quits_with_the_terminal_as_it_was(tmp_path: Path) -> None:
    async with at_demo(tmp_path) as the:
        assert b"SIMULATOR" in the.screen
        assert b"EMERGENCY STOP" in the.screen
        await drive(the)
        the.type(ESCAPE)
        assert await the.code() == 0
        await until(lambda: the.standing)
        assert not the.simulation.body.drive.powered
        assert termios.tcgetattr(the.terminal) == the.before
        await until(lambda: SHOW_CURSOR in the.screen and MAIN_SCREEN in the.screen)


@pytest.mark.parametrize(
    ("way", "code"),
    [("SIGTERM", 143), ("SIGHUP", 129), ("SIGINT", 130), ("SIGQUIT", -signal.SIGQUIT)],
)
async def test_every_signal_stops_the_robot_and_gives_the_terminal_back(
    tmp_path: Path, way: str, code: int
) -> None:
    async with at_demo(tmp_path) as the:
        await drive(the)
        the.process.send_signal(signal.Signals[way])
        assert await the.code() == code
        await until(lambda: the.standing)
        await until(lambda: not the.simulation.body.drive.powered)
        assert termios.tcgetattr(the.terminal) == the.before
        assert b"Traceback" not in the.screen


async def test_ctrl_c_quits(tmp_path: Path) -> None:
    async with at_demo(tmp_path) as the:
        await drive(the)
        the.type(CTRL_C)
        assert await the.code() == 0
        await until(lambda: the.standing)


async def test_closing_the_window_stops_the_robot(tmp_path: Path) -> None:
    async with at_demo(tmp_path) as the:
        await drive(the)
        the.hang_up()
        assert await the.code() in {0, 129}
        await until(lambda: the.standing)
        assert not the.simulation.body.drive.powered


async def test_a_demo_that_is_killed_leaves_a_robot_that_stops_by_itself(tmp_path: Path) -> None:
    async with at_demo(tmp_path) as the:
        await drive(the)
        the.process.kill()
        await until(lambda: the.standing)


async def test_a_terminal_that_freezes_stops_the_robot_in_time(tmp_path: Path) -> None:
    async with at_demo(tmp_path, "--patience", "2") as the:
        await drive(the)
        await until(lambda: the.standing)
        await until(lambda: b"no key for 2 s" in the.screen)


async def test_a_terminal_that_loses_the_focus_stops_the_robot(tmp_path: Path) -> None:
    async with at_demo(tmp_path) as the:
        await drive(the)
        the.type(FOCUS_LOST)
        await until(lambda: the.standing)


async def test_a_terminal_that_takes_nothing_any_more_holds_nothing_up(tmp_path: Path) -> None:
    async with at_demo(tmp_path, "--patience", "8") as the:
        await drive(the)
        asyncio.get_running_loop().remove_reader(the.keyboard)
        await until(lambda: the.standing)
        assert the.simulation.body.drive.powered  # stopped by the demo, not by the robot
        the.process.send_signal(signal.SIGTERM)
        assert await the.code() == 143
        assert not the.simulation.body.drive.powered


class TestPlain:
    async def test_lines_come_through_a_pipe_and_keys_too(self, tmp_path: Path) -> None:
        async with simulator(map_name="office", port=0) as running:
            process = await asyncio.create_subprocess_exec(
                *(sys.executable, "-m", "pioneer3", "demo", "--plain", "--port", running.url),
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                env=environment(),
            )
            assert process.stdin is not None
            assert process.stdout is not None
            async with asyncio.timeout(PATIENCE):
                lines: list[str] = []
                while not re.fullmatch(
                    r"(\s+-?\d+){4}(\s+-?\d+\.\d){3}", lines[-1] if lines else ""
                ):
                    lines.append((await process.stdout.readline()).decode().rstrip("\n"))
                process.stdin.write(UP * 10)
                await until(lambda: running.body.speeds[0] > 0.2)
                process.stdin.write(b"s")
                while "SONAR" not in lines[-1] and "mode: sonar" not in lines[-1]:
                    lines.append((await process.stdout.readline()).decode().rstrip("\n"))
                await until(lambda: running.body.speeds[0] == 0)
                process.stdin.close()
                out, err = await process.communicate()
        assert process.returncode == 0
        assert err == b""
        assert b"     0     1     2     3     4     5     6     7\n" in out
        assert lines[0].startswith("SIMULATOR: Pioneer 3-AT on tcp://")
        assert "unguarded teleop mode: 'u' or 'U'" in lines
        assert "  transVel    rotVel         x         y        th     volts       soc" in lines

    async def test_keys_from_a_file_are_taken_and_then_it_ends(self, tmp_path: Path) -> None:
        keys = tmp_path / "keys"
        keys.write_text("b?")
        async with simulator(map_name="office", port=0) as running:
            with keys.open() as source:
                process = await asyncio.create_subprocess_exec(
                    *(sys.executable, "-m", "pioneer3", "demo", "--plain", "-p", running.url),
                    stdin=source,
                    stdout=subprocess.PIPE,
                    env=environment(),
                )
                async with asyncio.timeout(PATIENCE):
                    out, _ = await process.communicate()
        assert process.returncode == 0
        assert out.count(b"current mode: bumps") == 2


class TestRefusals:
    def test_without_a_robot_it_says_how_to_get_a_simulated_one(self) -> None:
        done = p3("demo", "--plain", "--port", "tcp://127.0.0.1:1")
        assert done.returncode == 3
        assert "pioneer3 sim" in done.stderr
        assert done.stderr.count("\n") == 1

    def test_without_a_terminal_it_names_plain(self) -> None:
        done = p3("demo", "--port", "tcp://127.0.0.1:1")
        assert done.returncode == 2
        assert "--plain" in done.stderr

    @pytest.mark.parametrize("mode", ["q", "teleop", ""])
    def test_a_mode_that_is_none_is_refused(self, mode: str) -> None:
        done = p3("demo", "--plain", "--mode", mode)
        assert done.returncode == 2
        assert "t u w l" in done.stderr
