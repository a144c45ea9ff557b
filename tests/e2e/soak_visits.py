"""Many visitors on the ports of one simulation, in real time: some behave, most do not."""

import asyncio
import gc
from collections import Counter
from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass
from math import radians
from pathlib import Path
from random import Random

from pioneer3.arcos import commands
from pioneer3.arcos.reports import Sip
from pioneer3.maps import LineMap
from pioneer3.sim.firmware import Firmware
from pioneer3.sim.server import Simulation
from pioneer3.sim.world import World
from pioneer3.tasks import running
from tests.e2e.plain_client import PATIENCE, SYNCS, PlainClient, TurnedAwayError, session
from tests.e2e.soak_hour import populate, troubles_of
from tests.support import frame

Visit = Callable[[int, Random], Awaitable[None]]
ON = commands.Enable(on=True)


@dataclass(frozen=True, slots=True, kw_only=True)
class Visited:
    """What came of it.

    Attributes:
        visits: How often each kind of visitor came and left.
        again: How often somebody was told no, and came again.
        stuck_ports: Ports that did not serve a good host in the end.
        troubles: What was wrong with which robot.
        grown_files: Open files of this process, after minus before.
        grown_tasks: The same of the loop's tasks.
        grown_objects: The same of objects; before is after each kind has come once.
    """

    visits: Counter[str]
    again: int
    stuck_ports: tuple[int, ...]
    troubles: tuple[str, ...]
    grown_files: int
    grown_tasks: int
    grown_objects: int


async def behaves(port: int, random: Random) -> None:
    """Drive a little and say goodbye."""
    async with session(port) as client:
        client.say(ON, commands.Vel(random.uniform(-0.5, 0.5)), commands.RVel(radians(40)))
        for _ in range(random.randrange(1, 4)):
            await client.next(Sip)


async def vanishes(port: int, random: Random) -> None:
    """Drive, and be gone without a word, with a reset."""
    client = await PlainClient.connect(port)
    await client.open()
    client.say(ON, commands.Vel(random.uniform(-0.5, 0.5)))
    await client.next(Sip)
    client.abort()


async def hangs_up(port: int, random: Random) -> None:
    """Leave somewhere in the handshake."""
    client = await PlainClient.connect(port)
    for sync in SYNCS[: random.randrange(4)]:
        client.send(sync)
    await asyncio.sleep(random.choice((0, 0.03)))
    await client.drop()


async def breaks_off(port: int, random: Random) -> None:
    """Leave in the middle of a packet."""
    client = await PlainClient.connect(port)
    await client.open()
    packet = frame(commands.Vel(0.3))
    client.send(packet[: random.randrange(1, len(packet))])
    await client.drop()


async def babbles(port: int, random: Random) -> None:
    """Say things that make no sense, some of which begin well."""
    client = await PlainClient.connect(port)
    for _ in range(random.randrange(1, 5)):
        client.send(random.choice((b"", b"\xfa\xfb\x00", b"\xfa\xfb\xff")) + random.randbytes(300))
        await asyncio.sleep(0)
    await client.drop()


async def mumbles(port: int, random: Random) -> None:
    """Drive over a bad line: bits flip, bytes are lost, packets come in pieces."""
    async with session(port) as client:
        for _ in range(20):
            data = bytearray(frame(commands.RVel(radians(random.uniform(-50, 50)))))
            data[random.randrange(len(data))] ^= 1 << random.randrange(8)
            cut = random.randrange(len(data))
            client.send(bytes(data[:cut]))
            client.send(bytes(data[cut + random.randrange(2) :]))
        await client.next(Sip)
        await client.next(Sip)


async def floods(port: int, random: Random) -> None:
    """Send much, read nothing, and vanish."""
    client = await PlainClient.connect(port)
    await client.open()
    client.send(frame(commands.RequestConfig()) * random.randrange(100))
    client.send(frame(commands.Pulse()) * random.randrange(3000))
    await asyncio.sleep(0.05)
    client.abort()


