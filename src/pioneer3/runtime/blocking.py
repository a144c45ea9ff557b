"""Connections for scripts and notebooks, without `await`; lasers."""

import asyncio
import atexit
from contextlib import AbstractAsyncContextManager, AsyncExitStack
from pathlib import Path
from typing import Any, Self, cast

from pioneer3.runtime.connect import connect_laser_async
from pioneer3.runtime.facade import Facade, LoopThread, adapted
from pioneer3.runtime.signals import StopOnSignals
from pioneer3.state import Scan


def connect_laser(url: str, *, record: Path | bool = False) -> "BlockingLaser":
    """Connect to a laser range finder alone, and wait for its first scan.

    Use it in a `with` block, or call :meth:`BlockingLaser.close` at the end. Arguments and errors
    are those of :func:`pioneer3.connect_laser_async`.
    """
    return BlockingLaser(connect_laser_async(url, record=record))


class BlockingConnection(Facade):
    """A connection on an event loop in a thread of its own."""

    def __init__(self, connection: AbstractAsyncContextManager[Any]) -> None:
        super().__init__(None, LoopThread())
        self._stack = AsyncExitStack()
        self._closed = False
        self._ended_by: BaseException | None = None
        atexit.register(self.close)
        self._signals = StopOnSignals(self._thread.loop, self._stand, self._close_on_signal)
        self._signals.__enter__()
        try:
            self._target = self._thread.wait(self._stack.enter_async_context(connection))
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        self._ended_by = error
        self.close()

    def close(self) -> None:
        """End the session, a robot stops; safe to call twice, and in any thread.

        In a process that was forked from the one that connected it does nothing.
        """
        if self._closed:
            return
        self._closed = True
        if not self._thread.is_ours:
            return
        atexit.unregister(self.close)
        try:
            self._thread.end(self._leave())
        finally:
            self._signals.__exit__()

    def _close_on_signal(self) -> None:
        self._ended_by = SystemExit()
        self.close()

    def _stand(self) -> None:
        """Let stand what moves; called in the loop."""

    async def _leave(self) -> None:
        """End the session, also one that was interrupted before it began.

        The connection is told the error that ended the block, as `async with` tells it.
        """
        error = self._ended_by
        trace = None if error is None else error.__traceback__
        await self._stack.__aexit__(None if error is None else type(error), error, trace)
        tasks = asyncio.all_tasks() - {asyncio.current_task()}
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


class BlockingLaser(BlockingConnection):
    """A laser range finder, without a robot, on an event loop in a thread of its own."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        return getattr(adapted(self._target, self._thread), name)

    @property
    def latest(self) -> Scan | None:
        """The last scan; look at its stamp."""
        return cast("Scan | None", self._read("latest"))
