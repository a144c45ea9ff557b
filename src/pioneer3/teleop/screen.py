"""Parts that full screens of a terminal share: their driver, their end, the way of the log."""

import asyncio
import logging
import select
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from queue import Full

from rich.segment import Segment
from textual import events
from textual.app import App
from textual.strip import Strip
from textual.widgets import Static

from pioneer3.names import printable
from pioneer3.tasks import running

if sys.platform == "win32":
    from textual.drivers.windows_driver import WindowsDriver as TerminalDriver
else:
    from textual.drivers.linux_driver import LinuxDriver as TerminalDriver

PATIENCE = 1.0
"""For the last words to a terminal [s]."""
LOOK = 0.1
"""Between two looks whether the terminal is there [s]."""


class PatientDriver(TerminalDriver):
    """Textual's, except that it never waits for the terminal.

    It has `missed` something that was not written if the screen must be drawn anew.
    """

    missed = False

    def write(self, data: str) -> None:
        """Write `data` when the terminal takes it; if too much waits already, never."""
        writer = self._writer_thread
        if writer is None or not writer.is_alive():
            return
        try:
            writer._queue.put_nowait(data)
        except Full:
            self.missed = True

    def close(self) -> None:
        """Wait for the rest to be written, but not for ever."""
        writer = self._writer_thread
        if writer is None or not writer.is_alive():
            return
        try:
            writer._queue.put(None, timeout=PATIENCE)
        except Full:
            return
        writer.join(PATIENCE)


class ScreenPart(Static):
    """A part of a screen; the terminal obeys nothing in its text."""

    def render_line(self, y: int) -> Strip:
        """Draw one line."""
        return obeyed_by_none(super().render_line(y)).adjust_cell_length(self.size.width)


def obeyed_by_none(strip: Strip) -> Strip:
    """Return a line of the screen with escapes for what a terminal would obey."""
    if strip.text.isprintable():
        return strip
    return Strip(Segment(printable(text), style, control) for text, style, control in strip)


async def run_app(app: App[None]) -> None:
    """Show a full screen until it ends, or until its terminal is gone.

    A hang-up does not tell that where it is ignored, as under nohup.
    """
    async with running(_end_without_terminal(app)):
        await app.run_async()


async def _end_without_terminal(app: App[None]) -> None:
    if sys.platform == "win32" or sys.__stdin__ is None:
        return
    terminal = select.poll()
    terminal.register(sys.__stdin__, 0)  # a hang-up is told without being asked for
    while not terminal.poll(0):  # noqa: ASYNC110  no loop of asyncio waits for hang-ups alone
        await asyncio.sleep(LOOK)
    app.post_message(events.AppBlur())  # the robots stand before the screen has ended
    app.exit()


class _Teller(logging.Handler):
    def __init__(self, say: Callable[[str], None]) -> None:
        super().__init__(logging.WARNING)
        self._say = say

    def emit(self, record: logging.LogRecord) -> None:
        self._say(printable(record.getMessage()))


@contextmanager
def log_told_by(say: Callable[[str], None]) -> Iterator[None]:
    """Hand warnings and errors to `say` during the block, and to nobody else."""
    root = logging.getLogger()
    before = root.handlers[:]
    root.handlers[:] = [_Teller(say)]
    try:
        yield
    finally:
        root.handlers[:] = before
