"""The process of a command: its event loop, its signals, its output."""

import logging
import signal
import sys
import threading
from collections.abc import Callable, Coroutine, Iterator
from contextlib import closing, contextmanager
from functools import wraps
from types import FrameType
from typing import TYPE_CHECKING, Any, ParamSpec

from pioneer3.names import printable, printable_lines
from pioneer3.runtime.signals import LEAVE

if TYPE_CHECKING:
    from asyncio import AbstractEventLoop

P = ParamSpec("P")


def new_loop() -> "AbstractEventLoop":
    """Return a loop that can wait for sockets, which that of Windows cannot unless asked for."""
    import asyncio

    return asyncio.SelectorEventLoop() if sys.platform == "win32" else asyncio.new_event_loop()


def run_until_told_to_leave(
    command: Coroutine[Any, Any, int | None],
    loop_factory: "Callable[[], AbstractEventLoop]" = new_loop,
) -> int:
    """Run `command`; return its exit code, or 128 + the signal that ended it.

    A hang-up that is ignored, as under nohup, stays ignored. Signals belong to the main thread: a
    command in another one ends by itself.
    """
    with closing(command):  # Ctrl-C may come before it begins
        return _run(command, loop_factory)


def until_told_to_leave(command: Callable[P, Coroutine[Any, Any, int | None]]) -> Callable[P, int]:
    """Make a coroutine function a command, run as :func:`run_until_told_to_leave` does."""

    @wraps(command)
    def run(*args: P.args, **kwargs: P.kwargs) -> int:
        return run_until_told_to_leave(command(*args, **kwargs))

    return run


def _run(
    command: Coroutine[Any, Any, int | None], loop_factory: "Callable[[], AbstractEventLoop]"
) -> int:
    import asyncio  # 40 ms that `--help` need not wait

    received: list[int] = []
    before: dict[int, Any] = {}

    async def guarded() -> int | None:
        task = asyncio.current_task()
        loop = asyncio.get_running_loop()
        assert task is not None

        def leave(number: int, frame: FrameType | None) -> None:
            received.append(number)
            loop.call_soon_threadsafe(task.cancel)

        in_main_thread = threading.current_thread() is threading.main_thread()
        for number in LEAVE if in_main_thread else ():
            if number.name != "SIGHUP" or signal.getsignal(number) is not signal.SIG_IGN:
                before[number] = signal.signal(number, leave) or signal.SIG_DFL
        try:
            return await command
        finally:
            for each, handler in before.items():
                signal.signal(each, handler)

    try:
        with asyncio.Runner(loop_factory=loop_factory) as runner:
            code = runner.run(guarded()) or 0
    except asyncio.CancelledError:
        if not received:
            raise
        code = 0
    return 128 + received[0] if received else code


DIGITS = 6
"""After the point of numbers in JSON."""


async def read_line() -> str:
    """Return a line of stdin; unlike `input` in a thread, this can be interrupted."""
    import asyncio

    loop, ready = asyncio.get_running_loop(), asyncio.Event()
    try:
        loop.add_reader(sys.stdin.fileno(), ready.set)
    except OSError:  # a file, which never makes anybody wait
        return sys.stdin.readline()
    try:
        await ready.wait()
    finally:
        loop.remove_reader(sys.stdin.fileno())
    return sys.stdin.readline()


def ask(question: str, otherwise: str) -> str:
    """Return the answer of a person at the terminal; Enter takes the one in brackets."""
    shown = f" [{otherwise}]" if otherwise else ""
    write_error(f"{question}{shown}: ", end="")
    line = sys.stdin.readline()
    if not line:
        write_error("")
    return line.strip() or otherwise


def write_line(text: str) -> None:
    """Write lines to stdout, at once; BrokenPipeError if nobody reads any more."""
    _write(f"{printable_lines(text)}\n")


def rewrite_line(text: str) -> None:
    """Write over the live line of a terminal, without an end of line."""
    _write(f"\r\x1b[K{printable(text)}")


def _write(text: str) -> None:
    sys.stdout.write(text)
    sys.stdout.flush()


def write_error(text: str, end: str = "\n") -> None:
    """Write lines to stderr, at once; a terminal obeys nothing in them."""
    print(printable_lines(text), end=end, file=sys.stderr, flush=True)  # noqa: T201


def write_warning(text: str) -> None:
    """Write one line to stderr."""
    write_error(f"WARNING: {text}")


class LogFormatter(logging.Formatter):
    """Formats each record as one line, and a traceback below it; a terminal obeys neither."""

    def formatMessage(self, record: logging.LogRecord) -> str:  # noqa: N802
        """Return the line."""
        return printable(super().formatMessage(record))

    def formatException(self, ei: Any) -> str:  # noqa: N802
        """Return the traceback."""
        return printable_lines(super().formatException(ei))


def write_json(value: object, *, indent: int | None = None) -> None:
    """Write `value`, made of dataclasses and plain types, as JSON.

    Infinity and NaN are null; digits beyond a millionth are rounding, and left out. JSON has
    escapes of its own for what a terminal would obey.
    """
    import json

    import msgspec

    data = msgspec.json.encode(_rounded(msgspec.to_builtins(value)))
    text = (msgspec.json.format(data, indent=indent) if indent else data).decode()
    _write("".join(c if c.isprintable() or c == "\n" else json.dumps(c)[1:-1] for c in text) + "\n")


def _rounded(value: object) -> object:
    match value:
        case float():
            return round(value, DIGITS) + 0.0  # no -0.0
        case dict():
            return {key: _rounded(item) for key, item in value.items()}
        case list() | tuple():
            return [_rounded(item) for item in value]
    return value


@contextmanager
def busy_sign(text: str) -> Iterator[Callable[[str], None]]:
    """Show on stderr, if that is a terminal, that something is going on.

    The function that it yields replaces the text.
    """
    if not sys.stderr.isatty():
        yield lambda text: None
        return
    from pioneer3.cli.terminal import Terminal

    with Terminal(stderr=True).status(text) as status:
        yield status.update
