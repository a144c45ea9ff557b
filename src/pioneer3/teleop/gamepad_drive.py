"""Joins a gamepad to a robot: its stick drives while the deadman button is held."""

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import AbstractContextManager

from pioneer3.behaviors.actions import Hold
from pioneer3.runtime.arbiter import GAMEPAD
from pioneer3.runtime.robot import Robot
from pioneer3.teleop.evdev import Decoder, GamepadDevice
from pioneer3.teleop.gamepad import SCHEME, Gamepad, Scheme
from pioneer3.teleop.keyboard_drive import COMMAND_TIMEOUT

RENEW = 0.05
"""Pause between two commands while the button is held [s]."""

SEARCH = 1.0
"""Pause between two looks for a gamepad [s]."""

Open = Callable[[], AbstractContextManager[GamepadDevice | None]]
Read = Callable[[GamepadDevice], AsyncIterator[bytes]]


class GamepadDriver:
    """Drives `robot` with whatever gamepad there is, until cancelled.

    `open_device` opens the gamepad, or yields `None` while there is none; `read` yields its bytes
    until it is unplugged; `tell` is given news for people: a gamepad that comes or goes.
    """

    def __init__(
        self,
        robot: Robot,
        open_device: Open,
        read: Read,
        tell: Callable[[str], None],
        scheme: Scheme = SCHEME,
    ) -> None:
        self._robot = robot
        self._open = open_device
        self._read = read
        self._tell = tell
        self._scheme = scheme
        self._hold = Hold("gamepad")
        self._clock = asyncio.get_running_loop().time

    async def run(self) -> None:
        """Drive; one that goes is a release, and is waited for. In the end the robot stands."""
        arbiter = self._robot.arbiter
        arbiter.add(self._hold, GAMEPAD)
        waiting = False
        try:
            while True:
                with self._open() as device:
                    if device is not None:
                        self._tell(f"gamepad: {device.name} ({device.path})")
                        await self._drive(device)
                        self._tell("the gamepad is gone: the robot stops; waiting for it")
                    elif not waiting:
                        self._tell("no gamepad is there yet; waiting for one")
                    waiting = True
                await asyncio.sleep(SEARCH)
        finally:
            arbiter.remove(self._hold)
            self._robot.stop()

    async def _drive(self, device: GamepadDevice) -> None:
        """Drive with one gamepad until it is unplugged."""
        gamepad = Gamepad(self._scheme)
        decoder = Decoder(gamepad, device.ranges)
        for axis, value in device.start.items():
            decoder.place(axis, value)
        renewing = asyncio.ensure_future(self._renew(gamepad))
        try:
            async for chunk in self._read(device):
                decoder.feed(chunk)
                self._act(decoder.pressed, gamepad)
                decoder.pressed.clear()
                self._command(gamepad)
        finally:
            renewing.cancel()
            await asyncio.gather(renewing, return_exceptions=True)
            self._robot.arbiter.release(self._hold)

    async def _renew(self, gamepad: Gamepad) -> None:
        while True:
            self._command(gamepad)
            await asyncio.sleep(RENEW)

    def _act(self, pressed: list[int], gamepad: Gamepad) -> None:
        """Carry out the buttons that were pressed: stops, and the reset."""
        scheme = self._scheme
        if scheme.stop in pressed:
            gamepad.let_go()
            self._robot.arbiter.stop(by=self._hold)
        if scheme.emergency_stop in pressed:
            gamepad.let_go()
            self._robot.emergency_stop()
        if scheme.reset in pressed:
            gamepad.let_go()
            self._robot.reset_emergency_stop()

    def _command(self, gamepad: Gamepad) -> None:
        arbiter, wanted = self._robot.arbiter, gamepad.wanted
        if not wanted.is_zero:
            arbiter.hold(self._hold, wanted, COMMAND_TIMEOUT)
        elif self._hold.holds(self._clock(), arbiter.last_stop):
            arbiter.release(self._hold)
        else:
            self._hold.release()
