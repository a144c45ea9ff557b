"""The commands as people start them: processes of their own, never left running."""

import asyncio
import logging
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import AsyncIterator, Callable, Mapping
from contextlib import asynccontextmanager, redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path

from pioneer3.cli.main import execute
from pioneer3.cli.process import LogFormatter
from tests.support import PHYSICS

PATIENCE = 30.0
"""Longest wait for anything on a busy machine [s]."""
KILLED = -1000
COMMAND = (sys.executable, "-m", "pioneer3")


def words_of(*arguments: str) -> tuple[str, ...]:
    """Return all words of a command."""
    physics = PHYSICS in os.environ and arguments[:1] == ("sim",)
    return (*COMMAND, *arguments, *(["--physics"] if physics else []))


def environment() -> dict[str, str]:
    """Return this machine's environment without what would change a command's defaults."""
    ours = ("PIONEER3_", "PYTHONUNBUFFERED")
    return {k: v for k, v in os.environ.items() if not k.startswith(ours)}


def p3(*arguments: str) -> "subprocess.CompletedProcess[str]":
    """Run a command to its end, with nothing on standard input."""
    return subprocess.run(
        words_of(*arguments),
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        env=environment(),
        check=False,
    )


async def pioneer3(*arguments: str) -> tuple[int, str, str]:
    """Run the command in another thread; return its exit code, stdout and stderr.

    It costs a tenth of a process, which only tests of starts, ends and signals need.
    """
    out, err = StringIO(), StringIO()
    log = logging.StreamHandler(err)
    log.setLevel(logging.WARNING)
    log.setFormatter(LogFormatter("%(levelname)s: %(message)s"))
    logging.getLogger().addHandler(log)
    try:
        with redirect_stdout(out), redirect_stderr(err):
            code = await asyncio.to_thread(execute, arguments)
    finally:
        logging.getLogger().removeHandler(log)
    return code, out.getvalue(), err.getvalue()


def in_session(session: int) -> list[int]:
    """Return the processes that are left of a session."""
    left = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text().rpartition(")")[2].split()
        except OSError:
            continue
        if int(fields[3]) == session and fields[0] != "Z":
            left.append(int(stat.parent.name))
    return left


class Command:
    """A running command, the leader of a session of its own."""

    def __init__(self, process: asyncio.subprocess.Process) -> None:
        self.process = process

    async def line(self) -> str:
        """Return the next line of its output."""
        assert self.process.stdout is not None
        async with asyncio.timeout(PATIENCE):
            return (await self.process.stdout.readline()).decode().rstrip("\n")

    async def end(self, number: signal.Signals | None = None) -> tuple[int, str]:
        """Send a signal and wait; return the exit code and all of stderr.

        The exit code is what the command returned, or :data:`KILLED` less the signal it died of.
        """
        assert self.process.stderr is not None
        if number is not None:
            self.process.send_signal(number)
        async with asyncio.timeout(PATIENCE):
            stderr = (await self.process.stderr.read()).decode()
            code = await self.process.wait()
        assert in_session(self.process.pid) == []
        return (code if code >= 0 else KILLED + code), stderr


@asynccontextmanager
async def running(
    *arguments: str, variables: Mapping[str, str] | None = None
) -> AsyncIterator[Command]:
    """Start a command, with more variables of the environment; kill it in the end if it runs."""
    process = await asyncio.create_subprocess_exec(
        *words_of(*arguments),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env=environment() | dict(variables or {}),
        start_new_session=True,
    )
    try:
        yield Command(process)
    finally:
        if process.returncode is None:
            process.kill()
        await process.communicate()


def free_port() -> int:
    """Return a TCP port of this computer that is free now."""
    with socket.create_server(("127.0.0.1", 0)) as listener:
        return int(listener.getsockname()[1])


async def until(condition: Callable[[], object]) -> float:
    """Wait until `condition` holds; return how long that took [s]."""
    began = time.monotonic()
    async with asyncio.timeout(PATIENCE):
        while not condition():  # noqa: ASYNC110  most conditions have no event
            await asyncio.sleep(0.01)
    return time.monotonic() - began
