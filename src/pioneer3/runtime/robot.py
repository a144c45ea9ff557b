"""The robot as a program sees it, asynchronously."""

import asyncio
import signal
import threading
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, contextmanager
from functools import partial
from math import inf, isfinite
from typing import Any

from pioneer3.arcos.commands import Command
from pioneer3.arcos.host import Timing
from pioneer3.behaviors.actions import Hold, Move, Turn
from pioneer3.errors import CommandError, LinkError, MotionError
from pioneer3.links import open_link
from pioneer3.models import RobotModel
from pioneer3.robot.limits import Limits, checked, finite
from pioneer3.robot.supervisor import Connection, Opener, RobotInfo, Supervisor
from pioneer3.runtime.helm import Helm
from pioneer3.runtime.priorities import PROGRAM
from pioneer3.state import Snapshot

MOTOR_PATIENCE = 4.0
"""Longest wait for the motors to come on [s]."""
STUCK_PATIENCE = 2.0
"""A motion that makes no headway for this long [s] has failed."""


class Robot:
    """A connected robot. All angles counter-clockwise, all units SI.

    Made by :func:`connect_async`. Velocities expire after :attr:`Limits.expiry` (0.5 s); every way
    out stops the robot.
    """

    def __init__(self, supervisor: Supervisor, helm: Helm) -> None:
        self.supervisor = supervisor
        self.helm = helm
        self._hold = Hold("program", PROGRAM)
        helm.add(self._hold)

    @property
    def info(self) -> RobotInfo:
        """Identity, model, limits and configuration of the robot last connected."""
        assert self.supervisor.info is not None
        return self.supervisor.info

    @property
    def snapshot(self) -> Snapshot | None:
        """The latest reading, or `None` while the link is lost."""
        return self.supervisor.snapshot

    async def snapshots(self, seconds: float = inf) -> AsyncIterator[Snapshot]:
        """Yield each reading as it arrives, for `seconds`; the newest when the reader is slow."""
        end = asyncio.get_running_loop().time() + seconds
        values = self.supervisor.snapshots.values()
        while True:
            try:
                async with asyncio.timeout_at(end if isfinite(end) else None):
                    snapshot = await anext(values)
            except (TimeoutError, StopAsyncIteration):
                return
            yield snapshot

    def drive(self, speed: float, turn_rate: float = 0.0) -> None:
        """Drive at `speed` [m/s] and `turn_rate` [rad/s] until that expires.

        Raises:
            CommandError: not finite numbers.
            MotionError: the robot will not move; the message says why.
        """
        refused = self.helm.hold(self._hold, checked(speed, turn_rate), self.info.limits.expiry)
        if refused:
            raise MotionError(refused)

    def stop(self) -> None:
        """Stand still, whoever drives."""
        self.helm.stop(by=self._hold)

    def emergency_stop(self) -> None:
        """Stop as hard as possible, motors off; latched until :meth:`reset_emergency_stop`."""
        self.helm.emergency_stop()

    def reset_emergency_stop(self) -> None:
        """Release the latch. The motors stay off."""
        self.supervisor.reset_emergency_stop()

    async def motors(self, on: bool) -> None:
        """Switch the motors' power; return when the robot confirms it.

        Raises:
            MotionError: the robot did not follow.
        """
        self.stop()
        refused = self.supervisor.set_motors(on=on)
        if refused:
            raise MotionError(refused)
        async for snapshot in self.snapshots(MOTOR_PATIENCE):
            if snapshot.motors.enabled == on:
                return
        raise MotionError(self.why_not_moving() or f"the motors did not switch {_on(on)}")

    async def move(self, distance: float, speed: float | None = None) -> None:
        """Drive `distance` [m] straight ahead, negative backwards, at `speed` [m/s] at most.

        Raises:
            CommandError: not finite numbers.
            MotionError: it did not get there; the message says why.
        """
        limits = self.info.limits
        top = limits.max_speed if speed is None else _positive("speed", speed)
        await self._carry_out(
            Move(
                distance=finite("distance", distance),
                speed=min(top, limits.max_speed),
                deceleration=limits.deceleration,
                priority=PROGRAM,
            )
        )

    async def turn(self, angle: float, rate: float | None = None) -> None:
        """Turn on the spot by `angle` [rad], at `rate` [rad/s] at most.

        Raises:
            CommandError: not finite numbers.
            MotionError: it did not get there; the message says why.
        """
        limits = self.info.limits
        top = limits.max_turn_rate if rate is None else _positive("rate", rate)
        await self._carry_out(
            Turn(
                angle=finite("angle", angle),
                rate=min(top, limits.max_turn_rate),
                deceleration=limits.turn_deceleration,
                priority=PROGRAM,
            )
        )

    def why_not_moving(self) -> str | None:
        """Return in one sentence why the robot stands still, or `None` while it moves."""
        return self.supervisor.why_not_moving()

    def send(self, command: Command) -> None:
        """Send any ARCOS command that is not about motion.

        Raises:
            CommandError: no session is open, or the command does not fit the protocol.
        """
        self.supervisor.send(command)

    async def _carry_out(self, action: Move | Turn) -> None:
        loop = asyncio.get_running_loop()
        self._hold.release()
        self.supervisor.stop()  # a fresh command: whatever was held before is over
        self.helm.add(action)
        try:
            async with asyncio.timeout(STUCK_PATIENCE) as patience:
                async for _ in self.snapshots():
                    if action.done:
                        return
                    self._check(action)
                    if self.why_not_moving() is None or self.helm.driver != action.name:
                        patience.reschedule(loop.time() + STUCK_PATIENCE)
            raise MotionError(f"{action.name}: the connection was closed")
        except TimeoutError:
            raise MotionError(f"{action.name}: {self.why_not_moving()}") from None
        finally:
            self.helm.remove(action)

    def _check(self, action: Move | Turn) -> None:
        """Raise MotionError if something has ended `action`."""
        pilot = self.supervisor.pilot
        if pilot.emergency:
            raise MotionError(f"{action.name}: the emergency stop is latched")
        if pilot.blocked:
            raise MotionError(f"{action.name}: {pilot.blocked}")
        if action not in self.helm:
            raise MotionError(f"{action.name}: somebody stopped the robot")


