"""A person at a terminal of the operator's computer."""

import fcntl
import os
import pty
import re
import select
import struct
import subprocess
import termios
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import Final

from tests.fleet.lab import PATIENCE, Operator

KEYS: Final = {
    "up": "\x1b[A",
    "down": "\x1b[B",
    "right": "\x1b[C",
    "left": "\x1b[D",
    "space": " ",
    "Ctrl-C": "\x03",
    "Ctrl-D": "\x04",
    "Ctrl-R": "\x12",
}
"""What a terminal sends for keys that documents name by words."""
_SEQUENCE: Final = re.compile(
    r"\x1b\[([0-9;]*)([HfJK])|(\r)|(\n)"
    r"|\x1b(?:\[[0-?]*[ -/]*[@-~]|\][^\x07\x1b]*(?:\x07|\x1b\\)|[^\[\]])"
)
"""Moves of the cursor, and other escape sequences."""
COLUMNS, ROWS = 120, 40


class Terminal:
    """A terminal in which one command runs.

    Attributes:
        process: The command.
        text: All that the terminal has been sent, without escape sequences.
    """

    def __init__(self, process: "subprocess.Popen[bytes]", keyboard: int) -> None:
        self.process = process
        self._keyboard = keyboard
        self._waiting = ""
        self._picture = Picture()
        self.text = ""

    def type(self, text: str) -> None:
        """Send text as the keyboard does."""
        os.write(self._keyboard, text.encode())

    def press(self, key: str) -> None:
        """Press a key by the word for it."""
        self.type(KEYS.get(key, key))

    def hold(self, key: str, seconds: float) -> None:
        """Hold a key, which repeats, for so long."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.press(key)
            self.read(0.1)

    def read(self, seconds: float = 0.0) -> bool:
        """Read what comes within so long; return whether the terminal is open still."""
        end = time.monotonic() + seconds
        while True:
            ready, _, _ = select.select([self._keyboard], [], [], max(0.0, end - time.monotonic()))
            if not ready:
                return True
            try:
                data = os.read(self._keyboard, 65536)
            except OSError:  # the last program at the terminal has ended
                return False
            self._show(data.decode(errors="replace"))

    @property
    def screen(self) -> list[str]:
        """The lines that the terminal shows, by the escape sequences that place text."""
        return self._picture.lines

    def _show(self, data: str) -> None:
        """Take what came; the beginning of a sequence waits for its rest."""
        data = self._waiting + data
        begin = data.rfind("\x1b")
        if begin >= 0 and not _SEQUENCE.match(data, begin):
            data, self._waiting = data[:begin], data[begin:]
        else:
            self._waiting = ""
        self.text += self._picture.draw(data)

    @property
    def unfinished(self) -> str:
        """The last line, which has no end yet."""
        return self.text.rpartition("\n")[2]

    def until(self, holds: Callable[[], object], patience: float = PATIENCE) -> None:
        """Read until something holds."""
        end = time.monotonic() + patience
        while not holds():
            self.read(0.05)
            assert time.monotonic() < end, self.text[-3000:]

    def sees(self, words: str, since: int = 0) -> None:
        """Read until the text has `words` after its first `since` characters."""
        self.until(lambda: words in self.text[since:])

    def code(self, patience: float = PATIENCE) -> int:
        """Read to the end; return the exit code."""
        end = time.monotonic() + patience
        while self.process.poll() is None:
            self.read(0.05)
            assert time.monotonic() < end, self.text[-3000:]
        self.read()
        assert self.process.returncode is not None
        return self.process.returncode


class Picture:
    """The characters that a terminal shows."""

    def __init__(self) -> None:
        self._rows = [[" "] * COLUMNS for _ in range(ROWS)]
        self._row = self._column = 0

    @property
    def lines(self) -> list[str]:
        """The rows, without the spaces at their ends."""
        return ["".join(row).rstrip() for row in self._rows]

    def draw(self, data: str) -> str:
        """Draw text with complete escape sequences; return the text without them."""
        at, plain = 0, []
        for found in _SEQUENCE.finditer(data):
            plain.append(self._write(data[at : found.start()]))
            at = found.end()
            numbers, move, home, down = found.groups()
            if home:
                self._column = 0
            elif down:
                self._row += 1
                plain.append("\n")
            elif move:
                self._obey(move, numbers)
        plain.append(self._write(data[at:]))
        return "".join(plain)

    def _obey(self, move: str, numbers: str) -> None:
        if move in {"H", "f"}:
            row, _, column = numbers.partition(";")
            self._row, self._column = int(row or 1) - 1, int(column or 1) - 1
        elif move == "K" and self._row < ROWS:
            self._rows[self._row][self._column :] = [" "] * max(0, COLUMNS - self._column)
        elif move == "J" and numbers == "2":
            self._rows = [[" "] * COLUMNS for _ in range(ROWS)]

    def _write(self, text: str) -> str:
        for letter in text:
            if self._row < ROWS and self._column < COLUMNS and letter.isprintable():
                self._rows[self._row][self._column] = letter
            self._column += 1
        return text


@contextmanager
def terminal(operator: Operator, line: str) -> Iterator[Terminal]:
    """Run a line of the shell in a terminal during the block; it is killed in the end."""
    keyboard, screen = pty.openpty()
    fcntl.ioctl(screen, termios.TIOCSWINSZ, struct.pack("HHHH", ROWS, COLUMNS, 0, 0))
    environment = {**operator.environment, "TERM": "xterm-256color", "COLUMNS": str(COLUMNS)}
    process = subprocess.Popen(
        operator.in_lab("setsid", "--ctty", "--wait", "bash", "-c", f"exec {line}"),
        stdin=screen,
        stdout=screen,
        stderr=screen,
        env=environment,
        start_new_session=True,
    )
    os.close(screen)
    try:
        yield Terminal(process, keyboard)
    finally:
        os.close(keyboard)  # hangs up
        try:
            process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            with suppress(ProcessLookupError):
                process.kill()
            process.wait()


def converse(the: Terminal, lines: Sequence[str], secret: str) -> None:
    """Answer each question of a command as a document does, and check what it shows.

    A line of the document that begins with a question has the answer behind it. Later questions of
    the same words get the same answer once the document has no more of them, where it says `...`.

    Args:
        the: Where the command runs.
        lines: Of the document, below the command.
        secret: Typed in place of the stars in the document.
    """
    waiting = [line.rstrip() for line in lines]
    answers: dict[str, str] = {}
    while the.process.poll() is None:
        the.read(0.1)
        question = the.unfinished
        if not question.endswith((": ", "] ")):
            continue
        found = next((line for line in waiting if f"{line} ".startswith(question)), None)
        if found is not None:
            waiting.remove(found)
            answers[question] = found[len(question.rstrip()) :].strip()
        assert question in answers, f"the document has no answer to {question!r}"
        answer = answers[question]
        the.type((secret if set(answer) == {"*"} else answer) + "\n")
        shown = len(the.text)
        the.until(lambda before=shown: "\n" in the.text[before:])  # type: ignore[misc]
    asked = [line for line in waiting if line.endswith("]:") or "? " in line]
    assert not asked, f"the command did not ask: {asked}"
