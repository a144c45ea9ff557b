"""Runs a command's coroutine so that every signal to leave passes its `finally` blocks."""

import signal
import sys
from collections.abc import Coroutine
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from asyncio import AbstractEventLoop

LEAVE = tuple(
    signal.Signals[name]
    for name in ("SIGINT", "SIGTERM", "SIGHUP")
    if name in signal.Signals.__members__  # Windows has two of them
)


def new_loop() -> "AbstractEventLoop":
    """Return a loop that can wait for sockets, which that of Windows cannot unless asked for."""
    import asyncio  # noqa: PLC0415

    return asyncio.SelectorEventLoop() if sys.platform == "win32" else asyncio.new_event_loop()


def run_until_told_to_leave(command: Coroutine[Any, Any, int | None]) -> int:
    """Run `command`; return its exit code, or 128 + signal after SIGINT, SIGTERM or SIGHUP."""
    import asyncio  # noqa: PLC0415  40 ms that `--help` need not wait

    received: list[int] = []

    async def guarded() -> int | None:
        task = asyncio.current_task()
        assert task is not None

        def leave(number: int) -> None:
            received.append(number)
            task.cancel()

        loop = asyncio.get_running_loop()
        for number in LEAVE:
            try:
                loop.add_signal_handler(number, leave, number)
            except NotImplementedError:  # Windows
                signal.signal(number, lambda n, _: loop.call_soon_threadsafe(leave, n))
        return await command

    try:
        with asyncio.Runner(loop_factory=new_loop) as runner:
            code = runner.run(guarded()) or 0
    except asyncio.CancelledError:
        if not received:
            raise
        code = 0
    return 128 + received[0] if received else code
