"""What waits for a link that takes little or nothing, and how motors go off. Virtual time."""

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager

import pytest

from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command
from pioneer3.errors import CommandError, LinkError
from pioneer3.links import Link
from pioneer3.links.memory import MemoryLink
from pioneer3.navigation.connect import connect_async
from pioneer3.runtime.robot import Robot
from tests.support import SimulatedRobot, decoded, frame, hold, until

OFF = frame(commands.Enable(on=False))
BYTES_A_SECOND = 960
"""Of a line at 9600 baud."""


async def flood(seconds: float, *acts: Callable[[], object]) -> None:
    """Act a thousand times a second."""
    for _ in range(round(1000 * seconds)):
        for act in acts:
            act()
        await asyncio.sleep(0.001)


class Clogged:
    """The robot's cable, which can be made to take nothing.

    Attributes:
        taken: Everything that it has taken, in order.
    """

    def __init__(self, robot: SimulatedRobot) -> None:
        self._robot = robot
        self.free = asyncio.Event()
        self.free.set()
        self.taken: list[Command] = []

    async def open(self) -> Link:
        link = await self._robot.open()
        assert isinstance(link, MemoryLink)
        write = link.write

        async def when_free(data: bytes) -> None:
            await self.free.wait()
            self.taken += decoded(data)
            await write(data)

        link.write = when_free  # type: ignore[method-assign]
        return link


async def test_after_five_seconds_of_nothing_the_emergency_stop_comes_first() -> None:
    async with SimulatedRobot() as robot:
        cable = Clogged(robot)
        async with connect_async(cable.open) as driver:
            await hold(driver, 0.3)
            cable.free.clear()
            await hold(driver, 0.5, seconds=2.0)
            await flood(2.0, driver.stop)
            await asyncio.sleep(0.6)
            await hold(driver, 0.4, 0.3, seconds=0.4)
            driver.emergency_stop()
            cable.taken.clear()
            cable.free.set()
            await asyncio.sleep(0.05)
            in_flight = cable.taken.index(commands.Stop())
            assert in_flight <= 3  # a velocity that the cable had when it clogged, and a PULSE
            assert commands.EStop() in cable.taken[in_flight:][:2]
            later = cable.taken[in_flight:]
            assert not any(isinstance(sent, commands.Vel) and sent.speed for sent in later)
            assert later.count(commands.Stop()) == later.count(commands.EStop()) == 1


async def test_a_stop_overtakes_what_programs_have_sent() -> None:
    async with SimulatedRobot() as robot:
        cable = Clogged(robot)
        async with connect_async(cable.open) as driver:
            await hold(driver, 0.3)
            cable.free.clear()
            for number in range(100):
                driver.send(commands.DigOut(mask=255, values=number))
            driver.stop()
            cable.taken.clear()
            cable.free.set()
            await until(lambda: commands.DigOut(mask=255, values=99) in cable.taken)
            assert cable.taken.index(commands.Stop()) <= 10
            values = [sent.values for sent in cable.taken if isinstance(sent, commands.DigOut)]
            assert values == list(range(100))


async def test_a_link_that_takes_nothing_for_long_takes_no_more_commands() -> None:
    async with SimulatedRobot() as robot:
        cable = Clogged(robot)
        async with connect_async(cable.open) as driver:
            cable.free.clear()
            for number in range(256):
                driver.send(commands.DigOut(mask=255, values=number))
            with pytest.raises(CommandError, match="256 commands wait for the link"):
                driver.send(commands.DigOut(mask=255, values=0))
            cable.free.set()


