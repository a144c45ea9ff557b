"""The robot and its lasers for scripts and notebooks: the same, without `await`."""

import asyncio
import atexit
from contextlib import AbstractAsyncContextManager, AsyncExitStack
from pathlib import Path
from typing import Any, Self, cast

from pioneer3.robot.supervisor import RobotInfo
from pioneer3.runtime.connect import connect_laser_async
from pioneer3.runtime.facade import Facade, LoopThread, adapted, blocking
from pioneer3.runtime.robot import Robot
from pioneer3.runtime.signals import StopOnSignals
from pioneer3.state import Scan, Snapshot


def connect_laser(url: str, *, record: Path | None = None) -> "BlockingLaser":
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
        atexit.register(self.close)
        self._signals = StopOnSignals(self._thread.loop, self._stand, self.close)
        self._signals.__enter__()
        try:
            self._target = self._thread.wait(self._stack.enter_async_context(connection))
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
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

    def _stand(self) -> None:
        """Let stand what moves; called in the loop."""

    async def _leave(self) -> None:
        """End the session, also one that was interrupted before it began."""
        await self._stack.aclose()
        tasks = asyncio.all_tasks() - {asyncio.current_task()}
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


class BlockingRobot(BlockingConnection):
    """A :class:`pioneer3.Robot` on an event loop in a thread of its own."""

    @property
    def info(self) -> RobotInfo:
        """Identity, model, limits and configuration of the robot last connected."""
        return cast("RobotInfo", self._read("info"))

    @property
    def snapshot(self) -> Snapshot | None:
        """The latest snapshot, or `None` while the link is lost."""
        return cast("Snapshot | None", self._read("snapshot"))

    @property
    def devices(self) -> Any:
        """The devices besides wheels and sonars: :class:`pioneer3.robot.devices.Devices`.

        Facades, made as they are asked for: `robot.devices.gripper.open()`, or
        `for scan in robot.devices.laser.values()`. Their types are known when the program runs.
        """
        return adapted(self._target.devices, self._thread)

    @property
    def navigator(self) -> Any:
        """Knows where the robot is on a map, as a facade; `None` without a map."""
        return adapted(self._target.navigator, self._thread)

    @property
    def laser(self) -> Any:
        """The first of :attr:`lasers`."""
        return self.lasers[0]

    @property
    def lasers(self) -> tuple[Any, ...]:
        """The laser range finders, as facades: `robot.lasers[0].reading()`."""
        return tuple(adapted(laser, self._thread) for laser in self._target.lasers)

    snapshots = blocking(Robot.snapshots)
    drive = blocking(Robot.drive)
    drive_wheels = blocking(Robot.drive_wheels)
    stop = blocking(Robot.stop)
    emergency_stop = blocking(Robot.emergency_stop)
    reset_emergency_stop = blocking(Robot.reset_emergency_stop)
    motors = blocking(Robot.motors)
    move = blocking(Robot.move)
    turn = blocking(Robot.turn)
    start_move = blocking(Robot.start_move)
    set_delta_heading = blocking(Robot.set_delta_heading)
    set_heading = blocking(Robot.set_heading)
    is_move_done = blocking(Robot.is_move_done)
    goto = blocking(Robot.goto)
    run = blocking(Robot.run)
    nearest = blocking(Robot.nearest)
    why_not_moving = blocking(Robot.why_not_moving)
    send = blocking(Robot.send)
    send_unsafe = blocking(Robot.send_unsafe)

    def _stand(self) -> None:
        """Stop the robot in the loop, also when others drive."""
        if self._target is not None:
            self._target.arbiter.stop()


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
