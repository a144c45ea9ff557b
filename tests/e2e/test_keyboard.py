"""`pioneer3 drive` in a terminal of its own, with a person at the keyboard, in real time."""

import asyncio
import os
import pty
import signal
import subprocess
import sys
import termios
from pathlib import Path

import pytest

from tests.e2e.at_terminal import REPEATING, person
from tests.e2e.processes import PATIENCE, environment, p3, until

pytestmark = pytest.mark.realtime

UP, DOWN, RIGHT, LEFT = b"\x1b[A", b"\x1b[B", b"\x1b[C", b"\x1b[D"
CONTROLS = {"Ctrl-C": b"\x03", "Ctrl-\\": b"\x1c"}
SHOW_CURSOR = b"\x1b[?25h"
SLACK = 0.5
"""How far a busy machine may let the robot go on [m]."""


async def test_it_says_in_capitals_what_is_driven_and_which_keys_there_are(tmp_path: Path) -> None:
    async with person(tmp_path) as the:
        assert b"SIMULATOR: Pioneer 3-AT" in the.screen
        assert b"q: quit" in the.screen
        the.type(b"q")
        assert await the.code() == 0


async def test_a_held_arrow_moves_and_letting_go_stops(tmp_path: Path) -> None:
    async with person(tmp_path) as the:
        for keys, sign_v, sign_w in ((UP, 1, 0), (DOWN, -1, 0), (LEFT, 0, 1), (RIGHT, 0, -1)):
            while the.speed * sign_v < 0.2 and the.turn_rate * sign_w < 0.3:
                await the.hold(keys, REPEATING)
            await until(lambda: the.standing)


async def test_one_press_moves_a_little_and_ends_by_itself(tmp_path: Path) -> None:
    async with person(tmp_path) as the:
        the.type(UP)
        await until(lambda: the.speed > 0.05)
        await until(lambda: the.standing)
        assert 0.02 < the.travelled < 0.3 + SLACK  # 0.6 s at 0.5 m/s, had it begun with that


async def test_repeats_extend_a_press(tmp_path: Path) -> None:
    async with person(tmp_path) as the:
        while the.speed < 0.3:  # one press reaches 0.18 m/s: 0.6 s at 0.3 m/s2
            await the.hold(UP, REPEATING)
        await until(lambda: the.standing)


async def test_space_stops_although_the_key_would_act_on(tmp_path: Path) -> None:
    async with person(tmp_path, "--latch") as the:
        the.type(UP)
        await until(lambda: the.speed > 0.2)
        the.type(b" ")
        await until(lambda: the.standing)
        await asyncio.sleep(0.5)
        assert the.standing


async def test_latched_one_press_keeps_moving(tmp_path: Path) -> None:
    async with person(tmp_path, "--latch", "--speed", "0.3") as the:
        the.type(UP)
        await until(lambda: the.travelled > 0.6)
        assert the.speed == pytest.approx(0.3, abs=0.01)
        the.type(b"q")
        assert await the.code() == 0
        await until(lambda: the.standing)


async def test_what_is_latched_ends_when_no_key_comes(tmp_path: Path) -> None:
    async with person(tmp_path, "--latch", "--patience", "1.5s") as the:
        the.type(UP)
        await until(lambda: the.speed > 0.1)
        await until(lambda: the.standing)
        await until(lambda: b"No key for 1.5 s." in the.screen)


@pytest.mark.parametrize("patience", ["11", "10001ms", "inf", "0"])
def test_more_patience_than_10_s_is_refused(patience: str) -> None:
    for command in ("drive", "demo"):
        ended = p3(command, "--patience", patience)
        assert ended.returncode == 2
        assert "--patience" in ended.stderr


