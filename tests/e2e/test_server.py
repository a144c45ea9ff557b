"""The simulator's ports, with well-behaved clients and others."""

import asyncio
from collections.abc import AsyncIterator
from random import Random

import pytest

from pioneer3 import connect_async
from pioneer3.arcos import commands, reports
from pioneer3.arcos.packet import PacketReader, encode
from pioneer3.errors import LinkError, PortBusyError
from pioneer3.geometry import Pose2
from pioneer3.links.memory import MemoryLink, null_modem
from pioneer3.models import load_model
from pioneer3.sim.body import Body
from pioneer3.sim.firmware import Firmware
from pioneer3.sim.server import Simulation
from pioneer3.sim.server.pacer import Pacer
from pioneer3.sim.world import World
from tests.support import SLOW, frame, hold

SOON = 20.0
BRAKES = 0.5
"""In which wheels without power brake from 0.3 m/s, with mass and without [s]."""
SYNCS = b"".join(encode(bytes([number])) for number in (0, 1, 2))
OPEN = frame(commands.Open())


def robots(count: int = 1) -> tuple[World, list[Firmware]]:
    bodies = [Body(load_model("p3at-sh"), Pose2(0.0, 3.0 * n)) for n in range(count)]
    world = World(None, bodies)
    return world, [Firmware(world, body) for body in bodies]


class Station:
    """A robot's port in virtual time."""

    def __init__(self, pace: Pacer | None = None, *, keep_session: bool = False) -> None:
        self.world, (self.firmware,) = robots()
        self.simulation = Simulation(
            self.world, [self.firmware], pace=pace, keep_session=keep_session
        )
        (self.port,) = self.simulation.ports
        self.tasks: list[asyncio.Task[None]] = [asyncio.ensure_future(self.simulation.run())]

    def plug_in(self) -> MemoryLink:
        """Return a new client's end."""
        ours, theirs = null_modem()
        self.tasks.append(asyncio.ensure_future(self.port.serve(theirs)))
        return ours

    async def open(self) -> MemoryLink:
        """Return a new client's end, as an opener does."""
        return self.plug_in()

    async def close(self) -> None:
        for task in self.tasks:
            task.cancel()
        await asyncio.gather(*self.tasks, return_exceptions=True)


@pytest.fixture
async def station() -> AsyncIterator[Station]:
    here = Station()
    yield here
    await here.close()


async def heard(link: MemoryLink, seconds: float) -> bytes:
    """Return all that comes within `seconds`."""
    data = b""
    try:
        async with asyncio.timeout(seconds):
            while chunk := await link.read():
                data += chunk
    except TimeoutError:
        pass
    return data


async def test_a_second_client_is_turned_away_and_the_first_lives(station: Station) -> None:
    async with connect_async(station.open) as driver:
        await hold(driver, 0.2)
        second = station.plug_in()
        await second.write(frame(commands.EStop()) + frame(commands.Enable(on=False)))
        assert await second.read() == b""
        await hold(driver, 0.2)
        assert station.firmware.body.speeds[0] == pytest.approx(0.2, abs=0.01)


async def test_a_hundred_sessions_one_after_the_other(station: Station) -> None:
    for number in range(100):
        async with connect_async(station.open) as driver:
            driver.drive(0.2)
            async for snapshot in driver.snapshots(0.35):
                assert snapshot.link.sessions == 1
                assert snapshot.odometry.robot_in_odom.x < 0.1  # each session begins at 0
        await asyncio.sleep(0.05)
        assert not station.firmware.device.is_open, number
    done = [task for task in station.tasks if task.done()]
    assert len(done) == 100


async def driven_and_killed(station: Station) -> None:
    """Drive as a program does that is killed."""
    link = station.plug_in()
    await link.write(SYNCS + OPEN + frame(commands.Enable(on=True)) + frame(commands.Vel(0.3)))
    await asyncio.sleep(1.0)
    assert station.firmware.body.speeds[0] > 0.2
    await link.close()


async def test_a_client_that_vanishes_from_the_network_ends_its_session(station: Station) -> None:
    await driven_and_killed(station)
    await asyncio.sleep(BRAKES)
    assert not station.firmware.body.drive.powered
    assert abs(station.firmware.body.speeds[0]) < SLOW
    async with connect_async(station.open) as driver:
        assert await hold(driver, 0.2) == 0


async def test_a_program_of_arias_is_served_at_once_after_one_that_was_killed(
    station: Station,
) -> None:
    await driven_and_killed(station)
    link = station.plug_in()
    for number in (0, 1):  # it takes the first packet for the answer
        sync = encode(bytes([number]))
        await link.write(sync)
        assert await link.read() == sync
    await link.write(encode(b"\2"))
    assert b"MobileSim" in await link.read()
    assert not station.firmware.body.drive.powered
    await asyncio.sleep(BRAKES)
    assert abs(station.firmware.body.speeds[0]) < SLOW


