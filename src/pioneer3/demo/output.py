"""A terminal that is gone, or takes nothing any more, must not hold up what drives the robot."""

import sys
from queue import Full

if sys.platform == "win32":
    from textual.drivers.windows_driver import WindowsDriver as TerminalDriver
else:
    from textual.drivers.linux_driver import LinuxDriver as TerminalDriver

PATIENCE = 1.0
"""For the last words to a terminal [s]."""


class PatientDriver(TerminalDriver):
    """Textual's, except that it never waits for the terminal.

    Attributes:
        missed: Whether something was not written, so that the screen must be drawn anew.
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
        """Wait for what is still to be written, but not for ever."""
        writer = self._writer_thread
        if writer is None or not writer.is_alive():
            return
        try:
            writer._queue.put(None, timeout=PATIENCE)
        except Full:
            return
        writer.join(PATIENCE)
