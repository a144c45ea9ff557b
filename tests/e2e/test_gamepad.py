"""A gamepad on a machine without a screen: the kernel's bytes in, a robot over TCP moves."""

import asyncio
import os
from functools import partial

import pytest

from pioneer3.navigation.connect import connect_async
from pioneer3.sim.server.start import simulator
from pioneer3.teleop.evdev import EV_ABS, EV_KEY, EV_SYN, EVENT, open_gamepad, read
from pioneer3.teleop.gamepad_drive import GamepadDriver
from tests.e2e.processes import until
from tests.unit.teleop.test_evdev import Kernel, kernel

__all__ = ["kernel"]
pytestmark = pytest.mark.realtime

BTN_TL, ABS_Y = 0x136, 1


def bytes_of(*events: tuple[int, int, int]) -> bytes:
    """Return events and the report that ends them."""
    return b"".join(EVENT.pack(1, 2, *event) for event in (*events, (EV_SYN, 0, 0)))


def has_come(told: list[str], news: int) -> bool:
    """Return whether so many things were said, a gamepad that was found the last of them."""
    return len(told) == news and told[-1].startswith("gamepad: ")


async def test_a_gamepad_drives_is_unplugged_and_comes_back(kernel: Kernel) -> None:
    path = kernel.add(4, "Test Pad")
    told: list[str] = []
    async with simulator(port=0) as running, connect_async(running.url) as robot:
        driving = asyncio.ensure_future(GamepadDriver(robot, open_gamepad, read, told.append).run())
        for news in (1, 3):
            await until(partial(has_come, told, news))
            hand = os.open(path, os.O_WRONLY)
            os.write(hand, bytes_of((EV_ABS, ABS_Y, -32768), (EV_KEY, BTN_TL, 1)))
            await until(lambda: running.body.speeds[0] > 0.3)
            path.rename(path.with_name("gone"))
            os.close(hand)
            await until(lambda: running.body.speeds[0] == 0.0)
            assert told[-1] == "the gamepad is gone: the robot stops; waiting for it"
            path.with_name("gone").rename(path)
        driving.cancel()
        await asyncio.gather(driving, return_exceptions=True)