async def test_a_session_that_is_kept_goes_on_until_the_watchdog_ends_it() -> None:
    station = Station(keep_session=True)
    await driven_and_killed(station)
    body = station.firmware.body
    await asyncio.sleep(0.9)
    assert body.speeds[0] > 0  # it cannot know yet
    await asyncio.sleep(0.2 + BRAKES)  # the watchdog first
    assert not body.drive.powered
    assert abs(body.speeds[0]) < SLOW
    async with connect_async(station.open) as driver:
        assert await hold(driver, 0.2) == 0
    await station.close()


@pytest.mark.parametrize("keep_session", [False, True])
async def test_a_driver_that_comes_at_once_after_one_that_vanished_is_served(
    *, keep_session: bool
) -> None:
    station = Station(keep_session=keep_session)
    await driven_and_killed(station)
    await asyncio.sleep(0)
    async with connect_async(station.open) as driver:
        await asyncio.sleep(1.0)
        assert station.firmware.body.speeds[0] == 0
        assert await hold(driver, 0.2) == 0
    await station.close()


async def test_half_a_packet_of_the_last_client_is_not_held_against_the_next(
    station: Station,
) -> None:
    first = station.plug_in()
    await first.write(encode(b"\x00")[:3])
    await first.close()
    await asyncio.sleep(1.0)
    second = station.plug_in()
    await second.write(encode(b"\x00"))
    assert await heard(second, 0.5) == encode(b"\x00")


async def test_a_client_that_hangs_loses_its_place(station: Station) -> None:
    hung = station.plug_in()
    await hung.write(SYNCS + OPEN)
    await asyncio.sleep(2.1)
    async with connect_async(station.open) as driver:
        assert await hold(driver, 0.2) == 0
        assert b"" in {await hung.read() for _ in range(50)}


async def test_random_bytes_do_no_harm(station: Station) -> None:
    random = Random(5)
    for _ in range(20):
        link = station.plug_in()
        for _ in range(20):
            await link.write(random.randbytes(500))
            await asyncio.sleep(0.02)
        await link.close()
        await asyncio.sleep(0.1)
    assert not station.firmware.body.drive.powered
    async with connect_async(station.open) as driver:
        assert await hold(driver, 0.2) == 0


async def test_every_command_with_any_arguments_does_no_harm(station: Station) -> None:
    random = Random(6)
    link = station.plug_in()
    await link.write(SYNCS + OPEN)
    for _ in range(20):
        for number in set(range(256)) - {2}:
            arguments = random.choice(
                [
                    b"",
                    bytes([random.choice([0x3B, 0x1B]), 0xFF, 0x7F]),
                    bytes([random.choice([0x3B, 0x1B]), *random.randbytes(2)]),
                    b"\x2b" + random.randbytes(8),
                    bytes([0, *random.randbytes(13)]),
                    random.randbytes(random.randrange(20)),
                ]
            )
            await link.write(encode(bytes([number]) + arguments))
        await asyncio.sleep(0.25)
        assert not [task.exception() for task in station.tasks if task.done()]
    await link.write(frame(commands.Close()))
    await link.close()
    await asyncio.sleep(0.1)
    async with connect_async(station.open) as driver:
        assert driver.snapshot is not None


async def test_a_client_that_comes_while_the_last_one_leaves_is_served(station: Station) -> None:
    first = station.plug_in()
    await first.write(SYNCS[:6])
    await asyncio.sleep(0.1)
    second = station.plug_in()
    await first.close()
    await second.write(SYNCS[:6])
    assert await second.read() == SYNCS[:6]


class Stuck:
    """A client that takes nothing any more."""

    def __init__(self) -> None:
        self.url = "memory:stuck"
        self.speeds: tuple[int, ...] = ()
        self.round_trip = 0.0
        self.closed = asyncio.Event()
        self.first = SYNCS + OPEN

    async def read(self) -> bytes:
        data, self.first = self.first, b""
        if not data:
            await self.closed.wait()
        return data

    async def write(self, data: bytes) -> None:
        if b"\x32" in data:
            await asyncio.Event().wait()

    async def set_speed(self, baud: int) -> None:
        raise NotImplementedError

    async def close(self) -> None:
        self.closed.set()


async def test_a_client_that_takes_nothing_does_not_stop_the_world(station: Station) -> None:
    stuck = Stuck()
    station.tasks.append(asyncio.ensure_future(station.port.serve(stuck)))
    await asyncio.sleep(10)
    assert stuck.closed.is_set()
    assert station.world.time > 8


