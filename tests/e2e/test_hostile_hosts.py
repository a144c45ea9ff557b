"""Hosts that mean no good, or know no better, over real sockets; the other robots do not notice."""

import asyncio
import os
import socket
import struct
import sys
from collections.abc import AsyncIterator, Coroutine, Sequence
from contextlib import ExitStack, asynccontextmanager, suppress
from io import FileIO
from math import inf
from random import Random
from stat import S_ISCHR

import pytest

from pioneer3 import connect_async
from pioneer3.arcos import commands
from pioneer3.arcos.packet import PacketReader, encode
from pioneer3.errors import PortBusyError
from pioneer3.geometry import Pose2
from pioneer3.models import load_model
from pioneer3.sim.body import Body
from pioneer3.sim.firmware import Firmware
from pioneer3.sim.server import Simulation
from pioneer3.sim.server.clients import STALE
from pioneer3.sim.server.pacer import TICK, Pacer
from pioneer3.sim.server.port import BURST, BYTES_PER_TICK
from pioneer3.sim.world import World
from tests.e2e.processes import PATIENCE
from tests.support import frame, hold, until

pytestmark = pytest.mark.realtime

SYNC = encode(b"\0")
SIPS = (0x32, 0x33)


class Host:
    """A host that speaks by hand."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.reader, self.writer = reader, writer
        self._packets = PacketReader()
        self._got: list[bytes] = []

    @classmethod
    async def connect(cls, port: int) -> "Host":
        return cls(*await asyncio.open_connection("127.0.0.1", port))

    async def next(self, *kinds: int) -> bytes | None:
        """Return the next packet of these kinds; `None` once the robot has parted."""
        while True:
            while self._got:
                if (payload := self._got.pop(0))[0] in kinds:
                    return payload
            try:
                data = await self.reader.read(4096)
            except ConnectionError:
                data = b""
            if not data:
                return None
            self._got = self._packets.feed(data)

    async def open(self) -> bool:
        """Shake hands; return whether the robot did, too."""
        for number in (0, 1, 2):
            with suppress(ConnectionError):
                self.writer.write(encode(bytes([number])))
            if await self.next(number) is None:
                return False
        self.writer.write(frame(commands.Open()))
        return await self.next(*SIPS) is not None

    async def close(self) -> None:
        self.writer.close()
        with suppress(ConnectionError):
            await self.writer.wait_closed()


class Lab:
    """Some robots that listen."""

    def __init__(self, count: int, pace: Pacer | None = None) -> None:
        model = load_model("p3dx-sh")
        self.bodies = [Body(model, Pose2(0, 2 * number, 0)) for number in range(count)]
        self.world = World(None, self.bodies)
        self.firmwares = [Firmware(self.world, body) for body in self.bodies]
        self.simulation = Simulation(self.world, self.firmwares, pace=pace)
        self.ports = self.simulation.ports

    def number(self, robot: int) -> int:
        return self.simulation.addresses[robot][1]

    async def host(self, robot: int) -> Host:
        """Return a host in session."""
        host = await Host.connect(self.number(robot))
        assert await host.open()
        return host


@asynccontextmanager
async def lab(
    count: int = 1,
    pace: Pacer | None = None,
    *,
    first: int = 0,
    ports: Sequence[int | None] = (),
) -> AsyncIterator[Lab]:
    here = Lab(count, pace)
    await here.simulation.listen(first, ports=ports)
    task = asyncio.ensure_future(here.simulation.run())
    async with asyncio.timeout(2 * PATIENCE):
        try:
            yield here
            assert not task.done()
        finally:
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)


async def all_reports_come(here: Lab, robot: int, while_: Coroutine[None, None, None]) -> None:
    """Check that `robot`'s host gets a report in each cycle while something else happens."""
    host = await here.host(robot)
    done = asyncio.ensure_future(while_)
    began, count = here.world.time, 0
    while not done.done() or count < 10:
        assert await host.next(*SIPS) is not None
        host.writer.write(frame(commands.Pulse()))
        count += 1
    assert count == pytest.approx((here.world.time - began) / 0.1, abs=5, rel=0.02)
    await done
    await host.close()


async def test_of_a_hundred_hosts_at_once_on_one_port_one_is_served() -> None:
    async with lab() as here:
        hosts = await asyncio.gather(*(Host.connect(here.number(0)) for _ in range(100)))
        served = await asyncio.gather(*(host.open() for host in hosts))
        assert served.count(True) == 1
        for host in hosts:
            await host.close()
        await until(lambda: not here.ports[0].connected)
        async with connect_async(f"tcp://127.0.0.1:{here.number(0)}") as driver:
            assert await hold(driver, 0.2) == 0


async def test_a_hundred_hosts_at_once_on_a_hundred_robots_are_all_served() -> None:
    async with lab(100) as here:
        hosts = await asyncio.gather(*(Host.connect(here.number(n)) for n in range(100)))
        assert all(await asyncio.gather(*(host.open() for host in hosts)))
        slots = [port.report_tick for port in here.ports]
        assert max(map(slots.count, slots)) <= 20
        for host in hosts:
            await host.close()


