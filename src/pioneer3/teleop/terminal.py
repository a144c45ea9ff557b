"""Keys from a terminal as they are pressed; the terminal is restored on every way out."""

import asyncio
import os
import re
import sys
from collections.abc import AsyncGenerator, AsyncIterator, Iterator
from contextlib import aclosing, contextmanager, suppress

from pioneer3.errors import ConfigError
from pioneer3.teleop.keyboard import Key

try:
    import termios
    import tty
except ImportError:  # Windows
    termios = None  # type: ignore[assignment]

ESCAPE = "\x1b"
ENDS = {"A": Key.FORWARD, "B": Key.BACK, "C": Key.RIGHT, "D": Key.LEFT}
ARROWS = {f"{ESCAPE}{form}{end}": key for form in "[O" for end, key in ENDS.items()}
"""Keys by the text that a terminal sends for an arrow, whichever of its two modes it is in."""
SEQUENCES = {
    **ARROWS,
    "w": Key.FORWARD,
    "s": Key.BACK,
    "d": Key.RIGHT,
    "a": Key.LEFT,
    " ": Key.STOP,
    "+": Key.FASTER,
    "=": Key.FASTER,
    "-": Key.SLOWER,
    "m": Key.MOTORS,
    "k": Key.EMERGENCY,
    "\x12": Key.RESET,  # Ctrl-R
    "q": Key.QUIT,
    ESCAPE: Key.QUIT,
    "\x04": Key.QUIT,
}
TOKEN = re.compile(r"\x1b(?:\[[0-?]*[ -/]*[@-~]|O[ -~])|.", re.DOTALL)
"""An escape sequence, known or not, or else one character (ECMA-48, 5.4)."""
UNFINISHED = re.compile(r"\x1b(?:\[[0-?]*[ -/]*|O)?\Z")
"""The beginning of a sequence at the end of a text."""
PATIENCE = 0.05
"""How long the rest of a sequence is waited for [s]: networks may cut it in two."""


def keys_in(text: str) -> Iterator[Key]:
    """Yield the keys in a text that a terminal sent.

    A character without a meaning stops the robot: people in a hurry hit any key. Sequences
    without one are skipped, since terminals send some by themselves. An ESC that begins no
    sequence is the key.
    """
    for token in TOKEN.findall(text):
        key = SEQUENCES.get(token if len(token) > 1 else token.lower())
        if key is not None:
            yield key
        elif token.isprintable():
            yield Key.STOP


def is_in_front() -> bool:
    """Return whether standard input is a terminal whose keys are for this program.

    In a shell's background the first look at a key would halt it.
    """
    if termios is None or sys.stdin is None or not sys.stdin.isatty():
        return False
    try:
        return os.tcgetpgrp(sys.stdin.fileno()) == os.getpgrp()
    except OSError:  # a terminal that controls no session: nobody is halted
        return True


@contextmanager
def raw_terminal() -> Iterator[int]:
    """Take keys as they are pressed; Ctrl-C stays a signal. Yield the descriptor to read from.

    Raises:
        ConfigError: standard input is not a terminal, or this system has none of this kind.
    """
    if sys.stdin is None or not sys.stdin.isatty():
        raise ConfigError("driving with the keyboard needs a terminal; standard input is none")
    if termios is None:
        raise ConfigError("keys are read on Linux and macOS only; the page of `run` takes them")
    descriptor = sys.stdin.fileno()
    before = termios.tcgetattr(descriptor)
    try:
        tty.setcbreak(descriptor)
        _show_cursor(shown=False)
        yield descriptor
    finally:
        with suppress(termios.error, OSError):  # a terminal that was closed
            termios.tcsetattr(descriptor, termios.TCSADRAIN, before)
            _show_cursor(shown=True)


def _show_cursor(*, shown: bool) -> None:
    if sys.stdout is not None and sys.stdout.isatty():
        sys.stdout.write("\x1b[?25h\n" if shown else "\x1b[?25l")
        sys.stdout.flush()


async def keys(descriptor: int) -> AsyncIterator[Key]:
    """Yield keys that mean something as they are pressed; ends when the terminal goes away."""
    async with aclosing(tokens(descriptor)) as pressed:
        async for token in pressed:
            for key in keys_in(token):
                yield key


async def tokens(descriptor: int) -> AsyncGenerator[str, None]:
    """Yield the text of each key, a character or an escape sequence; ends with the terminal."""
    with chunks_of(descriptor) as chunks:
        while chunk := await chunks.get():
            while UNFINISHED.search(chunk.decode("utf-8", "ignore")):
                if not (rest := await _soon(chunks)):
                    break
                chunk += rest
            for token in TOKEN.findall(chunk.decode("utf-8", "ignore")):
                yield token


@contextmanager
def chunks_of(descriptor: int) -> Iterator[asyncio.Queue[bytes]]:
    """Yield a queue of the bytes that come during the block; after the end, of empty chunks."""
    loop, chunks = asyncio.get_running_loop(), asyncio.Queue[bytes]()

    def ready() -> None:
        try:
            chunk = os.read(descriptor, 4096)
        except BlockingIOError:
            return
        except OSError:  # hung up, unplugged
            chunk = b""
        chunks.put_nowait(chunk)

    loop.add_reader(descriptor, ready)
    try:
        yield chunks
    finally:
        loop.remove_reader(descriptor)


async def _soon(chunks: asyncio.Queue[bytes]) -> bytes:
    """Return the bytes that come within :data:`PATIENCE`, or none."""
    try:
        async with asyncio.timeout(PATIENCE):
            return await chunks.get()
    except TimeoutError:
        return b""