async def test_a_robot_that_fails_is_cut_off_and_the_others_live(
    caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    world, firmwares = robots(2)
    simulation = Simulation(world, firmwares)
    task = asyncio.ensure_future(simulation.run())
    links = []
    for port in simulation.ports:
        ours, theirs = null_modem()
        links.append((ours, asyncio.ensure_future(port.serve(theirs))))
        await ours.write(SYNCS + OPEN)
        await heard(ours, 0.2)
        await ours.write(frame(commands.Enable(on=True)) + frame(commands.Vel(0.1)))
    await asyncio.sleep(0.5)
    assert world.robots[0].speeds[0] > 0

    def broken(now: float) -> None:
        raise RuntimeError("a defect")

    monkeypatch.setattr(firmwares[0], "tick", broken)
    for link, _ in links:
        await link.write(frame(commands.Pulse()))
    await asyncio.sleep(1.0)
    assert [port.connected for port in simulation.ports] == [False, True]
    assert caplog.text.count("the simulated robot failed") == 1
    assert [body.speeds[0] for body in world.robots] == pytest.approx([0.0, 0.1], abs=0.01)
    for waiting in (task, *(served for _, served in links)):
        waiting.cancel()
    await asyncio.gather(task, *(served for _, served in links), return_exceptions=True)


@pytest.mark.realtime
async def test_a_second_simulator_on_a_port_in_use_says_so() -> None:
    world, firmwares = robots()
    first = Simulation(world, firmwares)
    await first.listen(0)
    port = first.addresses[0][1]
    with pytest.raises(PortBusyError, match=rf"127.0.0.1:{port}: in use; is another simulator"):
        await Simulation(*robots()).listen(port)
    await ended(first)


@pytest.mark.realtime
async def test_several_robots_listen_on_consecutive_ports_or_on_none(unused_tcp_port: int) -> None:
    taken = await asyncio.start_server(lambda reader, writer: None, "127.0.0.1", 0)
    port = taken.sockets[0].getsockname()[1]
    async with taken:
        with pytest.raises(PortBusyError):
            await Simulation(*robots(2)).listen(port - 1)
        with pytest.raises(OSError, match=r"refused|failed"):
            await asyncio.open_connection("127.0.0.1", port - 1)
    simulation = Simulation(*robots(3))
    await simulation.listen(0)
    assert len({port for _, port in simulation.addresses}) == 3
    await ended(simulation)


@pytest.mark.realtime
@pytest.mark.parametrize(
    ("host", "port", "says"),
    [
        ("127.0.0.1", 70000, "127.0.0.1:70000: ports are numbers from 1 to 65535"),
        ("192.0.2.1", 8101, "192.0.2.1:8101: cannot listen there"),
        ("nowhere.invalid", 8101, "nowhere.invalid:8101: cannot listen there"),
    ],
)
async def test_an_address_that_is_not_ours_is_refused(host: str, port: int, says: str) -> None:
    with pytest.raises(LinkError, match=says):
        await Simulation(*robots()).listen(port, host)


async def ended(simulation: Simulation) -> None:
    task = asyncio.ensure_future(simulation.run())
    await asyncio.sleep(0.05)
    task.cancel()
    await asyncio.gather(task, return_exceptions=True)


@pytest.mark.realtime
async def test_ending_a_simulation_closes_its_ports_and_parts_from_its_clients() -> None:
    simulation = Simulation(*robots())
    await simulation.listen(0)
    host, port = simulation.addresses[0]
    task = asyncio.ensure_future(simulation.run())
    reader, writer = await asyncio.open_connection(host, port)
    writer.write(SYNCS + OPEN)
    async with asyncio.timeout(SOON):
        got = PacketReader().feed(await reader.read(1000))
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)
        while await reader.read(1000):
            pass
    assert reports.from_payload(got[0]) == reports.SyncEcho(0)
    writer.close()
    await writer.wait_closed()
    with pytest.raises(OSError, match=r"refused|failed"):
        await asyncio.open_connection(host, port)


@pytest.mark.realtime
async def test_a_tcp_connection_closed_inside_a_packet_is_opened_anew() -> None:
    simulation = Simulation(*robots())
    await simulation.listen(0)
    running = asyncio.ensure_future(simulation.run())
    connections = 0

    async def cut(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Relay; the first connection ends in the middle of a report."""
        nonlocal connections
        connections += 1
        first, passed = connections == 1, 0
        robot_reader, robot_writer = await asyncio.open_connection(*simulation.addresses[0])

        async def forward() -> None:
            while data := await reader.read(1000):
                robot_writer.write(data)
            robot_writer.close()

        forwarding = asyncio.ensure_future(forward())
        while data := await robot_reader.read(1000):
            passed += len(data)
            if first and passed > 3000:
                writer.write(data[: len(data) // 2])
                break
            writer.write(data)
        writer.close()
        robot_writer.close()
        forwarding.cancel()
        await asyncio.gather(forwarding, return_exceptions=True)

    server = await asyncio.start_server(cut, "127.0.0.1", 0)
    url = "tcp://{}:{}".format(*server.sockets[0].getsockname())
    async with server, asyncio.timeout(SOON), connect_async(url) as driver:
        holding = asyncio.ensure_future(hold(driver, 0.2, seconds=5))
        async for snapshot in driver.snapshots():
            if snapshot.link.sessions == 2:
                break
        await holding
        assert driver.snapshot is not None
        assert driver.snapshot.odometry.twist.v == 0
        assert not driver.snapshot.motors.enabled
        await asyncio.sleep(0.6)
        assert await hold(driver, 0.2) == 0
    await asyncio.sleep(0.1)
    running.cancel()
    await asyncio.gather(running, return_exceptions=True)
    assert connections == 2