@pytest.mark.parametrize(("key", "told"), [(b" ", b"stopped"), (b"k", b"emergency stop")])
async def test_any_key_stops_a_robot_that_wanders_and_k_as_hard_as_it_can(
    tmp_path: Path, key: bytes, told: bytes
) -> None:
    async with person(tmp_path, command="wander", ready=b"m/s") as the:
        await until(lambda: the.speed > 0.05)
        the.type(key)
        await until(lambda: b"pioneer3: " + told in the.screen)
        assert await the.code() == 1
        await until(lambda: the.standing)
        assert termios.tcgetattr(the.terminal) == the.before
        assert not the.simulation.body.drive.powered


async def test_plus_and_minus_change_the_speed_shown(tmp_path: Path) -> None:
    async with person(tmp_path, "--speed", "0.4") as the:
        await the.sees(b"[0.40 30]")
        the.type(b"+")
        await the.sees(b"[0.44 33]")
        the.type(b"--")
        await the.sees(b"[0.36 27]")


async def test_q_leaves_with_the_terminal_as_it_was_and_the_robot_without_power(
    tmp_path: Path,
) -> None:
    async with person(tmp_path) as the:
        assert termios.tcgetattr(the.terminal) != the.before
        await the.hold(UP, 0.5)
        the.type(b"q")
        assert await the.code() == 0
        assert termios.tcgetattr(the.terminal) == the.before
        await until(lambda: the.standing)
        assert not the.simulation.body.drive.powered
        await until(lambda: the.screen.rstrip().endswith(SHOW_CURSOR))


@pytest.mark.parametrize(
    ("way", "code"),
    [
        ("Ctrl-C", 130),
        ("Ctrl-\\", -signal.SIGQUIT),
        ("SIGTERM", 143),
        pytest.param("SIGHUP", 129, marks=pytest.mark.thorough),  # a window that is closed sends it
    ],
    ids=str,
)
async def test_every_signal_leaves_the_terminal_as_it_was_and_stops(
    tmp_path: Path, way: str, code: int
) -> None:
    async with person(tmp_path, "--latch") as the:
        the.type(UP)
        await until(lambda: the.speed > 0.2)
        if way in CONTROLS:
            the.type(CONTROLS[way])
        else:
            the.process.send_signal(signal.Signals[way])
        assert await the.code() == code
        assert termios.tcgetattr(the.terminal) == the.before
        assert b"Traceback" not in the.screen
        await until(lambda: the.standing)
        await until(lambda: not the.simulation.body.drive.powered)


async def test_closing_the_window_stops_the_robot(tmp_path: Path) -> None:
    async with person(tmp_path, "--latch") as the:
        the.type(UP)
        await until(lambda: the.speed > 0.2)
        the.hang_up()
        assert await the.code() in {0, 129}
        await until(lambda: the.standing)
        assert not the.simulation.body.drive.powered


async def test_a_driver_that_is_killed_leaves_a_robot_that_stops_by_itself(tmp_path: Path) -> None:
    async with person(tmp_path, "--latch") as the:
        the.type(UP)
        await until(lambda: the.speed > 0.2)
        the.process.kill()
        await until(lambda: the.standing)


async def test_drive_without_a_robot_gives_the_terminal_back(tmp_path: Path) -> None:
    keyboard, terminal = pty.openpty()
    try:
        before = termios.tcgetattr(terminal)
        process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-m", "pioneer3", "drive", "--port", "tcp://127.0.0.1:1"),
            stdin=terminal,
            stdout=terminal,
            stderr=subprocess.PIPE,
            env=environment(),
            start_new_session=True,
        )
        async with asyncio.timeout(PATIENCE):
            _, stderr = await process.communicate()
        assert process.returncode == 3
        assert stderr.decode().splitlines() == [
            "pioneer3: tcp://127.0.0.1:1: nobody listens there; "
            "a simulator starts with: pioneer3 sim -p 1; see: pioneer3 docs no-port"
        ]
        assert termios.tcgetattr(terminal) == before
    finally:
        os.close(keyboard)
        os.close(terminal)
