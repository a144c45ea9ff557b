"""Motions that take a while: waits for their end, and raises the reason of an early one."""

import asyncio
from collections.abc import AsyncIterator, Iterator
from contextlib import contextmanager
from math import inf
from types import TracebackType

from pioneer3.behaviors.action import Stack
from pioneer3.behaviors.actions import Move, Turn
from pioneer3.errors import LinkError, MotionError
from pioneer3.robot.explain import advised
from pioneer3.robot.supervisor import Supervisor
from pioneer3.runtime.arbiter import PROGRAM, Arbiter
from pioneer3.state import Snapshot

STUCK_PATIENCE = 2.0
"""A motion that makes no headway for this long [s] has failed."""
EARLY = 1e-6
"""A loop may call somebody so much too early [s]."""

Snapshots = AsyncIterator[Snapshot]


@contextmanager
def lost_as_motion_error(name: str) -> Iterator[None]:
    """Turn a lost link into a MotionError of the motion `name`."""
    try:
        yield
    except LinkError as error:
        raise MotionError(f"{name}: {error}") from error


async def carry_out(
    action: Move | Turn, arbiter: Arbiter, supervisor: Supervisor, snapshots: Snapshots
) -> None:
    """Let `action` drive until it is done.

    Raises:
        MotionError: something else ended it, it got stuck, or the link was lost; the message
            gives the reason.
    """
    clock = asyncio.get_running_loop().time
    arbiter.add(action, PROGRAM)
    moved_at = clock()
    try:
        with lost_as_motion_error(action.name):
            async for _ in snapshots:
                if action.done:
                    return
                if forbidden := supervisor.pilot.forbidden:
                    raise MotionError(f"{action.name}: {forbidden}")
                if action not in arbiter:
                    raise MotionError(f"{action.name}: {arbiter.last_stop.why}")
                stuck = arbiter.why_not_moving()
                if stuck is None or arbiter.driving_action != action.name:
                    moved_at = clock()
                elif clock() - moved_at >= STUCK_PATIENCE:
                    raise MotionError(f"{action.name}: {advised(stuck)}")
        raise MotionError(f"{action.name}: the connection was closed")
    finally:
        arbiter.remove(action)


class StartedMotion:
    """One motion that goes on beside its program, until it ends or another command does it.

    The end of its block ends it, too.
    """

    def __init__(self, arbiter: Arbiter, supervisor: Supervisor) -> None:
        self._arbiter, self._supervisor = arbiter, supervisor
        self._action: Move | Turn | None = None
        self._task: asyncio.Task[None] | None = None

    def __enter__(self) -> None:
        pass

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        at: TracebackType | None,
    ) -> None:
        self.end()

    def start(self, action: Move | Turn, snapshots: Snapshots) -> None:
        """Let `action` drive from now on, in place of the one before.

        Raises:
            MotionError: the robot will not move; the message gives the reason.
        """
        self.end()
        if forbidden := self._supervisor.pilot.forbidden:
            raise MotionError(f"{action.name}: {forbidden}")
        motion = carry_out(action, self._arbiter, self._supervisor, snapshots)
        self._action, self._task = action, asyncio.create_task(motion)
        self._task.add_done_callback(lambda task: task.cancelled() or task.exception())

    def end(self) -> None:
        """End the motion, if one goes on, and forget it."""
        task, self._task = self._task, None
        if task is not None and self._action is not None:
            task.cancel()
            self._arbiter.remove(self._action)

    @property
    def done(self) -> bool:
        """Whether it has reached its aim, or there is none.

        Raises:
            MotionError: something else ended it; the message gives the reason.
        """
        if self._task is None:
            return True
        if not self._task.done():
            return False
        self._task.result()
        return True


async def run_mode(mode: Stack, arbiter: Arbiter, snapshots: Snapshots, *, until: float) -> None:
    """Let `mode` drive `until` then [s, loop time], or until it has reached its aim.

    Raises:
        MotionError: something else ended it, or the link was lost; the message gives the reason.
    """
    arbiter.start(mode)
    try:
        await await_mode(mode, arbiter, snapshots, until=until)
    except MotionError as error:
        raise MotionError(f"{mode.name}: {error}") from error.__cause__
    finally:
        if arbiter.mode is mode:
            arbiter.end_mode("its time was over")


async def await_mode(
    mode: Stack, arbiter: Arbiter, snapshots: Snapshots, *, until: float = inf
) -> None:
    """Wait `until` then [s, loop time], or until a mode that drives has reached its aim.

    Raises:
        MotionError: Something else ended it, or the link was lost; the message is the reason.
    """
    clock = asyncio.get_running_loop().time
    try:
        async for _ in snapshots:
            ended = arbiter.ended
            if ended is not None and ended.mode is mode and ended.done:
                return
            if arbiter.mode is not mode:
                why = ended.why if ended and ended.mode is mode else "another mode was started"
                raise MotionError(why)
    except LinkError as error:
        raise MotionError(str(error)) from error
    if clock() < until - EARLY:
        raise MotionError("the connection was closed")
