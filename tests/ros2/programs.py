"""Programs that take commands as lines of JSON, and tell what happens in such lines."""

import asyncio
import json
import signal
import subprocess
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager
from dataclasses import dataclass
from typing import Any, TypeVar

from tests.e2e.processes import environment

LINE = 1 << 24
FAREWELL = 5.0
"""Longest wait for a program to end with its input [s]."""
P = TypeVar("P", bound="Program")


@dataclass
class Program:
    """A running program.

    Attributes:
        process: To stop and to kill.
    """

    process: asyncio.subprocess.Process

    def do(self, command: str, **arguments: Any) -> None:
        assert self.process.stdin is not None
        self.process.stdin.write(json.dumps({"do": command, **arguments}).encode() + b"\n")

    def stall(self) -> None:
        self.process.send_signal(signal.SIGSTOP)

    def resume(self) -> None:
        self.process.send_signal(signal.SIGCONT)

    async def kill(self) -> None:
        """End it as a power cut would."""
        self.process.kill()
        await self.process.wait()

    async def listen(self) -> None:
        """Take what it tells, until it ends."""
        assert self.process.stdout is not None
        async for text in self.process.stdout:
            self.take(json.loads(text))

    def take(self, line: dict[str, Any]) -> None:
        """Take a line of it."""
        raise NotImplementedError


@asynccontextmanager
async def program(
    kind: type[P], *command: str, variables: Mapping[str, str] | None = None
) -> AsyncIterator[P]:
    """Run a program during the block, which ends with its input.

    One that is killed while it opens memory that it shares with others leaves what no later
    program gets by: Fast DDS waits for it for ever.
    """
    process = await asyncio.create_subprocess_exec(
        *command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        env=environment() | dict(variables or {}),
        limit=LINE,
    )
    made = kind(process)
    listening = asyncio.ensure_future(made.listen())
    try:
        yield made
    finally:
        assert process.stdin is not None
        process.stdin.close()
        try:
            async with asyncio.timeout(FAREWELL):
                await listening
                await process.wait()
        except TimeoutError:
            process.kill()
            await process.wait()
