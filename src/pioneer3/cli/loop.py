"""Runs a command's coroutine so that every signal to leave passes its `finally` blocks."""

import signal
import sys
from collections.abc import Coroutine
from types import FrameType
from typing import TYPE_CHECKING, Any

from pioneer3.runtime.signals import LEAVE

if TYPE_CHECKING:
    from asyncio import AbstractEventLoop


def new_loop() -> "AbstractEventLoop":
    """Return a loop that can wait for sockets, which that of Windows cannot unless asked for."""
    import asyncio  # noqa: PLC0415

    return asyncio.SelectorEventLoop() if sys.platform == "win32" else asyncio.new_event_loop()


def run_until_told_to_leave(command: Coroutine[Any, Any, int | None]) -> int:
    """Run `command`; return its exit code, or 128 + the signal that ended it.

    A hang-up that is ignored, as under nohup, stays ignored.
    """
    import asyncio  # noqa: PLC0415  40 ms that `--help` need not wait

    received: list[int] = []
    before: dict[int, Any] = {}

    async def guarded() -> int | None:
        task = asyncio.current_task()
        loop = asyncio.get_running_loop()
        assert task is not None

        def leave(number: int, frame: FrameType | None) -> None:
            received.append(number)
            loop.call_soon_threadsafe(task.cancel)

        for number in LEAVE:
            if number.name != "SIGHUP" or signal.getsignal(number) is not signal.SIG_IGN:
                before[number] = signal.signal(number, leave) or signal.SIG_DFL
        try:
            return await command
        finally:
            for each, handler in before.items():
                signal.signal(each, handler)

    try:
        with asyncio.Runner(loop_factory=new_loop) as runner:
            code = runner.run(guarded()) or 0
    except asyncio.CancelledError:
        if not received:
            raise
        code = 0
    return 128 + received[0] if received else code
