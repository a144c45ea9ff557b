"""The demo as lines of text, for pipes and screen readers."""

import asyncio
import os
from collections.abc import AsyncGenerator, Callable
from contextlib import aclosing

from pioneer3.demo.program import Program, named
from pioneer3.teleop.terminal import TOKEN, tokens

EVERY = 1.0
"""Between two looks at the robot [s]: nobody can listen faster."""


class Plain:
    """Writes ARIA's lines: the help when a mode begins, its header, then changes."""

    def __init__(self, write: Callable[[str], None]) -> None:
        self._write = write
        self._program: Program | None = None
        self._header = self._line = ""
        self._details: list[str] = []

    def serve(self, program: Program) -> None:
        """Show `program` from now on."""
        self._program = program

    def say(self, text: str) -> None:
        """Write a sentence."""
        self._write(text)

    def show_help(self) -> None:
        """Write which keys there are."""
        assert self._program is not None
        for line in self._program.help():
            self._write(line)

    def show_mode(self) -> None:
        """Write the help of the new mode; its header comes with its first line."""
        self._header, self._line, self._details = "", "", []
        self.show_help()

    def look(self) -> None:
        """Write the changes."""
        program = self._program
        assert program is not None
        details = list(program.details())
        if details != self._details:
            self._details = details
            for line in details:
                self._write(line)
        row = program.row()
        if row is None:
            return
        if row.cells and row.header != self._header:
            self._header = row.header
            self._write(row.header)
        if row.line != self._line:
            self._line = row.line
            self._write(row.line)


async def serve_plain(program: Program, face: Plain, pressed: AsyncGenerator[str, None]) -> None:
    """Serve until `pressed` ends or a key quits."""
    face.serve(program)

    async def listen() -> None:
        async with aclosing(pressed):
            async for token in pressed:
                program.press(named(token))
        face.look()
        program.over.set()

    async def look() -> None:
        while True:
            await asyncio.sleep(EVERY)
            face.look()

    tasks = [asyncio.ensure_future(listen()), asyncio.ensure_future(look())]
    try:
        await program.run()
    finally:
        for task in tasks:
            task.cancel()
        for ended in await asyncio.gather(*tasks, return_exceptions=True):
            if isinstance(ended, Exception):
                raise ended


async def typed(descriptor: int) -> AsyncGenerator[str, None]:
    """Yield the keys from a terminal, a pipe or a file."""
    try:
        async with aclosing(tokens(descriptor)) as source:
            async for token in source:
                yield token
    except PermissionError:  # a file is always ready: the event loop will not wait for it
        for token in TOKEN.findall(_whole(descriptor)):
            yield token


def _whole(descriptor: int) -> str:
    parts = []
    while part := os.read(descriptor, 65536):
        parts.append(part)
    return b"".join(parts).decode("utf-8", "ignore")
