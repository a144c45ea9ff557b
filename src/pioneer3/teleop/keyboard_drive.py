"""Joins a keyboard to robots: keys become commands, and a live line shows the effect."""

import asyncio
import re
from collections.abc import AsyncIterator, Callable, Sequence
from math import isfinite
from typing import Final

from pioneer3.behaviors.actions import Hold
from pioneer3.runtime.arbiter import KEYBOARD
from pioneer3.runtime.driven import Driven
from pioneer3.tasks import running
from pioneer3.teleop.keyboard import Key, Keyboard
from pioneer3.teleop.terminal import SEQUENCES
from pioneer3.units import degrees

RENEW = 0.1
"""Pause between two commands, and two live lines [s]."""
COMMAND_TIMEOUT = 0.3
"""A command that is not renewed ends after this [s]: this program may hang too."""


class KeyboardDriver:
    """Drives `robot` with keys, until the quit key.

    Args:
        robot: Connected.
        keyboard: Speeds, and how long a key acts.
        show: Given the live line, again and again.
    """

    def __init__(self, robot: Driven, keyboard: Keyboard, show: Callable[[str], None]) -> None:
        self._robot = robot
        self._keyboard = keyboard
        self._show = show
        self._hold = Hold("keyboard")
        self._clock = asyncio.get_running_loop().time

    async def run(self, keys: AsyncIterator[Key]) -> None:
        """Drive until the quit key or the end of `keys`; then the robot stands."""
        self._robot.arbiter.add(self._hold, KEYBOARD)
        renewing = asyncio.ensure_future(self._renew())
        try:
            async for key in keys:
                if key is Key.QUIT:
                    return
                self._obey(key)
                self._command()
                self._show(self.line())
        finally:
            renewing.cancel()
            await asyncio.gather(renewing, return_exceptions=True)
            self._robot.arbiter.remove(self._hold)
            self._robot.stop()

    def line(self) -> str:
        """Return the live line: speed or why it stands, speeds set, battery, nearest sonar, pose.

        While the robot moves, 79 columns hold it; a narrow terminal cuts off the least important.
        """
        robot, now, keyboard = self._robot, self._robot.snapshot, self._keyboard
        if now is None:
            status = robot.supervisor.status.latest
            return f"{status.connection.value.upper()}: {status.message}" if status else ""
        pose, twist, near = now.odometry.robot_in_odom, now.odometry.twist, now.sonar.nearest
        state = robot.why_not_moving() or f"{twist.v:z5.2f} m/s {degrees(twist.w):z4.0f}°/s"
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
                self._keyboard.press(Key.STOP, self._clock())  # a latched key must be pressed anew
            self._command()
            self._show(self.line())
            await asyncio.sleep(RENEW)

    def _command(self) -> None:
        twist, seconds = self._keyboard.wanted(self._clock())
        if not twist.is_zero:
            self._robot.arbiter.hold(self._hold, twist, min(seconds, COMMAND_TIMEOUT))

    def _obey(self, key: Key) -> None:
        """Carry out a key that is about more than velocity; pass the others on."""
        supervisor = self._robot.supervisor
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
                supervisor.reset_emergency_stop()
        self._keyboard.press(key, self._clock())


KEYS: Final = (
    "arrows: drive   q: next robot   0-9: this robot   a: all   space: stop all   + -: speed   "
    "m: motors   k: emergency stop   Ctrl-R: release it   Ctrl-D: quit"
)
NEXT, ALL, QUIT = {"q", "\t"}, {"a"}, {"\x04", "\x1b"}
FOR_ALL: Final = {Key.STOP, Key.EMERGENCY, Key.RESET}
"""Keys that every robot obeys, chosen or not."""
LETTERS: Final = {"w", "a", "s", "d", "q"}
"""They drive where there is one robot; here arrows do."""
LAB_NUMBER: Final = re.compile(r".*p3[a-z]+_(\d)_")
"""The lab numbers its robots, as in p3at_1_113."""


def numbers(names: Sequence[str]) -> dict[str, int]:
    """Return a digit for each robot: the lab's, or else in their order from 0."""
    found = [match[1] for name in names if (match := LAB_NUMBER.match(name))]
    if len(set(found)) == len(names):
        return {name: int(digit) for name, digit in zip(names, found, strict=True)}
    return {name: number for number, name in enumerate(names)}


class KeyRouter:
    """Routes keys to the drivers of robots.

    Args:
        numbers: The digit of each robot.
        show: Given the live line of the robot chosen.

    Attributes:
        chosen: The robots that drive; the others stand.
    """

    def __init__(self, numbers: dict[str, int], show: Callable[[str], None]) -> None:
        self.numbers = numbers
        self.chosen = [min(numbers, key=lambda name: numbers[name])]
        self._show = show
        self._drivers: dict[str, KeyboardDriver] = {}
        self._keys: dict[str, asyncio.Queue[Key]] = {name: asyncio.Queue() for name in numbers}

    def shows(self, name: str) -> Callable[[str], None]:
        """Return the function that shows the live lines of a robot."""

        def show(line: str) -> None:
            if name == self.chosen[0]:
                who = name if len(self.chosen) == 1 else "ALL ROBOTS"
                self._show(f"{who}: {line}")

        return show

    def add(self, name: str, driver: KeyboardDriver) -> None:
        """Let `driver` have the keys of this robot."""
        self._drivers[name] = driver

    async def run(self, tokens: AsyncIterator[str]) -> None:
        """Drive until the quit key or the end of `tokens`; then all robots stand."""
        driving = [driver.run(_pressed(self._keys[name])) for name, driver in self._drivers.items()]
        async with running(*driving):
            async for token in tokens:
                if token in QUIT:
                    return
                self.press(token)

    def press(self, token: str) -> None:
        """Obey a key."""
        order = sorted(self.numbers, key=lambda name: self.numbers[name])
        if token in NEXT:
            self._choose([order[(order.index(self.chosen[0]) + 1) % len(order)]])
        elif token in ALL:
            self._choose(order)
        elif token.isdecimal():
            self._choose([name for name in order if self.numbers[name] == int(token)])
        elif token not in LETTERS and (key := SEQUENCES.get(token)):
            for name in order if key in FOR_ALL else self.chosen:
                self._keys[name].put_nowait(key)

    def _choose(self, names: Sequence[str]) -> None:
        """Let these robots have the keys; the robots that lose them stand."""
        for name in self.chosen:
            if names and name not in names:
                self._keys[name].put_nowait(Key.STOP)
        self.chosen = list(names) or self.chosen


async def _pressed(keys: "asyncio.Queue[Key]") -> AsyncIterator[Key]:
    while True:
        yield await keys.get()