@asynccontextmanager
async def slow_line(robot: SimulatedRobot, *, patient: bool) -> AsyncIterator[Robot]:
    """Connect over a line of 9600 baud; one that is not patient takes all and delivers later."""

    async def open_slow() -> Link:
        link = await robot.open()
        assert isinstance(link, MemoryLink)
        write, clear_at = link.write, 0.0
        loop = asyncio.get_running_loop()

        async def slowly(data: bytes) -> None:
            nonlocal clear_at
            clear_at = max(clear_at, loop.time()) + len(data) / BYTES_A_SECOND
            if patient:
                await asyncio.sleep(clear_at - loop.time())
                await write(data)
            else:
                loop.call_at(clear_at, lambda: asyncio.ensure_future(deliver(data)))

        async def deliver(data: bytes) -> None:
            try:
                await write(data)
            except LinkError:
                return

        link.write = slowly  # type: ignore[method-assign]
        return link

    async with connect_async(open_slow) as driver:
        yield driver


FLOODS: dict[str, Callable[[Robot], object]] = {
    "stop": lambda robot: robot.stop(),
    "emergency stop": lambda robot: robot.emergency_stop(),
    "motors": lambda robot: robot.arbiter.set_motors(on=robot.snapshot is None),
}


@pytest.mark.parametrize("patient", [True, False], ids=["cable", "network"])
@pytest.mark.parametrize("name", FLOODS)
async def test_after_a_flood_of_commands_a_slow_robot_drives_at_once(
    name: str, patient: bool
) -> None:
    async with SimulatedRobot() as robot, slow_line(robot, patient=patient) as driver:
        await hold(driver, 0.3, seconds=2.0)
        assert robot.speed > 0.2
        await flood(6.5, lambda: FLOODS[name](driver))
        assert robot.speed == 0.0
        driver.reset_emergency_stop()
        await hold(driver, 0.3, seconds=1.0)
        assert robot.speed > 0.1


class SpeedAt:
    """The robot's speed when a frame arrived for the first time since `clear` [m/s]."""

    def __init__(self, robot: SimulatedRobot, frame: bytes) -> None:
        self._robot, self._frame = robot, frame
        self.speed: float | None = None
        self.at = 0.0
        robot.to_robot = self._note

    def _note(self, data: bytes) -> tuple[bytes]:
        if self._frame in data and self.speed is None:
            self.speed, self.at = self._robot.speed, asyncio.get_running_loop().time()
        return (data,)


async def test_motors_that_are_switched_off_while_driving_brake_first() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        await hold(driver, 0.7, seconds=3.0)
        off = SpeedAt(robot, OFF)
        assert robot.speed > 0.5
        await driver.motors(on=False)
        assert off.speed == pytest.approx(0.0, abs=0.005)
        assert not robot.powered


async def test_the_way_out_brakes_before_the_power_goes() -> None:
    async with SimulatedRobot() as robot:
        async with connect_async(robot.open) as driver:
            await hold(driver, 0.7, seconds=3.0)
            off = SpeedAt(robot, OFF)
            assert robot.speed > 0.5
            left_at = asyncio.get_running_loop().time()
        assert off.speed == pytest.approx(0.0, abs=0.005)
        assert off.at - left_at < 1.0


async def test_the_way_out_does_not_wait_for_a_robot_that_never_stands() -> None:
    async with SimulatedRobot() as robot:
        async with connect_async(robot.open) as driver:
            await hold(driver, 0.7, seconds=3.0)
            robot.edit = lambda data: b""  # it says nothing any more
            off = SpeedAt(robot, OFF)
            left_at = asyncio.get_running_loop().time()
        assert off.at - left_at == pytest.approx(1.0, abs=0.1)


async def test_the_way_out_of_a_robot_at_rest_takes_no_time() -> None:
    async with SimulatedRobot() as robot:
        async with connect_async(robot.open) as driver:
            await hold(driver, 0.3)
            driver.stop()
            await asyncio.sleep(1.0)
            off = SpeedAt(robot, OFF)
            left_at = asyncio.get_running_loop().time()
        assert off.at == left_at


async def test_the_emergency_stop_does_not_wait_for_the_robot_to_stand() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        await hold(driver, 0.7, seconds=3.0)
        off = SpeedAt(robot, OFF)
        driver.emergency_stop()
        pressed_at = asyncio.get_running_loop().time()
        await asyncio.sleep(1.0)
        assert off.at - pressed_at <= 0.1
