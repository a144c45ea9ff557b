"""Stops all robots of a fleet at once, and tells which have confirmed it."""

import asyncio
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from pioneer3.errors import PioneerError
from pioneer3.fleet.members import Connect
from pioneer3.fleet.spec import Robot
from pioneer3.robot.pilot import STANDING
from pioneer3.runtime.driven import Driven
from pioneer3.state import Snapshot

AGAIN = 0.5
"""A robot that still moves is told to stop again after this [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Stopped:
    """The outcome of the stop of one robot.

    Attributes:
        robot: Its name.
        ok: Whether its own reports say that it stands; after an emergency stop, without power, too.
        reached: Whether the stop was sent to it.
        why: The reason that it does not, in plain words; empty if it stands.
        seconds: Until that was known.
        taken: Whether another program drove it: it stands until that switches the motors on.
    """

    robot: str
    ok: bool
    reached: bool
    why: str
    seconds: float
    taken: bool = False


async def stop_all(
    robots: Sequence[Robot], connect: Connect, *, emergency: bool = False, patience: float = 3.0
) -> tuple[Stopped, ...]:
    """Connect to all `robots` side by side and stop them; return their answers in this order.

    Args:
        robots: Of the fleet.
        connect: Connects to one.
        emergency: Whether to stop as hard as they can, and take the power from their motors.
        patience: For each of them [s].
    """
    return tuple(
        await asyncio.gather(
            *(_stop(robot, connect, emergency=emergency, patience=patience) for robot in robots)
        )
    )


async def _stop(robot: Robot, connect: Connect, *, emergency: bool, patience: float) -> Stopped:
    clock = asyncio.get_running_loop().time
    began, reached, seconds, why = clock(), False, None, ""
    taken = False
    try:
        async with asyncio.timeout(patience), connect(robot) as driven:
            taken = driven.supervisor.taken
            stop = driven.emergency_stop if emergency else driven.stop
            stop()
            reached = True
            await _confirmed(driven, clock(), stop, emergency=emergency)
            seconds = clock() - began
    except (PioneerError, OSError) as error:
        if seconds is None:
            why = str(error) or (
                f"it was told to stop, and has not confirmed it within {patience:g} s"
                if reached
                else f"no answer within {patience:g} s"
            )
    return Stopped(
        robot=robot.name,
        ok=seconds is not None,
        reached=reached,
        why=why,
        seconds=clock() - began if seconds is None else seconds,
        taken=taken,
    )


async def _confirmed(
    driven: Driven, told: float, stop: Callable[[], None], *, emergency: bool
) -> None:
    """Wait until a report that came after `told` says that the robot stands; stop it again."""
    again = told + AGAIN
    async for snapshot in driven.snapshots():
        if snapshot.stamp > told and _stands(snapshot, emergency=emergency):
            return
        if snapshot.stamp > again:
            stop()
            again = snapshot.stamp + AGAIN


def _stands(snapshot: Snapshot, *, emergency: bool) -> bool:
    twist = snapshot.odometry.twist
    still = abs(twist.v) < STANDING.v and abs(twist.w) < STANDING.w
    return still and not (emergency and snapshot.motors.enabled)


def exit_code(answers: Sequence[Stopped]) -> int:
    """Return 0 if all stand, 1 if some have not confirmed it, 3 if none was reached."""
    if all(answer.ok for answer in answers):
        return 0
    return 1 if any(answer.reached for answer in answers) else 3
