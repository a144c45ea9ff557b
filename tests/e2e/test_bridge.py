"""A bridge between programs and a simulated robot, in virtual time."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import pytest

from pioneer3 import connect_async
from pioneer3.arcos import commands, reports
from pioneer3.arcos.commands import Command
from pioneer3.arcos.packet import PacketReader, encode
from pioneer3.arcos.reports import Report, Sip
from pioneer3.bridge import Bridge
from pioneer3.errors import LinkError
from pioneer3.links import Link, opener
from pioneer3.robot.explain import ReasonKind
from pioneer3.tasks import running
from tests.support import SimulatedRobot, frame, hold

SOON = 3.0
SIP_HEADER = b"\xfa\xfb\x56"
VEL = commands.Vel(speed=0.3)


class Program:
    """A host without a driver."""

    def __init__(self, link: Link) -> None:
        self.link = link
        self.reader = PacketReader()
        self.heard: list[Report] = []
        self.raw = b""

    async def say(self, *said: Command) -> None:
        await self.link.write(b"".join(frame(command) for command in said))

    async def listen(self, seconds: float) -> bool:
        """Keep what comes within that time; return whether the link still works."""
        try:
            async with asyncio.timeout(seconds):
                while data := await self.link.read():
                    self.raw += data
                    self.heard += map(reports.from_payload, self.reader.feed(data))
                return False
        except TimeoutError:
            return True

    async def until(self, kind: type[Report]) -> Report:
        seen = len(self.heard)
        async with asyncio.timeout(SOON):
            while True:
                for report in self.heard[seen:]:
                    if isinstance(report, kind):
                        return report
                seen = len(self.heard)
                data = await self.link.read()
                assert data, "the link was closed"
                self.raw += data
                self.heard += map(reports.from_payload, self.reader.feed(data))

    async def open(self) -> reports.SyncIdentity:
        for number in (0, 1):
            await self.link.write(encode(bytes([number])))
            await self.until(reports.SyncEcho)
        await self.link.write(encode(bytes([2])))
        identity = await self.until(reports.SyncIdentity)
        await self.say(commands.Open())
        await self.until(Sip)
        assert isinstance(identity, reports.SyncIdentity)
        return identity

    async def enable(self) -> None:
        await self.say(commands.Enable(on=True))
        await self.listen(0.3)


@asynccontextmanager
async def bridged(robot: SimulatedRobot) -> AsyncIterator[Bridge]:
    bridge = Bridge(robot.open)
    async with running(bridge.run()):
        yield bridge


async def test_the_first_program_has_the_robot_and_drives_it() -> None:
    async with SimulatedRobot() as robot, bridged(robot) as bridge:
        assert bridge.holder is None
        async with connect_async(bridge.opener("student")) as driver:
            assert bridge.holder == "student"
            await driver.move(0.3)
            assert robot.body.robot_in_world.x == pytest.approx(0.3, abs=0.03)
        await asyncio.sleep(0.5)
        assert bridge.holder is None
        assert not robot.body.drive.powered


async def test_a_second_program_watches() -> None:
    async with SimulatedRobot() as robot, bridged(robot) as bridge:
        first, second = Program(bridge.link("first")), Program(bridge.link("second"))
        assert await first.open() == await second.open()
        assert (bridge.holder, bridge.watchers) == ("first", ("second",))
        await first.enable()
        await first.say(VEL)
        await second.say(commands.Vel(speed=-0.3))
        await first.listen(1.0)
        await second.listen(0.1)
        assert robot.body.robot_in_world.x > 0.1
        await first.listen(0.05)
        watched = second.raw[second.raw.index(SIP_HEADER) :]
        assert len(watched) > 500
        assert watched in first.raw


async def test_a_program_that_watches_is_told_so_and_that_is_no_fault() -> None:
    async with (
        SimulatedRobot() as robot,
        bridged(robot) as bridge,
        connect_async(bridge.opener("first")) as first,
    ):
        await first.motors(on=True)
        async with connect_async(bridge.opener("second")) as second:
            why = second.why_not_moving()
            assert why is not None
            assert (why.kind, why.text[:22]) == (ReasonKind.NORMAL, "Another program drives")


async def test_a_stop_of_a_watcher_holds_until_the_motors_are_switched_on_again() -> None:
    async with SimulatedRobot() as robot, bridged(robot) as bridge:
        first, second = Program(bridge.link("first")), Program(bridge.link("second"))
        await first.open()
        await second.open()
        await first.enable()
        await first.say(VEL)
        await first.listen(1.0)
        await second.say(commands.Stop())
        for _ in range(30):
            await first.say(VEL)
            await first.listen(0.1)
        assert robot.speed == 0
        assert not robot.body.drive.powered
        stands_at = robot.body.robot_in_world.x
        await first.enable()
        await first.say(VEL)
        await first.listen(1.0)
        assert robot.body.robot_in_world.x > stands_at + 0.1


async def test_a_silent_holder_loses_the_motion() -> None:
    async with SimulatedRobot() as robot, bridged(robot) as bridge:
        first = Program(bridge.link("first"))
        await first.open()
        await first.enable()
        await first.say(VEL)
        await first.listen(1.4)
        assert robot.speed > 0.2
        await first.listen(1.4)
        assert robot.speed == 0
        await first.say(VEL)
        await first.listen(1.0)
        assert robot.speed > 0.2


async def test_a_program_that_gives_way_is_closed_and_may_watch() -> None:
    async with (
        SimulatedRobot() as robot,
        bridged(robot) as bridge,
        connect_async(bridge.opener("page", gives_way=True)) as page,
    ):
        await hold(page, 0.3, seconds=1.0)
        assert robot.speed > 0.2
        async with connect_async(bridge.opener("student")) as student:
            assert bridge.holder == "student"
            assert robot.speed == pytest.approx(0, abs=0.01)
            await hold(student, 0.2, seconds=3.0)
            assert bridge.watchers == ("page",)
            await hold(page, 0.4, seconds=0.3)
            await hold(student, 0.2, seconds=1.0)
            assert robot.speed == pytest.approx(0.2, abs=0.02)
            assert page.snapshot is not None
            assert page.snapshot.odometry.twist.v == pytest.approx(0.2, abs=0.05)
        await asyncio.sleep(3.0)
        assert bridge.holder == "page"


async def test_a_pause_withholds_motion_until_a_command_after_it() -> None:
    async with SimulatedRobot() as robot, bridged(robot) as bridge:
        first = Program(bridge.link("first"))
        await first.open()
        await first.enable()
        await first.say(VEL)
        await first.listen(1.0)
        bridge.paused = True
        await first.listen(0.5)
        await first.say(VEL)
        await first.listen(1.0)
        assert robot.speed == 0
        assert bridge.paused
        bridge.paused = False
        await first.listen(0.5)
        assert robot.speed == 0
        await first.say(VEL)
        await first.listen(1.0)
        assert robot.speed > 0.2


async def test_a_recording_begun_in_mid_session_replays(tmp_path: Path) -> None:
    file = tmp_path / "session.txt"
    async with (
        SimulatedRobot() as robot,
        bridged(robot) as bridge,
        connect_async(bridge.opener("student")) as driver,
    ):
        await driver.move(0.2)
        bridge.start_recording(file)
        await driver.move(0.2)
        bridge.stop_recording()
    async with connect_async(opener(f"replay:{file}")) as replayed:
        assert replayed.info.identity.name == "MobileSim"
        way = [snapshot.odometry.robot_in_odom.x async for snapshot in replayed.snapshots()]
    assert way[-1] - way[0] == pytest.approx(0.2, abs=0.05)


async def test_the_end_of_the_bridge_stops_the_robot() -> None:
    async with SimulatedRobot() as robot:
        async with bridged(robot) as bridge:
            first = Program(bridge.link("first"))
            await first.open()
            await first.enable()
            await first.say(VEL)
            await first.listen(1.0)
            assert robot.speed > 0.2
        assert robot.speed == pytest.approx(0, abs=0.01)
        assert commands.Close() in robot.wires[-1].commands
        with pytest.raises(LinkError):
            await first.say(VEL)


async def test_watchers_that_come_and_go_do_not_stop_the_robot() -> None:
    async with (
        SimulatedRobot() as robot,
        bridged(robot) as bridge,
        connect_async(bridge.opener("student")) as student,
    ):
        driving = asyncio.ensure_future(hold(student, 0.3, seconds=8.0))
        await asyncio.sleep(1.5)
        slowest = robot.speed
        async with connect_async(bridge.opener("watcher")) as watcher:
            for _ in range(40):
                await asyncio.sleep(0.05)
                slowest = min(slowest, robot.speed)
            assert bridge.watchers == ("watcher",)
            assert watcher.snapshot is not None
        for _ in range(40):
            await asyncio.sleep(0.05)
            slowest = min(slowest, robot.speed)
        assert bridge.holder == "student"
        assert slowest == pytest.approx(0.3, abs=0.02)
        assert await driving == 0


async def test_a_stop_of_a_watching_driver_stops_the_robot() -> None:
    async with (
        SimulatedRobot() as robot,
        bridged(robot) as bridge,
        connect_async(bridge.opener("student")) as student,
    ):
        driving = asyncio.ensure_future(hold(student, 0.3, seconds=5.0))
        await asyncio.sleep(1.5)
        async with connect_async(bridge.opener("teacher")) as teacher:
            assert robot.speed > 0.2
            teacher.stop()
            await asyncio.sleep(2.0)
            assert robot.speed == 0
        await driving


async def test_an_emergency_stop_of_a_watching_driver_takes_the_power() -> None:
    async with SimulatedRobot() as robot, bridged(robot) as bridge:
        first = Program(bridge.link("first"))
        await first.open()
        await first.enable()
        await first.say(VEL)
        await first.listen(1.0)
        async with connect_async(bridge.opener("teacher")) as teacher:
            assert robot.speed > 0.2
            teacher.emergency_stop()
            await first.listen(1.0)
            assert robot.speed == 0
            assert not robot.powered


@pytest.mark.realtime
async def test_hosts_over_tcp_share_the_robot() -> None:
    async with (
        SimulatedRobot() as robot,
        bridged(robot) as bridge,
        bridge.listening() as port,
        connect_async(f"tcp://127.0.0.1:{port}") as student,
    ):
        assert bridge.holder is not None
        assert bridge.holder.startswith("127.0.0.1:")
        driving = asyncio.ensure_future(hold(student, 0.3, seconds=3.0))
        async with connect_async(f"tcp://127.0.0.1:{port}"):
            await asyncio.sleep(1.0)
            assert len(bridge.watchers) == 1
            assert robot.speed > 0.1
        await driving


async def test_the_bridge_finds_the_speed_of_a_serial_robot() -> None:
    async with (
        SimulatedRobot(speeds=(9600, 19200, 38400)) as robot,
        bridged(robot) as bridge,
        connect_async(bridge.opener("student")) as driver,
    ):
        assert await hold(driver, 0.3) == 0
        assert robot.speed > 0.2


async def test_a_robot_that_is_unplugged_disconnects_all_and_is_found_again() -> None:
    async with SimulatedRobot() as robot, bridged(robot) as bridge:
        first, second = Program(bridge.link("first")), Program(bridge.link("second"))
        await first.open()
        await second.open()
        await robot.unplug()
        assert not await first.listen(5.0)
        assert not await second.listen(5.0)
        assert bridge.holder is None
        refused = Program(bridge.link("refused"))
        await refused.say(commands.Pulse())  # SYNC0: it opens the link
        assert not await refused.listen(5.0)
        assert "no such port" in bridge.failed
        robot.plugged = True
        again = Program(bridge.link("again"))
        await again.open()
        assert bridge.holder == "again"
