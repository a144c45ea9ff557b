"""Background tasks of a block, calls in threads, and an event loop that does not wait."""

import asyncio
import logging
import selectors
from collections.abc import AsyncIterator, Callable, Coroutine, Iterable
from contextlib import asynccontextmanager, suppress
from functools import partial
from math import floor
from threading import Thread
from typing import Any, TypeVar

T = TypeVar("T")
log = logging.getLogger(__name__)

ROUNDING = 1e-6
"""A tick that is nearer than this share of a period is the present one."""


@asynccontextmanager
async def running(*coroutines: Coroutine[Any, Any, None]) -> AsyncIterator[None]:
    """Run `coroutines` beside the block, and cancel them at its end.

    Unlike a `TaskGroup`, it does not wrap the block's own exceptions.

    Raises:
        Exception: that of the first one to fail; the block has been cancelled.
    """
    owner = asyncio.current_task()
    assert owner is not None
    failures: list[BaseException] = []
    leaving = False

    def note(task: "asyncio.Task[None]") -> None:
        failure = None if task.cancelled() else task.exception()
        if failure is None or leaving:
            return
        if owner.done():  # another task left the block, as in the blocking facade
            log.error("the work in the background failed", exc_info=failure)
        failures.append(failure)
        owner.cancel()

    tasks = [asyncio.create_task(coroutine) for coroutine in coroutines]
    for task in tasks:
        task.add_done_callback(note)
    try:
        await asyncio.sleep(0)  # a task that is cancelled before it began runs no `finally`
        yield
    except asyncio.CancelledError:
        if failures and owner.uncancel() == 0:
            raise failures[0] from None
        raise
    finally:
        leaving = True
        await cancelled(tasks)


async def cancelled(tasks: Iterable["asyncio.Future[Any]"]) -> None:
    """Cancel tasks; return when all have ended."""
    several = list(tasks)
    for task in several:
        task.cancel()
    await asyncio.gather(*several, return_exceptions=True)


async def next_tick(period: float) -> None:
    """Wait for the next multiple of `period` [s] of the loop's clock.

    Tasks whose periods divide each other wake up together: waking up costs more than what most do.
    """
    now = asyncio.get_running_loop().time()
    ticks = floor(now / period + ROUNDING) + 1
    await asyncio.sleep(ticks * period - now)


def hand_over(
    loop: asyncio.AbstractEventLoop, call: Callable[..., object], *arguments: object
) -> None:
    """Have `loop` make a call, from any thread; one that has ended makes none."""
    with suppress(RuntimeError):
        loop.call_soon_threadsafe(call, *arguments)


async def in_own_thread(call: Callable[[], T]) -> T:
    """Return the result of a call in a thread of its own.

    Calls that hang take no thread from others, and do not hold up the end of the program, as those
    of :func:`asyncio.to_thread` would. Cancelled, it does not wait for the call.
    """
    loop = asyncio.get_running_loop()
    future: asyncio.Future[T] = loop.create_future()

    def settle(setter: Callable[[], None]) -> None:
        if not future.done():
            setter()

    def run() -> None:
        try:
            result = call()
        except Exception as error:
            setter = partial(future.set_exception, error)
        else:
            setter = partial(future.set_result, result)
        hand_over(loop, settle, setter)

    Thread(target=run, name="pioneer3-call", daemon=True).start()
    return await future


class _Jumping(selectors.DefaultSelector):
    """Jumps to the next timer where nothing can be read."""

    now = 0.0

    def select(self, timeout: float | None = None) -> list[Any]:
        """Return the files that are ready now; wait only where no timer is set."""
        ready = super().select(None if timeout is None else 0)
        if not ready and timeout is not None and timeout > 0:
            self.now += timeout
        return ready


class FastTimeLoop(asyncio.SelectorEventLoop):
    """An event loop whose clock jumps from timer to timer, to play recordings without waiting.

    Its time begins at `begin` [s].
    """

    def __init__(self, begin: float = 0.0) -> None:
        self._jumping = _Jumping()
        self._jumping.now = begin
        super().__init__(self._jumping)

    def time(self) -> float:
        """Return the time [s]."""
        return self._jumping.now
