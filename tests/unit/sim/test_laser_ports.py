"""Simulated lasers behind real sockets and real pseudo terminals."""

import asyncio
import os
import socket
import termios
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, suppress
from functools import partial
from itertools import pairwise

import pytest

from pioneer3.cli.sim import greeting
from pioneer3.errors import ConfigError, LinkError, PortBusyError
from pioneer3.links import Link, open_link
from pioneer3.links.serial import make_pty, terminal_speed
from pioneer3.models.lasers import LASERS
from pioneer3.sim.equipment import EquipmentOptions
from pioneer3.sim.server import clients, laser_ports
from pioneer3.sim.server.faults import LinkFaults
from pioneer3.sim.server.laser import SimulatedLaser
from pioneer3.sim.server.laser_ports import DEVICES, device_of
from pioneer3.sim.server.pacer import Pacer
from pioneer3.sim.server.start import simulator
from pioneer3.sim.worldfile import RobotSpec
from pioneer3.sim.worldfile.arguments import WorldOverrides
from tests.support import until
from tests.unit.sim.fake_laser import FakeDevice

pytestmark = pytest.mark.realtime


@pytest.fixture(autouse=True)
def _fake_devices(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(laser_ports, "device_of", FakeDevice)


def fitted(*lasers: str, port: int | None = None) -> WorldOverrides:
    """Return robots with these lasers."""
    return WorldOverrides(
        robots=tuple(
            RobotSpec(
                model="p3dx-sh",
                name=f"robot-{number}",
                equipment=EquipmentOptions(laser=name, laser_port=port),
            )
            for number, name in enumerate(lasers)
        )
    )


@asynccontextmanager
async def simulated(name: str, pace: Pacer | None = None) -> AsyncIterator[SimulatedLaser]:
    async with simulator(map_name="office", port=0, overrides=fitted(name), pace=pace) as running:
        (laser,) = running.lasers
        assert running.robots[0].laser is laser
        yield laser


async def read_until(link: Link, wanted: Callable[[bytes], bool], within: float = 10.0) -> bytes:
    data = b""
    async with asyncio.timeout(within):
        while not wanted(data):
            chunk = await link.read()
            assert chunk, "the connection has ended"
            data += chunk
    return data


def lines(count: int) -> Callable[[bytes], bool]:
    return lambda data: data.count(b"\n") >= count


async def test_a_host_on_the_network_gets_scans() -> None:
    async with simulated("ust-10lx") as laser:
        assert laser.pty is None
        link = await open_link(laser.url)
        await link.write(b"?S")
        data = await read_until(link, lines(10))
        assert data.startswith(b"!")
        began = [int(line.split()[0]) for line in data[1:].splitlines()[:10]]
        assert [later - one for one, later in pairwise(began)] == [25000] * 9
        assert data.splitlines()[5].split()[2] == b"1081"
        await link.close()


async def test_several_hosts_of_a_cola_unit_at_both_its_ports() -> None:
    overrides = fitted("lms-111")
    port = free_ports(1)
    async with simulator(map_name="office", port=port, overrides=overrides) as running:
        (laser,) = running.lasers
        assert len(laser.addresses) == 2
        links = [await open_link(f"tcp://{host}:{number}") for host, number in laser.addresses]
        for link in links:
            await link.write(b"S")
        for link in links:
            await read_until(link, lines(3))
            await link.close()


async def test_a_second_host_of_another_unit_is_turned_away() -> None:
    async with simulated("ust-10lx") as laser:
        first = await open_link(laser.url)
        await first.write(b"S")
        await read_until(first, lines(3))
        second = await open_link(laser.url)
        await ended(second)
        await read_until(first, lines(3))
        await first.close()
        await second.close()


async def ended(link: Link) -> None:
    """Wait until the far end has closed the connection."""
    with suppress(LinkError):  # closed with bytes that nobody has read
        async with asyncio.timeout(10):
            while await link.read():
                pass


def set_speed(terminal: int, baud: int) -> None:
    settings = termios.tcgetattr(terminal)
    settings[4] = settings[5] = getattr(termios, f"B{baud}")
    termios.tcsetattr(terminal, termios.TCSANOW, settings)


class Terminal:
    """A host at a pseudo terminal; it reads what is there."""

    def __init__(self, path: str, baud: int) -> None:
        self.file = os.open(path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        set_speed(self.file, baud)

    def write(self, data: bytes) -> None:
        os.write(self.file, data)

    async def read(self, seconds: float) -> bytes:
        """Return all that comes within so many seconds."""
        await asyncio.sleep(seconds)
        return self.now()

    def now(self) -> bytes:
        """Return all that has come."""
        try:
            return os.read(self.file, 65536)
        except BlockingIOError:
            return b""

    async def until(self, wanted: Callable[[bytes], bool]) -> bytes:
        """Return all that comes until it is as wanted."""
        data = b""
        async with asyncio.timeout(10):
            while not wanted(data):
                data += await self.read(0.02)
        return data

    def close(self) -> None:
        os.close(self.file)


@pytest.mark.parametrize("baud", [9600, 19200, 38400, 115200, 500000])
def test_the_speed_of_a_terminal_is_known(baud: int) -> None:
    pair = make_pty()
    set_speed(pair.slave, baud)
    assert terminal_speed(pair.master) == terminal_speed(pair.slave) == baud
    os.close(pair.master)
    os.close(pair.slave)
    assert terminal_speed(pair.slave) is None


async def test_at_a_terminal_only_the_speed_of_the_device_is_understood() -> None:
    async with simulated("lms-200") as laser:
        assert laser.pty is not None
        assert laser.device.speed == 9600
        host = Terminal(laser.pty, 19200)
        host.write(b"?")
        assert await host.read(0.2) == b""
        set_speed(host.file, 9600)
        host.write(b"?")
        assert await host.until(bool) == b"!"
        host.write(b"S")
        scans = await host.until(lines(3))
        assert len(scans.splitlines()[0].split()) == 4
        set_speed(host.file, 38400)
        await host.read(0.1)
        rubbish = await host.until(lambda data: len(data) > 200)
        assert len({*rubbish}) > 50  # of every value, not only digits
        host.close()


async def test_a_host_follows_a_device_that_changes_its_speed() -> None:
    async with simulated("lms-200") as laser:
        assert laser.pty is not None
        host = Terminal(laser.pty, 9600)
        host.write(b"F?")
        assert b"!" not in await host.read(0.2)
        set_speed(host.file, 4800)
        host.write(b"?")
        assert await host.until(bool) == b"!"
        host.close()


async def test_on_the_network_and_over_usb_speed_does_not_matter() -> None:
    async with simulated("lms-200") as laser:
        link = await open_link(laser.url)
        await link.write(b"F?")
        await read_until(link, lambda data: data == b"!")
        await link.close()
    async with simulated("utm-30lx") as usb:
        assert usb.pty is not None
        host = Terminal(usb.pty, 57600)
        host.write(b"?")
        assert await host.until(bool) == b"!"
        host.close()


async def test_a_stream_at_a_terminal_outlives_its_host() -> None:
    async with simulated("lms-200") as laser:
        assert laser.pty is not None
        host = Terminal(laser.pty, 9600)
        host.write(b"S")
        await host.until(lines(3))
        host.close()
        again = Terminal(laser.pty, 9600)
        await again.until(lines(9))
        again.close()


async def test_a_host_finds_no_old_bytes_at_a_terminal_that_nobody_read(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(clients, "UNREAD", 0.3)
    async with simulated("lms-200") as laser:
        assert laser.pty is not None
        host = Terminal(laser.pty, 9600)
        host.write(b"S")
        await host.until(lines(3))
        host.close()
        await asyncio.sleep(1.0)
        again = Terminal(laser.pty, 9600)
        assert len(again.now()) < 200
        again.write(b"?")
        assert (await again.read(0.2)).count(b"\n") > 5  # it may take its time now
        await again.until(lines(9))
        again.close()


async def test_a_host_on_the_network_takes_the_line_from_a_silent_terminal() -> None:
    async with simulated("lms-200") as laser:
        assert laser.pty is not None
        host = Terminal(laser.pty, 9600)
        host.write(b"S")
        await host.read(2.2)
        link = await open_link(laser.url)
        await read_until(link, lines(3))
        await link.close()
        host.close()


async def test_unplugging_and_plugging_in() -> None:
    async with simulated("ust-10lx") as laser:
        link = await open_link(laser.url)
        await link.write(b"S")
        await read_until(link, lines(3))
        laser.unplug()
        await ended(link)
        await link.close()
        laser.plug_in()
        again = await open_link(laser.url)
        await again.write(b"?")
        await read_until(again, lambda data: data == b"!")
        await again.close()


async def test_a_laser_that_fails_stops_nobody_else(caplog: pytest.LogCaptureFixture) -> None:
    overrides = fitted("ust-10lx", "lms-111")
    async with simulator(map_name="office", port=0, overrides=overrides) as running:
        bad, good = running.lasers
        link = await open_link(bad.url)
        await link.write(b"X")
        await ended(link)
        await link.close()
        assert caplog.text.count("the simulated laser failed") == 1
        assert not bad.powered
        other = await open_link(good.url)
        await other.write(b"S")
        await read_until(other, lines(3))
        await other.close()


async def test_time_that_stands_still_takes_no_scans() -> None:
    pace = Pacer()
    async with simulated("ust-10lx", pace) as laser:
        link = await open_link(laser.url)
        await link.write(b"S")
        await read_until(link, lines(3))
        pace.pause()
        await asyncio.sleep(0.1)
        assert isinstance(laser.device, FakeDevice)
        before = len(laser.device.sweeps)
        await link.write(b"?")
        await read_until(link, lambda data: b"!" in data)
        assert len(laser.device.sweeps) == before
        pace.step(0.1)
        await read_until(link, lines(3))
        await link.close()


async def test_lasers_come_and_go_with_their_robots() -> None:
    async with simulator(map_name="office", port=0, robot="p3dx-sh") as running:
        assert running.lasers == []
        spec = RobotSpec(
            model="p3dx-sh", port=0, equipment=EquipmentOptions(laser="ust-10lx", laser_port=None)
        )
        added = await running.add_robot(spec)
        assert added.laser is not None
        url = added.laser.url
        link = await open_link(url)
        await link.write(b"S")
        await read_until(link, lines(3))
        await running.remove_robot(added)
        await ended(link)
        await link.close()
        with pytest.raises(LinkError):
            await open_link(url)


def free_ports(count: int) -> int:
    """Return the first of so many free ports in a row."""
    for first in range(20000, 60000, 97):
        sockets = [socket.socket() for _ in range(count)]
        try:
            for number, each in enumerate(sockets, first):
                each.bind(("127.0.0.1", number))
        except OSError:
            continue
        finally:
            for each in sockets:
                each.close()
        return first
    raise AssertionError("no free ports")


async def test_ports_are_the_usual_ones_or_the_next_that_are_free() -> None:
    async with simulator(
        map_name="office",
        port=free_ports(6),
        overrides=fitted("utm-30lx", "ust-10lx", "lms-111", "lms-511", "lms-200"),
    ) as running:
        numbers = [[port for _, port in laser.addresses] for laser in running.lasers]
    used = [port for ports in numbers for port in ports]
    assert len({*used}) == len(used) == 7
    hokuyo, second, lms1xx, lms5xx, lms2xx = numbers
    assert 10940 <= hokuyo[0] < second[0] < 11040
    assert 2111 <= lms1xx[0] < lms1xx[1] < lms5xx[0] < lms5xx[1] < 2211
    assert 4001 <= lms2xx[0] < 4101


async def test_a_port_can_be_given_and_must_be_free() -> None:
    number = free_ports(1)
    overrides = fitted("utm-30lx", port=number)
    async with simulator(map_name="office", port=0, overrides=overrides) as running:
        assert running.lasers[0].url == f"tcp://127.0.0.1:{number}"
        with pytest.raises(PortBusyError, match=str(number)):
            async with simulator(map_name="office", port=0, overrides=overrides):
                pass


async def test_a_simulator_at_free_ports_has_its_lasers_there_too() -> None:
    async with simulated("lms-111") as laser:
        assert len(laser.addresses) == 1
        assert laser.addresses[0][1] not in {2111, 2112}


def test_there_is_a_device_for_every_protocol() -> None:
    assert {*DEVICES} == {model.protocol for model in LASERS.values()}


def test_a_protocol_that_is_not_simulated_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    model = LASERS["utm-30lx"]
    monkeypatch.setitem(DEVICES, model.protocol, ("pioneer3.lasers.nothing", "Nothing"))
    with pytest.raises(ConfigError, match="utm-30lx: SCIP is not simulated"):
        device_of(model)


async def test_the_simulator_tells_where_a_laser_is() -> None:
    async with simulator(map_name="office", port=0, overrides=fitted("utm-30lx")) as running:
        (laser,) = running.lasers
        line = next(line for line in greeting(running) if line.startswith("LASER"))
        where = f"laser at {laser.url} and {laser.pty}"
        assert line == f"LASER: Hokuyo UTM-30LX on robot-0: {where}"


async def test_faults_are_those_of_every_cable() -> None:
    overrides = fitted("ust-10lx", "lms-111")
    faults = LinkFaults(corrupt=1.0)
    async with simulator(map_name="office", port=0, overrides=overrides, faults=faults) as running:
        for laser in running.lasers:
            link = await open_link(laser.url)
            await link.write(b"???")
            device = laser.device
            assert isinstance(device, FakeDevice)
            await until(partial(device.has_heard, 3))
            assert not device.has_heard(1, b"?")
            await link.close()