async def test_a_hundred_sessions_one_after_the_other() -> None:
    async with lab(1, Pacer(10)) as here:
        for number in range(100):
            host = await here.host(0)
            host.writer.write(frame(commands.Close()))
            await host.close()
            await until(lambda: not here.ports[0].is_open)
            assert here.firmwares[0].device.reader.packets == 5 * (number + 1)


async def test_thousands_of_connects_and_disconnects_leave_nothing_behind() -> None:
    def files() -> int:
        return len(os.listdir("/proc/self/fd"))  # noqa: PTH208  counting is enough

    async with lab(2) as here:

        async def storm() -> None:
            for number in range(2000):
                one = socket.socket()
                one.setblocking(False)
                await asyncio.get_running_loop().sock_connect(one, ("127.0.0.1", here.number(0)))
                if number % 3 == 0:
                    one.send(SYNC)
                if number % 2:  # leave with a reset in place of a farewell
                    one.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
                one.close()

        before = files()
        await all_reports_come(here, 1, storm())
        await until(lambda: files() <= before)
        host = await here.host(0)
        await host.close()


@pytest.mark.parametrize(
    "flood",
    [
        Random(1).randbytes(1 << 16),
        b"\xfa\xfb\x00" * 20_000,
        b"\xfa\xfb\xff" * 20_000,
        frame(commands.RequestConfig()) * 10_000,
        frame(commands.Open()) * 10_000,
        encode(b"\0") * 10_000,
    ],
    ids=["random", "count 0", "count 255", "requests", "open", "sync"],
)
async def test_a_flood_costs_the_others_nothing(flood: bytes) -> None:
    async with lab(2, Pacer(5)) as here:
        flooder = await here.host(0)
        reader = here.firmwares[0].device.reader
        at_first = reader.packets * 6, here.world.time

        async def pour() -> None:
            end = here.world.time + 2
            while here.world.time < end:
                flooder.writer.write(flood)
                with suppress(TimeoutError):
                    async with asyncio.timeout(0.1):
                        await flooder.writer.drain()

        drinking = asyncio.ensure_future(flooder.next(0xFF))
        await all_reports_come(here, 1, pour())
        taken = reader.packets * 6 + reader.bytes_skipped - at_first[0]
        ticks = (here.world.time - at_first[1]) / TICK
        assert taken <= ticks * BYTES_PER_TICK + BURST + 300
        flooder.writer.transport.abort()
        assert await drinking is None


async def test_a_flood_that_never_ends_gives_way_to_the_next_host() -> None:
    async with lab() as here:
        flooder = await here.host(0)
        flooder.writer.write(encode(b"\0") * 1_000_000)
        await asyncio.sleep(STALE + 0.2)
        async with connect_async(f"tcp://127.0.0.1:{here.number(0)}") as driver:
            assert await hold(driver, 0.2, seconds=0.5) == 0
        flooder.writer.transport.abort()


async def test_a_host_that_takes_nothing_is_cut_off() -> None:
    async with lab(2, Pacer(100)) as here:
        stuck = socket.socket()
        stuck.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        stuck.connect(("127.0.0.1", here.number(0)))
        stuck.send(b"".join(encode(bytes([number])) for number in (0, 1, 2)))
        stuck.send(frame(commands.Open()) + encode(b"\x25\x1b\x02\x00") + encode(b"\x23\x3b\x02\0"))

        async def wait() -> None:
            await until(lambda: here.ports[0].is_open)
            await until(lambda: not here.ports[0].connected)

        await all_reports_come(here, 1, wait())
        stuck.close()


async def test_a_half_open_connection_gives_way_to_the_next_host() -> None:
    async with lab() as here:
        gone = await here.host(0)  # and never again a word, as when its machine has crashed
        refused = await Host.connect(here.number(0))
        assert not await refused.open()
        await asyncio.sleep(STALE)
        url = f"tcp://127.0.0.1:{here.number(0)}"
        async with connect_async(url) as driver:
            assert await hold(driver, 0.2) == 0
        assert await gone.next(0xFF) is None
        await gone.close()
        await refused.close()


async def test_a_terminal_beside_tcp_serves_whoever_comes_first() -> None:
    async with lab(2) as here:
        paths = here.simulation.open_ptys()
        assert len(set(paths)) == 2
        assert all(S_ISCHR(os.stat(path).st_mode) for path in paths)  # noqa: PTH116
        async with connect_async(paths[1]) as driver:
            assert await hold(driver, 0.2, seconds=0.5) == 0
            assert here.ports[1].peer == paths[1]
            assert here.bodies[1].speeds[0] > 0.1
            late = await Host.connect(here.number(1))
            assert not await late.open()
            await late.close()
        await until(lambda: not here.ports[1].connected)
        host = await here.host(1)
        assert here.ports[1].peer != paths[1]
        await host.close()
        await until(lambda: not here.ports[1].connected)
        async with connect_async(paths[1]) as driver:
            assert await hold(driver, 0.2, seconds=0.5) == 0
    with pytest.raises(FileNotFoundError):
        os.stat(paths[0])  # noqa: PTH116


