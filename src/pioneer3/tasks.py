"""Background tasks that run for the duration of a block."""

import asyncio
import logging
from collections.abc import AsyncIterator, Coroutine
from contextlib import asynccontextmanager
from typing import Any

log = logging.getLogger(__name__)


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
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
