"""The gamepad joined to a robot: events in, motion out. Virtual time."""

import asyncio
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from pioneer3 import Robot, connect_async
from pioneer3.teleop.evdev import (
    BUTTONS,
    EV_ABS,
    EV_KEY,
    EV_SYN,
    EVENT,
    SYN_DROPPED,
    GamepadDevice,
    Range,
)
from pioneer3.teleop.gamepad import SCHEME
from pioneer3.teleop.gamepad_drive import GamepadDriver
from pioneer3.teleop.keyboard_drive import COMMAND_TIMEOUT
from tests.support import SimulatedRobot

BRAKING = 0.45
CODE = {number: code for code, number in BUTTONS.items()}
DEVICE = GamepadDevice(
    Path("/dev/input/event9"), "Test Pad", -1, {0: Range(0, 255), 1: Range(0, 255)}, {}
)
AHEAD, MIDDLE = 0, 128


@dataclass
class Player:
    """Who holds the gamepad, and whether it is plugged in."""

    sim: SimulatedRobot
    robot: Robot
    told: list[str] = field(default_factory=list)
    plugged: bool = True
    said: asyncio.Queue[bytes] = field(default_factory=asyncio.Queue)

    @contextmanager
    def open(self) -> Iterator[GamepadDevice | None]:
        yield DEVICE if self.plugged else None

    async def read(self, _: GamepadDevice) -> AsyncIterator[bytes]:
        while chunk := await self.said.get():
            yield chunk

    def event(self, kind: int, code: int, value: int) -> None:
        self.said.put_nowait(EVENT.pack(0, 0, kind, code, value) + EVENT.pack(0, 0, EV_SYN, 0, 0))

    def press(self, button: int) -> None:
        self.event(EV_KEY, CODE[button], 1)

    def let_go(self, button: int) -> None:
        self.event(EV_KEY, CODE[button], 0)

    def push(self, forward: int) -> None:
        self.event(EV_ABS, 1, forward)

    def unplug(self) -> None:
        self.plugged = False
        self.said.put_nowait(b"")

    @property
    def speed(self) -> float:
        return self.sim.speed


@asynccontextmanager
async def playing() -> AsyncIterator[Player]:
    """Hold a gamepad of a simulated robot."""
    async with SimulatedRobot() as sim, connect_async(sim.open) as robot:
        player = Player(sim, robot)
        driver = GamepadDriver(robot, player.open, player.read, player.told.append)
        driving = asyncio.ensure_future(driver.run())
        await asyncio.sleep(0.1)
        yield player
        driving.cancel()
        await asyncio.gather(driving, return_exceptions=True)


async def go(player: Player) -> None:
    """Drive ahead at full stick."""
    player.push(AHEAD)
    player.press(SCHEME.deadman)
    await asyncio.sleep(2.5)
    assert player.speed == pytest.approx(SCHEME.speed)


async def test_the_stick_alone_moves_nothing() -> None:
    async with playing() as player:
        player.push(AHEAD)
        player.press(SCHEME.turbo)
        await asyncio.sleep(1.0)
        assert player.speed == 0.0
        assert not player.sim.powered


async def test_it_drives_while_the_deadman_is_held_at_the_gamepads_priority() -> None:
    async with playing() as player:
        await go(player)
        assert player.robot.arbiter.driving_action == "gamepad"
        await asyncio.sleep(60.0)  # a hand that does not tremble sends nothing
        assert player.speed == pytest.approx(SCHEME.speed)
        player.let_go(SCHEME.deadman)
        await asyncio.sleep(BRAKING)
        assert player.speed == 0.0
        assert player.robot.arbiter.driving_action is None


async def test_the_stick_in_the_middle_stops_and_goes_on_while_it_is_held() -> None:
    async with playing() as player:
        await go(player)
        player.push(MIDDLE)
        await asyncio.sleep(BRAKING)
        assert player.speed == 0.0
        player.push(AHEAD)
        await asyncio.sleep(2.5)
        assert player.speed == pytest.approx(SCHEME.speed)


