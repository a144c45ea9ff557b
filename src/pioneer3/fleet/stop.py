"""Stops all robots of a fleet at once, and tells which have confirmed it."""

import asyncio
import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import inf

from pioneer3.errors import LinkError, PioneerError
from pioneer3.fleet.members import Connect
from pioneer3.fleet.spec import FleetRobot
from pioneer3.robot.pilot import stands
from pioneer3.runtime.driven import Driven
from pioneer3.tasks import running

log = logging.getLogger(__name__)
AGAIN = 0.25
"""A robot is told to stop again after this [s], until it has confirmed."""
HELD = 0.25
"""A robot stands if all its reports say so for this time [s]: a program that drives it on sends
velocities more often."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Stopped:
    """The outcome of the stop of one robot, which was known after some `seconds`.

    It is `ok` if its own reports say that it stands, after an emergency stop without power, too;
    else `why` has the reason, in plain words. It was `reached` if the stop was sent to it. If it is
    `taken` another program drove it: it stands until that switches the motors on.
    """

    robot: str
    ok: bool
    reached: bool
    why: str
    seconds: float
    taken: bool = False


async def stop_all(
    robots: Sequence[FleetRobot],
    connect: Connect,
    *,
    emergency: bool = False,
    patience: float = 3.0,
) -> tuple[Stopped, ...]:
    """Connect to all `robots` side by side and stop them; return their answers in this order.

    In an emergency they stop as hard as they can, without power. The patience is for each [s].
    """
    return tuple(
        await asyncio.gather(
            *(_stop(robot, connect, emergency=emergency, patience=patience) for robot in robots)
        )
    )


async def _stop(
    robot: FleetRobot, connect: Connect, *, emergency: bool, patience: float
) -> Stopped:
    clock = asyncio.get_running_loop().time
    began, reached, seconds, why = clock(), False, None, ""
    taken = False
    try:
        async with asyncio.timeout(patience), connect(robot) as driven:
            taken = driven.supervisor.taken
            reached = True
            try:
                await _confirmed(driven, emergency=emergency)
                seconds = clock() - began
            finally:
                if seconds is None:
                    why = f"it was told to stop, and has not confirmed it within {patience:g} s"
                    trouble = _trouble(driven, emergency=emergency)
                    why += f". {trouble}" if trouble else ""
    except (PioneerError, OSError) as error:
        if seconds is None:
            why = why or str(error) or f"no answer within {patience:g} s"
    except Exception as error:  # the others are to be told of all the same
        log.exception("%s: failed", robot.name)
        why = why or f"{type(error).__name__}: {error}"
    return Stopped(
        robot=robot.name,
        ok=seconds is not None,
        reached=reached,
        why=why,
        seconds=clock() - began if seconds is None else seconds,
        taken=taken,
    )


async def _confirmed(driven: Driven, *, emergency: bool) -> None:
    """Tell the robot to stop until its reports say for :data:`HELD` that it stands.

    LinkError tells that there will be no more reports.
    """
    stop = driven.emergency_stop if emergency else driven.stop
    stop()
    told = asyncio.get_running_loop().time()
    since = inf
    async with running(_again(stop)):
        async for snapshot in driven.snapshots(patience=inf):
            if snapshot.stamp <= told:
                continue
            if not stands(snapshot) or (emergency and not driven.supervisor.without_power):
                since = inf
            elif snapshot.stamp - (since := min(since, snapshot.stamp)) >= HELD:
                return
    raise LinkError("its reports have ended")


async def _again(stop: Callable[[], None]) -> None:
    while True:
        await asyncio.sleep(AGAIN)
        stop()


def _trouble(driven: Driven, *, emergency: bool) -> str:
    """Return the reason, if it is known, that a robot has not confirmed."""
    snapshot = driven.snapshot
    if snapshot is None:
        return str(driven.why_not_moving() or "")
    if not stands(snapshot):
        return "It moves: does another program drive it?"
    if driven.supervisor.without_power or not emergency:
        return ""
    return "Its emergency stop is not latched"
