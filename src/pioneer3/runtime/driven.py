"""The commands and snapshots of a robot that programs get, at a cable or over topics."""

import asyncio
from collections.abc import AsyncIterator
from math import inf, isfinite, pi
from typing import Protocol

from pioneer3.behaviors.action import Stack
from pioneer3.behaviors.actions.sensing import BLIND
from pioneer3.behaviors.surroundings import Buffer, Echo
from pioneer3.errors import DeviceError, LinkError
from pioneer3.geometry import Pose2
from pioneer3.robot.explain import Reason, advised
from pioneer3.robot.limits import finite
from pioneer3.robot.supervisor import RobotInfo
from pioneer3.runtime.arbiter import Arbiter, Drivable
from pioneer3.runtime.motions import run_mode
from pioneer3.state import Snapshot

LOST_AFTER = 2.5
"""Nobody waits longer for a lost robot [s]: 2 s of silence are a loss, 0.5 s may bring it back."""


class Driven(Protocol):
    """A robot and its arbiter: the commands of programs, keyboards, modes and live displays."""

    arbiter: Arbiter

    @property
    def supervisor(self) -> Drivable:
        """The robot as the arbiter drives it."""

    @property
    def info(self) -> RobotInfo:
        """Identity, model, limits and configuration of the robot last connected."""
        assert self.supervisor.info is not None
        return self.supervisor.info

    @property
    def snapshot(self) -> Snapshot | None:
        """The latest snapshot, or `None` while the link is lost."""
        return self.supervisor.snapshot

    @property
    def odom_in_map(self) -> Pose2 | None:
        """Pose of odometry's frame on the map; `None` where it is not surely known."""
        return None

    async def snapshots(
        self, seconds: float = inf, patience: float = LOST_AFTER
    ) -> AsyncIterator[Snapshot]:
        """Yield each snapshot as it arrives, for `seconds`; the newest when the reader is slow.

        A loss that is mended within `patience` [s] only leaves a gap; with `inf` every loss does.
        Motions and modes turn the error into a MotionError. The driver goes on connecting: iterate
        again for the next snapshots.

        Raises:
            LinkError: the link has been lost for `patience`, or is lost when `seconds` are over.
        """
        robot = self.supervisor
        clock = asyncio.get_running_loop().time
        end = clock() + seconds
        values = robot.snapshots.values()
        while True:
            until = min(end, clock() + patience)
            try:
                async with asyncio.timeout_at(until if isfinite(until) else None):
                    snapshot = await anext(values)
            except StopAsyncIteration:
                return
            except TimeoutError:
                if robot.snapshot is None:
                    raise LinkError(advised(robot.why_not_moving())) from None
                if until == end:
                    return
                # silent, but not lost: a simulator that is paused
                values = robot.snapshots.values()
            else:
                yield snapshot

    async def run(self, mode: Stack, seconds: float = inf) -> None:
        """Let `mode` drive for `seconds`, or until it has reached its aim.

        It must be a fresh one, and replaces the one before. A keyboard, a gamepad and the page
        come before it.

        Raises:
            MotionError: something else ended it, or the link was lost; see the message.
        """
        until = asyncio.get_running_loop().time() + seconds
        await run_mode(mode, self.arbiter, self.snapshots(seconds), until=until)

    def nearest(self, start: float = -pi, end: float = pi, buffer: Buffer = Buffer.CURRENT) -> Echo:
        """Return the nearest thing between two bearings [rad], counter-clockwise from `start`.

        Sonars, bumpers, and lasers that scan see it: (-0.5, 0.5) is ahead, (2.6, -2.6) behind. Its
        distance is from the robot's centre [m]; `inf` where nothing echoed or no sensor looks.

        Raises:
            CommandError: not finite numbers.
            DeviceError: no range sensor works.
            LinkError: the link is lost.
        """
        first, last = finite("start", start), finite("end", end)
        situation = self.arbiter.situation()
        if situation is None:
            raise LinkError(advised(self.why_not_moving()))
        if not situation.around.sensing:
            raise DeviceError(f"nearest: {BLIND}; switch the sonars on, or connect a laser")
        return situation.around.nearest(first, last, buffer)

    def why_not_moving(self) -> Reason | None:
        """Return the reason that the robot stands still, or `None` while it moves."""
        return self.arbiter.why_not_moving()

    def stop(self) -> None:
        """Stop the robot, also when others drive."""
        self.arbiter.stop()

    def emergency_stop(self) -> None:
        """Stop as hard as possible, motors off, latched."""
        self.arbiter.emergency_stop()