async def intrudes(port: int, random: Random) -> None:
    """Two at once: the second is told no, the first goes on."""
    async with session(port) as first:
        await first.next(Sip)
        second = await PlainClient.connect(port)
        try:
            await second.open()
        except TurnedAwayError:
            pass
        else:
            raise AssertionError(f"port {port} has served two hosts at once")
        await second.drop()
        await first.next(Sip)


VISITS: tuple[Visit, ...] = (
    behaves,
    vanishes,
    hangs_up,
    breaks_off,
    babbles,
    mumbles,
    floods,
    intrudes,
)


async def visit(line_map: LineMap, visits: int, *, robots: int = 20, seed: int = 0) -> Visited:
    """Let visitors come to every port, one after the other, to all ports at once."""
    world = World(line_map)
    firmwares = [Firmware(world, body) for body in populate(world, robots, Random(seed))]
    simulation = Simulation(world, firmwares)
    await simulation.listen(0)
    guests = Guests([port for _, port in simulation.addresses], seed)
    async with running(simulation.run()):
        await guests.come_once_each()
        await _all_left(firmwares)
        before = _in_use()
        await guests.come(visits - guests.visits.total())
        stuck = await guests.knock()
        await _all_left(firmwares)
        after = _in_use()
        troubles = troubles_of(world)
    return Visited(
        visits=guests.visits,
        again=guests.again,
        stuck_ports=tuple(stuck),
        troubles=tuple(troubles),
        grown_files=after[0] - before[0],
        grown_tasks=after[1] - before[1],
        grown_objects=after[2] - before[2],
    )


class Guests:
    """Those who come, and what becomes of them.

    Attributes:
        visits: How often each kind came and was served.
        again: How often somebody was told no, and came again.
    """

    def __init__(self, ports: Sequence[int], seed: int) -> None:
        self.visits: Counter[str] = Counter()
        self.again = 0
        self._ports = ports
        self._random = Random(seed)

    async def come_once_each(self) -> None:
        """Let each kind come once, one at each port."""
        async with asyncio.TaskGroup() as tasks:
            for number, kind in enumerate(VISITS):
                port = self._ports[number % len(self._ports)]
                tasks.create_task(self._served(kind, port, Random(number)))

    async def come(self, visits: int) -> None:
        """Share out visits among the ports; wait until all have left."""
        ports = len(self._ports)
        async with asyncio.TaskGroup() as tasks:
            for number, port in enumerate(self._ports):
                share = visits // ports + (number < visits % ports)
                tasks.create_task(self._come_to(port, share, Random(self._random.random())))

    async def knock(self) -> list[int]:
        """Return the ports that do not serve a good host."""

        async def serves(port: int) -> bool:
            try:
                await self._served(behaves, port, Random(0))
            except TimeoutError:
                return False
            return True

        served = await asyncio.gather(*(serves(port) for port in self._ports))
        return [port for port, good in zip(self._ports, served, strict=True) if not good]

    async def _come_to(self, port: int, visits: int, random: Random) -> None:
        for _ in range(visits):
            kind = random.choice(VISITS)
            await self._served(kind, port, random)

    async def _served(self, kind: Visit, port: int, random: Random) -> None:
        """Come until there is room: a port has to swallow first what a flood has left there."""
        async with asyncio.timeout(PATIENCE):
            while True:
                try:
                    await kind(port, random)
                except TurnedAwayError:
                    self.again += 1
                    await asyncio.sleep(0.1)
                else:
                    self.visits[getattr(kind, "__name__", "")] += 1
                    return


async def _all_left(firmwares: Sequence[Firmware]) -> None:
    """Wait until abandoned sessions have ended too, and the last sockets are closed."""
    async with asyncio.timeout(PATIENCE):
        while any(firmware.device.is_open for firmware in firmwares):  # noqa: ASYNC110
            await asyncio.sleep(0.05)
    await asyncio.sleep(0.2)


def _in_use() -> tuple[int, int, int]:
    """Return how many files, tasks and objects there are."""
    gc.collect()
    files = len(list(Path("/proc/self/fd").iterdir()))
    return files, len(asyncio.all_tasks()), len(gc.get_objects())
