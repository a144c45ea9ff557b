"""The robot for scripts and notebooks: the same, without `await`."""

import asyncio
import atexit
import os
import threading
from collections.abc import AsyncIterator, Callable, Coroutine, Iterator
from concurrent.futures import wait
from contextlib import AsyncExitStack
from math import inf
from pathlib import Path
from types import TracebackType
from typing import Any, TypeVar

from pioneer3.arcos.commands import Command
from pioneer3.behaviors.stack import Stack
from pioneer3.models import RobotModel
from pioneer3.robot.supervisor import RobotInfo
from pioneer3.runtime.connect import connect_async
from pioneer3.runtime.robot import Robot
from pioneer3.runtime.signals import StopOnSignals
from pioneer3.state import Snapshot

T = TypeVar("T")

CLOSE_PATIENCE = 3.0
"""For the end of a session [s]: the link has 0.5 s to take the farewell and 0.5 s to close."""


def connect(
    url: str,
    *,
    baud: int | None = None,
    model: RobotModel | None = None,
    max_speed: float | None = None,
    max_turn_rate: float | None = None,
    auto_enable: bool = True,
    record: Path | None = None,
) -> "BlockingRobot":
    """Connect to a robot or simulator, and wait until it says something.

    Use it in a `with` block: every way out of the block stops the robot. In a notebook, call
    :meth:`BlockingRobot.close` at the end. Arguments and errors are those of
    :func:`pioneer3.connect_async`.
    """
    return BlockingRobot(
        url,
        baud=baud,
        model=model,
        max_speed=max_speed,
        max_turn_rate=max_turn_rate,
        auto_enable=auto_enable,
        record=record,
    )


class BlockingRobot:
    """A :class:`pioneer3.Robot` on an event loop in a thread of its own."""

    def __init__(self, url: str, **options: Any) -> None:
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, name="pioneer3", daemon=True)
        self._stack = AsyncExitStack()
        self._robot: Robot
        self._process = os.getpid()
        self._closed = False
        self._thread.start()
        atexit.register(self.close)
        self._signals = StopOnSignals(self._loop, self._stand, self.close)
        self._signals.__enter__()
        try:
            self._robot = self._wait(self._stack.enter_async_context(connect_async(url, **options)))
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> "BlockingRobot":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Stop the robot and end the session; safe to call twice, and in any thread."""
        if self._closed:
            return
        self._closed = True
        if self._process != os.getpid():  # a fork: the session is its parent's
            return
        atexit.unregister(self.close)
        leaving = asyncio.run_coroutine_threadsafe(self._leave(), self._loop)
        try:
            wait([leaving], CLOSE_PATIENCE)
        finally:
            wait([leaving], CLOSE_PATIENCE)  # an interrupt must not come before the farewell
            self._loop.call_soon_threadsafe(self._loop.stop)
            self._thread.join(CLOSE_PATIENCE)
            if not self._thread.is_alive():
                self._loop.close()
            self._signals.__exit__(None, None, None)
        leaving.result(0)

    @property
    def info(self) -> RobotInfo:
        """Identity, model, limits and configuration of the robot."""
        return self._robot.info

    @property
    def snapshot(self) -> Snapshot | None:
        """The latest reading, or `None` while the link is lost."""
        return self._robot.snapshot

    def snapshots(self, seconds: float = inf) -> Iterator[Snapshot]:
        """Yield each reading as it arrives, for `seconds`."""
        values: AsyncIterator[Snapshot] = self._robot.snapshots(seconds)
        while (snapshot := self._wait(_next_or_none(values))) is not None:
            yield snapshot

    def drive(self, speed: float, turn_rate: float = 0.0) -> None:
        """See :meth:`pioneer3.Robot.drive`."""
        self._call(lambda: self._robot.drive(speed, turn_rate))

    def stop(self) -> None:
        """Stand still, whoever drives."""
        self._call(self._robot.stop)

    def emergency_stop(self) -> None:
        """See :meth:`pioneer3.Robot.emergency_stop`."""
        self._call(self._robot.emergency_stop)

    def reset_emergency_stop(self) -> None:
        """Release the latch. The motors stay off."""
        self._call(self._robot.reset_emergency_stop)

    def motors(self, on: bool) -> None:
        """See :meth:`pioneer3.Robot.motors`."""
        self._wait(self._robot.motors(on))

    def move(self, distance: float, speed: float | None = None) -> None:
        """See :meth:`pioneer3.Robot.move`."""
        self._wait(self._robot.move(distance, speed))

    def turn(self, angle: float, rate: float | None = None) -> None:
        """See :meth:`pioneer3.Robot.turn`."""
        self._wait(self._robot.turn(angle, rate))

    def goto(
        self, x: float, y: float, heading: float | None = None, *, speed: float | None = None
    ) -> None:
        """See :meth:`pioneer3.Robot.goto`."""
        self._wait(self._robot.goto(x, y, heading, speed=speed))

    def run(self, mode: Stack, seconds: float = inf) -> None:
        """See :meth:`pioneer3.Robot.run`."""
        self._wait(self._robot.run(mode, seconds))

    def why_not_moving(self) -> str | None:
        """Return in one sentence why the robot stands still, or `None` while it moves."""
        return self._call(self._robot.why_not_moving)

    def send(self, command: Command) -> None:
        """See :meth:`pioneer3.Robot.send`."""
        self._call(lambda: self._robot.send(command))

    def send_unsafe(self, command: Command) -> None:
        """See :meth:`pioneer3.Robot.send_unsafe`."""
        self._call(lambda: self._robot.send_unsafe(command))

    def _stand(self) -> None:
        """Let the robot stand, whoever drives, in the loop."""
        if hasattr(self, "_robot"):
            self._robot.helm.stop()

    async def _leave(self) -> None:
        """End the session, and whatever was interrupted before there was one."""
        await self._stack.aclose()
        tasks = asyncio.all_tasks() - {asyncio.current_task()}
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    def _call(self, function: Callable[[], T]) -> T:
        async def call() -> T:
            return function()

        return self._wait(call())

    def _wait(self, coroutine: Coroutine[Any, Any, T]) -> T:
        """Run `coroutine` on the loop; an interrupt of this thread cancels it there."""
        if self._loop.is_closed():
            coroutine.close()
            raise RuntimeError("this robot has been closed; connect again")
        future = asyncio.run_coroutine_threadsafe(coroutine, self._loop)
        try:
            return future.result()
        except BaseException:
            future.cancel()
            raise


async def _next_or_none(values: AsyncIterator[Snapshot]) -> Snapshot | None:
    return await anext(values, None)
