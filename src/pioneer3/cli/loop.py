"""Runs a command's coroutine so that every signal to leave passes its `finally` blocks."""

import signal
from collections.abc import Coroutine
from typing import Any

LEAVE = (signal.SIGTERM, signal.SIGHUP)


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

        for number in (*LEAVE, signal.SIGINT):
            asyncio.get_running_loop().add_signal_handler(number, leave, number)
        return await command

    try:
        code = asyncio.run(guarded()) or 0
    except asyncio.CancelledError:
        if not received:
            raise
        code = 0
    return 128 + received[0] if received else code
