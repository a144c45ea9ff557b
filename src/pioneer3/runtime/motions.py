"""Motions that take a while: waits for their end, and raises the reason of an early one."""

import asyncio
from collections.abc import AsyncIterator, Iterator
from contextlib import contextmanager
from math import inf

from pioneer3.behaviors.action import Stack
from pioneer3.behaviors.actions import Move, Turn
from pioneer3.errors import LinkError, MotionError
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
                    raise MotionError(f"{action.name}: {stuck}")
        raise MotionError(f"{action.name}: the connection was closed")
    finally:
        arbiter.remove(action)


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
