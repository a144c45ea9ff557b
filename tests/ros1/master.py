"""ROS itself: a master of our own on loopback, and its command-line tools as processes."""

import asyncio
import json
import os
import signal
import subprocess
from collections.abc import AsyncIterator, Iterator, Mapping, Sequence
from contextlib import asynccontextmanager, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tests.e2e.processes import PATIENCE, environment

PYTHON = "/usr/bin/python3"
"""The one that Debian's ROS is installed for."""
HERE = Path(__file__).parent
ANSWER = 3.0
"""After it, a program that was asked to end is asked again [s]."""


def environment_of(port: int, home: Path) -> dict[str, str]:
    """Return what makes programs talk to the master on `port`, on loopback only."""
    return {
        "ROS_MASTER_URI": f"http://127.0.0.1:{port}",
        "ROS_IP": "127.0.0.1",
        "ROS_HOME": str(home),
        "ROS_LOG_DIR": str(home / "log"),
    }


def unbuffered() -> dict[str, str]:
    """Return the environment of ROS's own programs, whose lines come through a pipe at once."""
    return {**environment(), "PYTHONUNBUFFERED": "1"}


@contextmanager
def roscore(port: int, home: Path) -> Iterator[None]:
    """Run a master while the block lasts."""
    command = ("roscore", "-p", str(port))
    with started(command, "started core service [/rosout]", environment_of(port, home)):
        yield


@contextmanager
def started(command: Sequence[str], words: str, ros: Mapping[str, str]) -> Iterator[str]:
    """Run a command; the block begins with the line in which it says `words`."""
    process = subprocess.Popen(
        command,
        env={**unbuffered(), **ros},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )
    assert process.stdout is not None
    said: list[str] = []
    try:
        for line in process.stdout:
            said.append(line)
            if words in line:
                break
        else:
            raise AssertionError("".join(said))
        yield said[-1]
    finally:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(PATIENCE)
        finally:
            if process.returncode is None:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()
            process.stdout.close()


async def ros(*command: str, patience: float = PATIENCE) -> str:
    """Run one of ROS's commands to its end; return what it says."""
    code, said = await ended(*command, patience=patience)
    assert code == 0, said
    return said


async def ended(*command: str, patience: float = PATIENCE) -> tuple[int, str]:
    """Run a command to its end, or for `patience` [s]; return its exit code and what it says."""
    process, output = await _begin(command)
    reading = asyncio.create_task(output.read())
    try:
        done, _ = await asyncio.wait({reading}, timeout=patience)
        while not done:  # a program of rospy that is still starting may swallow a signal
            if process.returncode is None:
                process.send_signal(signal.SIGINT)
            done, _ = await asyncio.wait({reading}, timeout=ANSWER)
        said = await reading
        return await process.wait(), said.decode()
    finally:
        reading.cancel()
        if process.returncode is None:
            process.kill()


@asynccontextmanager
async def until_said(words: str, *command: str) -> AsyncIterator[None]:
    """Run one of ROS's commands; the block begins when it says `words`, and ends it."""
    process, output = await _begin(command)
    said = ""
    try:
        async with asyncio.timeout(PATIENCE):
            while words not in said:
                line = (await output.readline()).decode()
                assert line, said
                said += line
        yield
    finally:
        process.send_signal(signal.SIGINT)
        async with asyncio.timeout(PATIENCE):
            await process.communicate()


async def _begin(command: Sequence[str]) -> tuple[asyncio.subprocess.Process, asyncio.StreamReader]:
    """Start a command; return it, and all that it says."""
    process = await asyncio.create_subprocess_exec(
        *command,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        env=unbuffered(),
        start_new_session=True,
    )
    assert process.stdout is not None
    return process, process.stdout


@dataclass(frozen=True, slots=True)
class Program:
    """A running program that reads keys."""

    process: asyncio.subprocess.Process

    async def press(self, keys: str) -> None:
        """Let it read `keys`."""
        assert self.process.stdin is not None
        self.process.stdin.write(keys.encode())
        await self.process.stdin.drain()

    async def line(self) -> str:
        """Return the next line of its output."""
        assert self.process.stdout is not None
        async with asyncio.timeout(PATIENCE):
            return (await self.process.stdout.readline()).decode().rstrip("\n")


@asynccontextmanager
async def program(name: str, *arguments: str) -> AsyncIterator[Program]:
    """Run one of the programs beside this one in ROS's own Python while the block lasts."""
    process = await asyncio.create_subprocess_exec(
        PYTHON,
        str(HERE / name),
        *arguments,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        env=unbuffered(),
        start_new_session=True,
    )
    try:
        yield Program(process)
    finally:
        if process.returncode is None:
            process.send_signal(signal.SIGINT)
        async with asyncio.timeout(PATIENCE):
            await process.communicate(b"")  # which ends its input


async def script(name: str, *arguments: str) -> Any:
    """Run one of the programs beside this one in ROS's own Python; return what it found."""
    return json.loads(await ros(PYTHON, str(HERE / name), *arguments))


def has_ros() -> bool:
    """Whether ROS 1 is installed on this computer."""
    tools = Path("/usr/bin/roscore").exists() and Path(PYTHON).exists()
    return tools and Path("/usr/lib/python3/dist-packages/rospy").is_dir()
