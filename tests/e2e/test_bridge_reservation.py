"""A bridge that is reserved for one host. Virtual time."""

import asyncio

from pioneer3.bridge import Bridge
from tests.e2e.test_bridge import VEL, Program, bridged
from tests.support import SimulatedRobot

PAGE = "page"


async def page_of(bridge: Bridge) -> Program:
    """Return the session of a host that gives way."""
    page = Program(bridge.link(PAGE, gives_way=True))
    await page.open()
    return page


async def test_a_reserved_robot_is_taken_from_its_program_and_stops() -> None:
    async with SimulatedRobot() as robot, bridged(robot) as bridge:
        student = Program(bridge.link("student"))
        await student.open()
        await student.enable()
        await student.say(VEL)
        await student.listen(1.0)
        assert robot.speed > 0.2
        bridge.reserved_for = PAGE
        assert not await student.listen(1.0)
        await asyncio.sleep(2.0)
        assert robot.speed == 0.0
        again = Program(bridge.link("student"))
        for number in (0, 1):
            await again.link.write(bytes([0xFA, 0xFB, 3, number, 0, number]))
        await asyncio.sleep(0.5)
        assert bridge.holder is None
        await page_of(bridge)
        assert bridge.holder == PAGE


async def test_programs_watch_a_reserved_robot_and_have_it_afterwards() -> None:
    async with SimulatedRobot() as robot, bridged(robot) as bridge:
        page = await page_of(bridge)
        bridge.reserved_for = PAGE
        student = Program(bridge.link("student"))
        await student.open()
        assert (bridge.holder, bridge.watchers) == (PAGE, ("student",))
        await student.enable()
        await student.say(VEL)
        await student.listen(1.0)
        assert robot.speed == 0.0
        bridge.reserved_for = ""
        assert not await student.listen(1.0)
        assert not await page.listen(1.0)
        await asyncio.sleep(0.5)
        student = Program(bridge.link("student"))
        await student.open()
        assert bridge.holder == "student"


async def test_the_end_of_a_reservation_disturbs_nobody_if_no_program_watches() -> None:
    async with SimulatedRobot() as robot, bridged(robot) as bridge:
        page = await page_of(bridge)
        bridge.reserved_for = PAGE
        bridge.reserved_for = ""
        assert await page.listen(1.0)
        assert bridge.holder == PAGE


async def test_others_are_disconnected_and_the_robot_stops() -> None:
    async with SimulatedRobot() as robot, bridged(robot) as bridge:
        student = Program(bridge.link("student"))
        await student.open()
        await student.enable()
        await student.say(VEL)
        await student.listen(1.0)
        watcher = await page_of(bridge)
        bridge.disconnect_others(PAGE)
        assert not await student.listen(1.0)
        assert not await watcher.listen(1.0)
        await asyncio.sleep(2.0)
        assert robot.speed == 0.0
        assert bridge.holder is None