def _positive(name: str, value: float) -> float:
    number = finite(name, value)
    if number <= 0:
        raise CommandError(f"{name} must be positive, not {number:g}")
    return number


def _on(on: bool) -> str:
    return "on" if on else "off"


@asynccontextmanager
async def connect_async(
    url: str | Opener,
    *,
    baud: int | None = None,
    model: RobotModel | None = None,
    max_speed: float | None = None,
    max_turn_rate: float | None = None,
    auto_enable: bool = True,
    timing: Timing | None = None,
) -> AsyncIterator[Robot]:
    """Connect to a robot or simulator; stop it and close the session on every way out.

    Args:
        url: `/dev/ttyUSB0`, `tcp://localhost:8101`, `replay:FILE`; or a function that opens a link.
        baud: Serial speed to try first.
        model: Use this model, whatever the robot says it is.
        max_speed: Keep below this [m/s]; never above the robot's own limit.
        max_turn_rate: Keep below this [rad/s].
        auto_enable: Whether a fresh command switches the motors on.
        timing: How patient to be.

    Raises:
        LinkError: the port does not open.
        NoRobotError: nothing that answers is a robot.
        ConfigError: the URL or an option is wrong.
    """

    def restrict(limits: Limits) -> Limits:
        return limits.lowered_to(max_speed, max_turn_rate)

    opener = url if callable(url) else partial(open_link, url, baud=baud)
    supervisor = Supervisor(
        opener, model=model, restrict=restrict, auto_enable=auto_enable, timing=timing
    )
    helm = Helm(supervisor)
    tasks = [asyncio.ensure_future(supervisor.run()), asyncio.ensure_future(helm.run())]
    try:
        with stopped_by_sigterm():
            await _until_connected(supervisor, tasks[0])
            yield Robot(supervisor, helm)
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


async def _until_connected(supervisor: Supervisor, running: "asyncio.Future[None]") -> None:
    """Wait for the first snapshot; raise what ended the supervisor instead."""
    first = asyncio.ensure_future(anext(supervisor.snapshots.values()))
    both: set[asyncio.Future[Any]] = {first, running}
    try:
        await asyncio.wait(both, return_when=asyncio.FIRST_COMPLETED)
    finally:
        first.cancel()
        await asyncio.gather(first, return_exceptions=True)
    if running.done():
        await running
    latest = supervisor.status.latest
    if latest is not None and latest.connection is Connection.CLOSED:
        raise LinkError("the connection was closed before the robot said anything")


@contextmanager
def stopped_by_sigterm() -> Iterator[None]:
    """Cancel the task inside on SIGTERM, so that the robot is stopped on that way out too.

    Only where nobody else handles SIGTERM, and in the main thread.
    """
    main = threading.current_thread() is threading.main_thread()
    if not main or signal.getsignal(signal.SIGTERM) is not signal.SIG_DFL:
        yield
        return
    loop, task = asyncio.get_running_loop(), asyncio.current_task()
    assert task is not None
    loop.add_signal_handler(signal.SIGTERM, task.cancel)
    try:
        yield
    finally:
        loop.remove_signal_handler(signal.SIGTERM)