async def test_its_stop_button_wants_a_fresh_press() -> None:
    async with playing() as player:
        await go(player)
        player.press(SCHEME.stop)
        await asyncio.sleep(2.0)
        assert player.speed == 0.0
        player.let_go(SCHEME.deadman)
        await go(player)


async def test_its_emergency_stop_latches_until_reset() -> None:
    async with playing() as player:
        await go(player)
        player.press(SCHEME.emergency_stop)
        await asyncio.sleep(1.0)
        assert player.speed == 0.0
        assert not player.sim.powered
        player.let_go(SCHEME.deadman)
        player.press(SCHEME.deadman)
        await asyncio.sleep(1.0)
        assert not player.sim.powered
        player.press(SCHEME.reset)
        await asyncio.sleep(1.0)
        assert not player.sim.powered
        player.let_go(SCHEME.deadman)
        await go(player)


async def test_a_gamepad_that_is_unplugged_is_a_release_and_is_waited_for() -> None:
    async with playing() as player:
        await go(player)
        player.unplug()
        await asyncio.sleep(BRAKING)
        assert player.speed == 0.0
        assert player.told[-1] == "the gamepad is gone: the robot stops; waiting for it"
        await asyncio.sleep(10.0)
        assert len(player.told) == 2  # said once
        player.plugged = True
        await asyncio.sleep(1.5)
        assert player.told[-1] == "gamepad: Test Pad (/dev/input/event9)"
        player.push(AHEAD)
        await asyncio.sleep(1.0)
        assert player.speed == 0.0
        await go(player)


async def test_it_is_said_once_that_there_is_none_yet() -> None:
    async with SimulatedRobot() as sim, connect_async(sim.open) as robot:
        player = Player(sim, robot, plugged=False)
        driver = GamepadDriver(robot, player.open, player.read, player.told.append)
        driving = asyncio.ensure_future(driver.run())
        await asyncio.sleep(5.0)
        assert player.told == ["no gamepad is there yet; waiting for one"]
        player.plugged = True
        await asyncio.sleep(1.0)
        await go(player)
        driving.cancel()
        await asyncio.gather(driving, return_exceptions=True)
        await asyncio.sleep(BRAKING)
        assert player.speed == 0.0


@pytest.mark.parametrize("stop", ["stop", "emergency"])
async def test_somebody_elses_stop_wants_a_fresh_press(stop: str) -> None:
    async with playing() as player:
        await go(player)
        player.robot.stop() if stop == "stop" else player.robot.emergency_stop()
        if stop == "emergency":
            await asyncio.sleep(0.5)
            player.robot.reset_emergency_stop()
        await asyncio.sleep(2.0)
        assert player.speed == 0.0
        player.push(AHEAD + 1)
        await asyncio.sleep(1.0)
        assert player.speed == 0.0
        player.let_go(SCHEME.deadman)
        await go(player)


async def test_a_lost_link_wants_a_fresh_press() -> None:
    async with playing() as player:
        await go(player)
        await player.sim.unplug()
        await asyncio.sleep(1.0)
        player.sim.plugged = True
        await asyncio.sleep(8.0)
        assert player.speed == 0.0
        player.let_go(SCHEME.deadman)
        await go(player)


async def test_events_that_were_lost_are_a_release() -> None:
    async with playing() as player:
        await go(player)
        player.event(EV_SYN, SYN_DROPPED, 0)
        await asyncio.sleep(BRAKING)
        assert player.speed == 0.0
        player.let_go(SCHEME.deadman)
        await go(player)


async def test_a_driver_that_hangs_is_outlived_by_its_lease() -> None:
    async with playing() as player:
        await go(player)
        held = player.robot.arbiter.decision.until - asyncio.get_running_loop().time()
        assert 0.0 < held <= COMMAND_TIMEOUT
