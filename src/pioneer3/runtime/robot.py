"""The robot as a program sees it, asynchronously."""

import asyncio
from collections.abc import AsyncIterator, Sequence
from math import inf
from typing import TYPE_CHECKING

from pioneer3.arcos.commands import Command
from pioneer3.behaviors.action import Stack
from pioneer3.behaviors.actions import Hold, Move, Turn
from pioneer3.behaviors.modes import goto
from pioneer3.errors import CommandError, MotionError
from pioneer3.nav.settings import AS_SHIPPED
from pioneer3.robot.devices import Devices, PictureSource
from pioneer3.robot.devices.laser import LaserSource
from pioneer3.robot.explain import Reason
from pioneer3.robot.limits import checked, finite
from pioneer3.robot.supervisor import RobotInfo, Supervisor
from pioneer3.runtime.arbiter import PROGRAM, Arbiter
from pioneer3.runtime.driven import LOST_AFTER, snapshots_of
from pioneer3.runtime.motions import carry_out, lost_as_motion_error, run_mode
from pioneer3.state import Snapshot

if TYPE_CHECKING:
    from pioneer3.navigation.navigator import Navigator

MOTOR_PATIENCE = 4.0
"""Longest wait for the motors to come on [s]."""


class Robot:
    """A connected robot. All angles counter-clockwise, all units SI.

    Made by :func:`pioneer3.connect_async`. Velocities expire after :attr:`Limits.expiry` (0.5 s);
    every way out stops the robot. Gripper, compass and the like are in :attr:`devices`.

    Attributes:
        lasers: The laser range finders at the computer, each on a link of its own; without any,
            that of a simulator, in the robot's own stream.
        navigator: Knows where it is on a map; `None` without a map.
        settings: Of its navigation.
    """

    def __init__(
        self,
        supervisor: Supervisor,
        arbiter: Arbiter,
        lasers: Sequence[LaserSource] = (),
        pictures: PictureSource | None = None,
    ) -> None:
        self.supervisor = supervisor
        self.arbiter = arbiter
        self.devices = Devices(supervisor, pictures)
        self.lasers: tuple[LaserSource, ...] = (*lasers,) or (self.devices.laser,)
        self.navigator: Navigator | None = None
        self.settings = AS_SHIPPED
        self._hold = Hold("program")
        arbiter.add(self._hold, PROGRAM)
        arbiter.lasers = self.lasers

    @property
    def info(self) -> RobotInfo:
        """Identity, model, limits and configuration of the robot last connected."""
        assert self.supervisor.info is not None
        return self.supervisor.info

    @property
    def laser(self) -> LaserSource:
        """The first of :attr:`lasers`."""
        return self.lasers[0]

    @property
    def snapshot(self) -> Snapshot | None:
        """The latest snapshot, or `None` while the link is lost."""
        return self.supervisor.snapshot

    def snapshots(
        self, seconds: float = inf, patience: float = LOST_AFTER
    ) -> AsyncIterator[Snapshot]:
        """Yield each snapshot as it arrives, for `seconds`; the newest when the reader is slow.

        A loss that is mended within `patience` [s] only leaves a gap; with `inf` every loss does.
        The driver goes on connecting: after an error, iterate again for the next snapshots.

        Raises:
            LinkError: the link has been lost for `patience`, or is lost when `seconds` are over.
        """
        return snapshots_of(self.supervisor, seconds, patience)

    def drive(self, speed: float, turn_rate: float = 0.0) -> None:
        """Drive at `speed` [m/s] and `turn_rate` [rad/s] until that expires.

        Raises:
            CommandError: not finite numbers.
            MotionError: the robot will not move; the message gives the reason.
        """
        refused = self.arbiter.hold(self._hold, checked(speed, turn_rate), self.info.limits.expiry)
        if refused:
            raise MotionError(str(refused))

    def stop(self) -> None:
        """Stop the robot, also when others drive."""
        self.arbiter.stop(by=self._hold)

    def emergency_stop(self) -> None:
        """Stop as hard as possible, motors off; latched until :meth:`reset_emergency_stop`."""
        self.arbiter.emergency_stop()

    def reset_emergency_stop(self) -> None:
        """Release the latch. The motors stay off."""
        self.supervisor.reset_emergency_stop()

    async def motors(self, on: bool) -> None:
        """Switch the motors' power; return when the robot confirms it.

        Raises:
            MotionError: the robot did not follow, or the link was lost.
        """
        self.stop()
        refused = self.supervisor.set_motors(on=on)
        if refused:
            raise MotionError(str(refused))
        with lost_as_motion_error("motors"):
            async for snapshot in self.snapshots(MOTOR_PATIENCE):
                if snapshot.motors.enabled == on:
                    return
        raise MotionError(str(self.why_not_moving() or f"the motors did not switch {_on(on)}"))

    async def move(self, distance: float, speed: float | None = None) -> None:
        """Drive `distance` [m] straight ahead, negative backwards, at `speed` [m/s] at most.

        Raises:
            CommandError: not finite numbers.
            MotionError: it did not get there, or the link was lost; see the message.
        """
        limits = self.info.limits
        top = limits.max_speed if speed is None else _positive("speed", speed)
        await self._carry_out(
            Move(
                distance=finite("distance", distance),
                speed=min(top, limits.max_speed),
                deceleration=limits.deceleration,
            )
        )

    async def turn(self, angle: float, rate: float | None = None) -> None:
        """Turn on the spot by `angle` [rad], at `rate` [rad/s] at most.

        Raises:
            CommandError: not finite numbers.
            MotionError: it did not get there, or the link was lost; see the message.
        """
        limits = self.info.limits
        top = limits.max_turn_rate if rate is None else _positive("rate", rate)
        await self._carry_out(
            Turn(
                angle=finite("angle", angle),
                rate=min(top, limits.max_turn_rate),
                deceleration=limits.turn_deceleration,
            )
        )

    async def goto(
        self,
        x: float | str,
        y: float | None = None,
        heading: float | None = None,
        *,
        speed: float | None = None,
    ) -> None:
        """Drive to a point of odometry's frame [m], or to a place of the map by its name.

        At `speed` [m/s] at most. To a point it drives straight, slower near obstacles and around
        those that are small, and turns to `heading` [rad] if that is given. To a place it drives
        along a planned way.

        Raises:
            CommandError: not finite numbers, or a name without a map.
            ConfigError: the map has no such place.
            MotionError: it did not get there, or the link was lost; see the message.
        """
        limits = self.info.limits
        top = (
            limits.max_speed if speed is None else min(_positive("speed", speed), limits.max_speed)
        )
        if isinstance(x, str):
            if self.navigator is None:
                raise CommandError(f"goto {x}: there is no map: connect with line_map=...")
            await self.navigator.goto(x, top)
            return
        if y is None:
            raise CommandError("goto: give x and y, or the name of a place of the map")
        end = None if heading is None else finite("heading", heading)
        mode = goto(finite("x", x), finite("y", y), end, speed=top)
        await run_mode(mode, self.arbiter, self.snapshots(), until=inf)

    async def run(self, mode: Stack, seconds: float = inf) -> None:
        """Let `mode` drive for `seconds`, or until it has reached its aim.

        It must be a fresh one, and replaces the one before. A keyboard, a gamepad and the page
        come before it.

        Raises:
            MotionError: something else ended it, or the link was lost; see the message.
        """
        until = asyncio.get_running_loop().time() + seconds
        await run_mode(mode, self.arbiter, self.snapshots(seconds), until=until)

    def why_not_moving(self) -> Reason | None:
        """Return the reason that the robot stands still, or `None` while it moves."""
        return self.arbiter.why_not_moving()

    def send(self, command: Command) -> None:
        """Send any ARCOS command that is not about motion.

        Raises:
            CommandError: no session is open, the command does not fit the protocol, or it moves
                the robot.
        """
        self.supervisor.send(command)

    def send_unsafe(self, command: Command) -> None:
        """Send any ARCOS command at all; see :meth:`Supervisor.send_unsafe` for the consequences.

        Raises:
            CommandError: no session is open, or the command does not fit the protocol.
        """
        self.supervisor.send_unsafe(command)

    async def _carry_out(self, action: Move | Turn) -> None:
        self._hold.release()
        await carry_out(action, self.arbiter, self.supervisor, self.snapshots())


def _positive(name: str, value: float) -> float:
    number = finite(name, value)
    if number <= 0:
        raise CommandError(f"{name} must be positive, not {number:g}")
    return number


def _on(on: bool) -> str:
    return "on" if on else "off"
