"""The robot of a managed node: connected when configured, driven when active.

One task makes the transitions: the needs of a state are blocks that begin and end there.
"""

import asyncio
from collections.abc import Callable, Coroutine
from concurrent.futures import CancelledError
from contextlib import AbstractAsyncContextManager
from functools import partial
from typing import Any

from pioneer3.errors import PioneerError
from pioneer3.ros.ros2.lifecycle import Callbacks, Lifecycle, LifecycleState
from pioneer3.runtime.robot import Robot
from pioneer3.tasks import running

Run = Callable[[Robot, Callable[[], None]], Coroutine[Any, Any, None]]


class _Request:
    """A request for the work of a state; a thread waits for its end."""

    def __init__(self, work: LifecycleState) -> None:
        self.work = work
        self.result: asyncio.Future[bool] = asyncio.get_running_loop().create_future()

    def end(self, *, succeeded: bool = True) -> None:
        """Tell the thread the result; only the first one counts."""
        if not self.result.done():
            self.result.set_result(succeeded)


class ManagedRobot:
    """Makes the transitions of a :class:`Lifecycle`.

    `run` publishes and drives until cancelled, and calls its second argument when it is ready; then
    the robot stands. `tell` is given lines for a person.
    """

    def __init__(
        self,
        connected: Callable[[], AbstractAsyncContextManager[Robot]],
        run: Run,
        tell: Callable[[str], None],
    ) -> None:
        self._connected, self._run, self._tell = connected, run, tell
        self._loop = asyncio.get_running_loop()
        self._requests: asyncio.Queue[_Request] = asyncio.Queue()
        self._must_start = False

    @property
    def callbacks(self) -> Callbacks:
        """The work of each state but that after errors, for threads other than the loop's."""
        last = LifecycleState.DEACTIVATING
        states = [each for each in LifecycleState if LifecycleState.CONFIGURING <= each <= last]
        return {work: partial(self._ask, work) for work in states}

    async def serve(self, lifecycle: Lifecycle, *, autostart: bool) -> None:
        """Make the transitions that are asked for, until cancelled; with `autostart` the first two.

        Raises:
            PioneerError: the robot cannot be reached at the automatic start, or is lost for good.
        """
        self._must_start = autostart
        first = ("configure", "activate") if autostart else ()

        async def begin() -> None:
            for label in first:
                if not await asyncio.to_thread(lifecycle.trigger, label):
                    return

        async with running(begin()):
            if not autostart:
                self._tell("unconfigured: waits for `configure`, as from ros2 lifecycle set")
            request = await self._unconfigured()
            request.end()
            self._tell("finalized: does nothing any more; Ctrl-C ends it")
            await asyncio.Event().wait()

    def _ask(self, work: LifecycleState) -> bool:
        """Have the loop do the work of a state; return whether it succeeded."""
        waiting = self._wait_for(work)
        try:
            return asyncio.run_coroutine_threadsafe(waiting, self._loop).result()
        except CancelledError:  # the program ends
            return False
        except RuntimeError:  # it has ended
            waiting.close()
            return False

    async def _wait_for(self, work: LifecycleState) -> bool:
        request = _Request(work)
        self._requests.put_nowait(request)
        return await request.result

    async def _unconfigured(self) -> _Request:
        """Connect the robot when asked to; return the request to shut down."""
        while (request := await self._requests.get()).work is LifecycleState.CONFIGURING:
            begun = False
            try:
                async with self._connected() as robot:
                    begun = True
                    request.end()
                    request = await self._inactive(robot)
            except PioneerError as error:
                request.end(succeeded=False)
                if begun or self._must_start:
                    raise
                self._tell(f"not configured: {error}")
                continue
            if request.work is LifecycleState.SHUTTINGDOWN:
                return request
            request.end()
            self._tell("unconfigured: the robot is free for other programs")
        return request

    async def _inactive(self, robot: Robot) -> _Request:
        """Publish and drive when asked to; return the request that leaves the robot."""
        while (request := await self._requests.get()).work is LifecycleState.ACTIVATING:
            begin = partial(self._begin, request)
            try:
                async with running(self._run(robot, begin)):
                    request = await self._requests.get()
            except PioneerError as error:
                begun = request.result.done()
                request.end(succeeded=False)
                if begun or self._must_start:
                    raise
                self._tell(f"not activated: {error}")
                continue
            if request.work is LifecycleState.SHUTTINGDOWN:
                return request
            request.end()
            self._tell("inactive: the robot stands; waits for `activate` or `cleanup`")
        return request

    def _begin(self, request: _Request) -> None:
        self._must_start = False
        request.end()
