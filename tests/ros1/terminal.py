"""A terminal of its own in which a command runs."""

import asyncio
import os
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass

from tests.e2e.at_terminal import begin, open_terminal
from tests.e2e.processes import PATIENCE, until


@dataclass
class Terminal:
    """What is typed and shown.

    Attributes:
        process: The command.
        keyboard: Descriptor.
        screen: Everything the terminal has shown.
    """

    process: asyncio.subprocess.Process
    keyboard: int
    screen: bytes = b""

    def type(self, keys: bytes) -> None:
        """Press keys."""
        os.write(self.keyboard, keys)

    async def shows(self, text: bytes) -> None:
        """Wait until the screen has shown `text`."""
        await until(lambda: text in self.screen)

    async def code(self) -> int:
        """Wait for the end; return the exit code."""
        async with asyncio.timeout(PATIENCE):
            return await self.process.wait()

    def read(self) -> None:
        """Take what the command writes."""
        with suppress(OSError):
            self.screen += os.read(self.keyboard, 65536)


@asynccontextmanager
async def terminal(*arguments: str) -> AsyncIterator[Terminal]:
    """Run `pioneer3` with `arguments` in a terminal while the block lasts."""
    keyboard, screen = open_terminal()
    process = await begin(screen, *arguments)
    the = Terminal(process, keyboard)
    loop = asyncio.get_running_loop()
    loop.add_reader(keyboard, the.read)
    try:
        yield the
    finally:
        if process.returncode is None:
            process.kill()
            await process.wait()
        loop.remove_reader(keyboard)
        os.close(keyboard)
        os.close(screen)
