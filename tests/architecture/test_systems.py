"""What needs no Linux runs without what only POSIX systems have."""

import subprocess
import sys
from pathlib import Path

import pytest

from pioneer3.navigation.connect import connect_async
from pioneer3.sim.server import listeners
from pioneer3.sim.server.start import simulator

ROOT = Path(__file__).parents[2]
WITHOUT_POSIX = """
import asyncio, signal, sys
import cyclopts, rich.live, serialx, starlette, textual.app, uvicorn, websockets

for name in ("termios", "tty", "pty", "fcntl", "grp", "pwd", "resource", "readline", "syslog"):
    sys.modules[name] = None
missing_signals = ("SIGHUP", "SIGQUIT", "SIGTTIN", "SIGTTOU", "SIGTSTP", "SIGUSR1", "SIGALRM")
for name in missing_signals:
    delattr(signal, name)
    del signal.Signals._member_map_[name]
import select, os
for name in ("epoll", "poll"):
    delattr(select, name)
for name in ("fork", "openpty", "mkfifo", "getpgrp", "tcgetpgrp", "geteuid", "ttyname"):
    delattr(os, name)

def missing(*_):
    raise NotImplementedError

asyncio.SelectorEventLoop.add_signal_handler = missing
"""
"""As on Windows, which has neither these modules nor these names (docs.python.org says so)."""
# ROS 1 is Debian's; of full screens Textual has a part for each system.
EVERYTHING = """
import importlib, pkgutil
import pioneer3

SCREENS = ("pioneer3.demo.app", "pioneer3.fleet.screen", "pioneer3.teleop.screen")
OTHERS = ("pioneer3.ros.ros1", "pioneer3.__main__", *SCREENS)

for module in pkgutil.walk_packages(pioneer3.__path__, "pioneer3."):
    if not module.name.startswith(OTHERS):
        importlib.import_module(module.name)
        print(module.name)
"""
DRIVE = """
async def drive():
    from pioneer3 import connect_async
    from pioneer3.sim.server.start import simulator

    async with simulator(port=0) as simulation, connect_async(simulation.url) as robot:
        await robot.move(0.1)
        print("at", round(robot.snapshot.odometry.robot_in_odom.x, 1))

from pioneer3.cli.process import run_until_told_to_leave
raise SystemExit(run_until_told_to_leave(drive()))
"""


def run(code: str) -> "subprocess.CompletedProcess[str]":
    return subprocess.run(
        [sys.executable, "-W", "error", "-c", WITHOUT_POSIX + code],
        capture_output=True,
        text=True,
        timeout=100,
        check=False,
        cwd=ROOT,
    )


def test_every_module_is_imported_without_what_only_posix_has() -> None:
    done = run(EVERYTHING)
    assert done.stderr == ""
    assert done.returncode == 0
    assert len(done.stdout.splitlines()) > 300


@pytest.mark.realtime
def test_a_simulated_robot_drives_over_tcp_without_what_only_posix_has() -> None:
    done = run(DRIVE)
    assert (done.stdout, done.stderr, done.returncode) == ("at 0.1\n", "", 0)


@pytest.mark.realtime
def test_what_is_not_there_is_said_in_one_line() -> None:
    told = {
        "drive": "needs a terminal",
        "sim -p 0 --pty": "this system has no pseudo terminals",
        "--help": "Drive, simulate and program",
    }
    done = run(
        f"""
from pioneer3.cli.main import execute
for line in {[*told]}:
    print(f"\\n> {{line}}", flush=True)
    execute(line.split())
    sys.stderr.flush()
"""
    )
    said = done.stdout + done.stderr
    assert [line for line, words in told.items() if words not in said] == []
    assert "Traceback" not in done.stderr


@pytest.mark.realtime
async def test_the_simulator_serves_sockets_that_are_no_files(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(listeners, "SOCKETS_ARE_FILES", False)
    async with simulator(port=0) as simulation:
        for _ in range(2):
            async with connect_async(simulation.url) as robot:
                await robot.move(0.05)
                assert robot.info.identity.model == "p3at-sh"