async def test_a_terminal_that_nobody_reads_loses_what_it_is_sent() -> None:
    async with lab(1, Pacer(100)) as here:
        (path,) = here.simulation.open_ptys()
        with FileIO(path, "r+") as line:
            line.write(b"".join(encode(bytes([number])) for number in (0, 1, 2)))
            line.write(frame(commands.Open()))
            await until(lambda: here.ports[0].is_open)
            end = here.world.time + 100
            await until(lambda: here.world.time > end)
            assert here.ports[0].connected


async def test_a_cable_that_is_pulled_out_ends_the_connection_until_it_is_back() -> None:
    async with lab() as here:
        url = f"tcp://127.0.0.1:{here.number(0)}"
        async with connect_async(url) as driver:
            assert await hold(driver, 0.2, seconds=0.3) == 0
            here.ports[0].faults.unplug()
            await until(lambda: driver.snapshot is None)
            other = await Host.connect(here.number(0))
            assert not await other.open()
            await other.close()
            assert not here.ports[0].connected
            here.ports[0].faults.plug_in()
            await until(lambda: driver.snapshot is not None)


async def test_robots_come_and_go() -> None:
    async with lab(2) as here:
        body = here.bodies[1]
        free = socket.create_server(("127.0.0.1", 0))
        with free, pytest.raises(PortBusyError, match="in use"):
            await here.simulation.add(Firmware(here.world, body), free.getsockname()[1])
        assert len(here.ports) == 2
        newcomer = Firmware(here.world, body)
        number = await here.simulation.add(newcomer)
        assert here.simulation.addresses[2] == ("127.0.0.1", number)
        host = await here.host(2)
        await here.simulation.remove(newcomer)
        assert await host.next(0xFF) is None
        await host.close()
        assert not newcomer.device.is_open
        with pytest.raises(ConnectionRefusedError):
            await Host.connect(number)


def free_row(length: int) -> int:
    """Return the first of so many consecutive ports that nobody listens on."""
    while True:
        with ExitStack() as stack, suppress(OSError):
            one = stack.enter_context(socket.create_server(("127.0.0.1", 0)))
            first: int = one.getsockname()[1]
            for number in range(first + 1, first + length):
                stack.enter_context(socket.create_server(("127.0.0.1", number)))
            return first


async def test_ports_are_consecutive_but_for_those_that_are_given() -> None:
    first = free_row(4)
    async with lab(3, first=first, ports=[None, first + 1]) as here:
        numbers = [number for _, number in here.simulation.addresses]
        assert numbers == [first, first + 1, first + 2]
        assert await here.simulation.add(Firmware(here.world, here.bodies[0])) == first + 3
        host = await here.host(1)
        await host.close()
    with pytest.raises(ConnectionRefusedError):
        await Host.connect(first + 1)


PROGRAM = """
import asyncio, math
from pioneer3.cli.process import run_until_told_to_leave
from pioneer3.models import load_model
from pioneer3.sim.body import Body
from pioneer3.sim.firmware import Firmware
from pioneer3.sim.server.pacer import Pacer
from pioneer3.sim.server import Simulation
from pioneer3.sim.world import World

async def main():
    body = Body(load_model("p3dx-sh"))
    world = World(None, [body])
    simulation = Simulation(world, [Firmware(world, body)], pace=Pacer({pace}))
    await simulation.listen(0)
    print(simulation.addresses[0][1], *simulation.open_ptys(), flush=True)
    await simulation.run()

raise SystemExit(run_until_told_to_leave(main()))
"""


@pytest.mark.parametrize("pace", ["1.0", "math.inf", "paused=True", "lock_step=True"])
async def test_a_signal_ends_it_whatever_it_is_doing(pace: str) -> None:
    code = PROGRAM.format(pace=pace)
    child = await asyncio.create_subprocess_exec(
        sys.executable,
        *("-X", "dev", "-W", "error", "-c", code),
        stdout=asyncio.subprocess.PIPE,
        stderr=asyncio.subprocess.PIPE,
    )
    assert child.stdout is not None
    try:
        async with asyncio.timeout(PATIENCE):
            number, _ = (await child.stdout.readline()).split()
            host = await Host.connect(int(number))
            assert await host.open()
            drinking = asyncio.ensure_future(host.next(0xFF))
            await asyncio.sleep(0.1)
            child.terminate()
            assert await drinking is None
            _, errors = await child.communicate()
            await host.close()
    finally:
        if child.returncode is None:
            child.kill()
            await child.wait()
    slow = b"Executing <"  # what development mode says of a busy machine
    assert [line for line in errors.splitlines() if not line.startswith(slow)] == []
    assert child.returncode == 128 + 15


async def test_as_fast_as_possible_hosts_are_still_heard() -> None:
    async with lab(1, Pacer(inf)) as here:
        host = await here.host(0)
        host.writer.write(frame(commands.RequestConfig()))
        assert await host.next(0x20) is not None
        await until(lambda: here.simulation.pace.real_time_factor > 1)
        await host.close()
