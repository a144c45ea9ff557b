"""Joins a keyboard to a robot: keys become commands, and a live line shows the effect."""

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from math import degrees, isfinite

from pioneer3.behaviors.actions import Hold
from pioneer3.runtime.arbiter import KEYBOARD
from pioneer3.runtime.driven import Driven
from pioneer3.tasks import running
from pioneer3.teleop.keyboard import Key, Keyboard

RENEW = 0.1
"""Pause between two commands, and two live lines [s]."""
RENEW_UNSEEN = 0.15
"""Time between renewals without a live line [s]: half of :data:`COMMAND_TIMEOUT`."""
COMMAND_TIMEOUT = 0.3
"""A command that is not renewed ends after this [s]: this program may hang too."""


class KeyboardDriver:
    """Drives `robot` with keys, until the quit key.

    `show` is given the live line, again and again; it is `None` where nobody reads it.
    """

    def __init__(
        self, robot: Driven, keyboard: Keyboard, show: Callable[[str], None] | None = None
    ) -> None:
        self._robot = robot
        self.keyboard = keyboard
        self._show = show
        self._hold = Hold("keyboard")
        self._clock = asyncio.get_running_loop().time

    async def run(self, keys: AsyncIterator[Key]) -> None:
        """Drive until the quit key or the end of `keys`; then the robot stands."""
        async with self.driving():
            async for key in keys:
                if key is Key.QUIT:
                    return
                self.press(key)

    @asynccontextmanager
    async def driving(self) -> AsyncIterator[None]:
        """Drive with the keys that are pressed during the block; then the robot stands."""
        self._robot.arbiter.add(self._hold, KEYBOARD)
        try:
            async with running(self._renew()):
                yield
        finally:
            self._robot.arbiter.remove(self._hold)
            if not self._robot.supervisor.taken:
                self._robot.stop()

    def press(self, key: Key) -> None:
        """Obey a key."""
        self._obey(key)
        self._command()
        self._tell()

    @property
    def moves(self) -> bool:
        """Whether the robot moves, or is asked to."""
        now, pilot = self._robot.snapshot, self._robot.supervisor.pilot
        return (now is not None and now.motors.moving) or not pilot.asked(self._clock()).is_zero

    def line(self) -> str:
        """Return the live line: speed or why it stands, speeds set, battery, nearest sonar, pose.

        While the robot moves, 79 columns hold it; a narrow terminal cuts off the least important.
        """
        robot, now, keyboard = self._robot, self._robot.snapshot, self.keyboard
        if now is None:
            status = robot.supervisor.status.latest
            return f"{status.connection.value.upper()}: {status.message}" if status else ""
        pose, twist, near = now.odometry.robot_in_odom, now.odometry.twist, now.sonar.nearest
        moves = f"{twist.v:z5.2f} m/s {degrees(twist.w):z4.0f}°/s"
        state = str(robot.why_not_moving() or moves)
        if keyboard.has_run_out(self._clock()):
            state = f"No key for {keyboard.patience:g} s. {state}"
        return "  ".join(
            (
                state,
                f"[{keyboard.speed:.2f} {degrees(keyboard.turn_rate):.0f}]",
                f"{now.battery.voltage:4.1f} V{' LOW' if now.battery.low else ''}",
                f"sonar {near:4.2f} m" if isfinite(near) else "sonar  --   ",
                f"x{pose.x:z6.2f} y{pose.y:z6.2f} {degrees(pose.theta):z4.0f}°",
            )
        )

    async def _renew(self) -> None:
        while True:
            if self._robot.supervisor.pilot.blocked:
                self.keyboard.press(Key.STOP, self._clock())  # a latched key must be pressed anew
            self._command()
            self._tell()
            await asyncio.sleep(RENEW if self._show else RENEW_UNSEEN)

    def _tell(self) -> None:
        if self._show is not None:
            self._show(self.line())

    def _command(self) -> None:
        twist, seconds = self.keyboard.wanted(self._clock())
        if not twist.is_zero:
            self._robot.arbiter.hold(self._hold, twist, min(seconds, COMMAND_TIMEOUT))

    def _obey(self, key: Key) -> None:
        """Carry out a key that is about more than velocity; pass the others on."""
        match key:
            case Key.STOP:
                self._robot.arbiter.stop(by=self._hold)
            case Key.MOTORS:
                on = not (self._robot.snapshot and self._robot.snapshot.motors.enabled)
                self._robot.arbiter.set_motors(on=on, by=self._hold)
                key = Key.STOP  # a move still held would switch them on again
            case Key.EMERGENCY:
                self._robot.emergency_stop()
                key = Key.STOP  # else a latched key would drive on once it is released
            case Key.RESET:
                self._robot.arbiter.reset_emergency_stop()
        self.keyboard.press(key, self._clock())
