"""Bytes of a laser on a serial line leave one after the other, not in lumps. Virtual time."""

import asyncio
from itertools import pairwise

import pytest

from pioneer3.geometry import Pose2
from pioneer3.lasers.lms2xx.commands import MODE_OF_SPEED, CommandCode, OperatingMode, mode
from pioneer3.lasers.lms2xx.telegram import encode as telegram
from pioneer3.models import load_model
from pioneer3.models.lasers import load_laser
from pioneer3.sim.body import Body
from pioneer3.sim.server.laser import SimulatedLaser
from pioneer3.sim.server.laser_hosts import OneHost
from pioneer3.sim.server.laser_ports import device_of
from pioneer3.sim.server.pacer import TICK, Pacer
from pioneer3.sim.server.simulation import PIECES_APART, Simulation
from pioneer3.sim.world import World
from pioneer3.tasks import running
from tests.combinations import examples
from tests.support import wall_at

SCAN = b"\x02\x80\xd6\x02\xb0"
"""The head of a scan of 361 readings."""


class Terminal:
    """A host that notes when it gets bytes [s], and which."""

    permanent, peer, full = True, "memory", False

    def __init__(self) -> None:
        self.heard: list[tuple[float, bytes]] = []

    def resume(self) -> None:
        pass

    def pause(self) -> None:
        pass

    def send(self, data: bytes) -> None:
        self.heard.append((asyncio.get_running_loop().time(), data))

    def close(self) -> None:
        pass

    @property
    def data(self) -> bytes:
        """All that has come."""
        return b"".join(data for _, data in self.heard)

    def gaps(self) -> list[float]:
        """Return the times from one piece of a scan to the next of the same [s]."""
        heard = self.data
        heads = {at for at in range(len(heard)) if heard.startswith(SCAN, at)}
        first = min(heads, default=len(heard))
        gaps, place = [], 0
        for (before, data), (now, _) in pairwise(self.heard):
            place += len(data)
            if place not in heads and place > first:
                gaps.append(now - before)
        return gaps

    def count_by(self, when: float) -> int:
        """Return how many bytes have come by `when` [s]."""
        return sum(len(data) for at, data in self.heard if at <= when + 1e-6)


class Bench:
    """A simulation with one laser, and a host at its serial line."""

    def __init__(self, name: str, pace: Pacer) -> None:
        body = Body(load_model("p3dx-sh"), Pose2())
        self.simulation = Simulation(World(wall_at(3.0), [body]), [], pace=pace)
        model = load_laser(name)
        self.laser = SimulatedLaser(self.simulation.world, body, model, device_of(model))
        self.simulation.lasers.lasers.append(self.laser)
        self.host = Terminal()
        assert isinstance(self.laser.hosts, OneHost)
        self.laser.hosts.set_terminal(lambda: self.laser.device.speed)
        self.laser.hosts.admit(self.host)

    async def send(self, data: bytes, seconds: float) -> None:
        """Send bytes to the laser, and wait so long [s]."""
        self.laser.hosts.received(self.host, data)
        await asyncio.sleep(seconds)

    async def stream(self, baud: int, seconds: float) -> None:
        """Let an LMS-2xx send scans at this speed, and note those from the first on."""
        await self.send(mode(MODE_OF_SPEED[baud]), 0.5)
        await self.send(mode(OperatingMode.ALL_VALUES), seconds)


async def scans_of(pace: Pacer, baud: int, seconds: float = 3.0) -> Terminal:
    bench = Bench("lms-200", pace)
    async with running(bench.simulation.run()):
        await bench.stream(baud, seconds)
    return bench.host


@pytest.mark.parametrize("baud", [38400, 500000])
@pytest.mark.parametrize("speed", [1.0, 0.5, 2.0])
async def test_within_a_scan_no_bytes_are_long_in_coming(baud: int, speed: float) -> None:
    host = await scans_of(Pacer(speed), baud)
    gaps = host.gaps()
    assert len(gaps) > 100
    piece = 16 * 10 / baud / speed
    assert max(gaps) < max(PIECES_APART, piece) + 0.001


@pytest.mark.parametrize("baud", [9600, 38400, 500000])
async def test_no_byte_comes_later_than_in_whole_ticks(baud: int) -> None:
    even, by_ticks = await scans_of(Pacer(), baud), await scans_of(Pacer(lock_step=True), baud)
    shorter = min(len(even.data), len(by_ticks.data))
    assert shorter > 1500
    assert even.data[:shorter] == by_ticks.data[:shorter]
    for number in range(int(3 / TICK)):
        assert even.count_by(number * TICK) >= by_ticks.count_by(number * TICK)


async def test_a_scip_laser_leaves_out_no_more_scans_than_in_whole_ticks() -> None:
    counts = []
    for pace in (Pacer(), Pacer(lock_step=True)):
        bench = Bench("urg-04lx", pace)
        async with running(bench.simulation.run()):
            await bench.send(b"SCIP2.0\n", 0.2)
            await bench.send(b"SS115200\n", 0.2)
            await bench.send(b"MD0044072500000\n", 4.0)
        counts.append(bench.host.data.count(b"\n99b\n"))
    assert counts[0] == counts[1] > 10


@pytest.mark.parametrize("baud", [9600, 500000])
async def test_a_host_hears_the_answer_to_what_it_asks_between_scans(baud: int) -> None:
    bench = Bench("lms-200", Pacer())
    async with running(bench.simulation.run()):
        await bench.stream(baud, 1.0)
        for _ in range(examples(20)):
            before = len(bench.host.data)
            await bench.send(telegram(CommandCode.STATUS), 2.003)
            answer = bench.host.data[before:]
            assert b"\x06" in answer
            assert b"\x02\x80\x9a\x00\xb1" in answer


async def test_in_lock_step_bytes_come_in_whole_ticks() -> None:
    host = await scans_of(Pacer(lock_step=True), 38400, 1.0)
    assert {round(at / TICK, 3) % 1 for at, _ in host.heard} == {0.0}


async def test_while_time_stands_still_no_byte_leaves() -> None:
    bench = Bench("lms-200", Pacer())
    async with running(bench.simulation.run()):
        await bench.stream(38400, 1.007)
        bench.simulation.pace.pause()
        await asyncio.sleep(0.1)
        before = len(bench.host.data)
        await asyncio.sleep(1.0)
        assert len(bench.host.data) == before
        bench.simulation.pace.resume()
        await asyncio.sleep(1.0)
        assert len(bench.host.data) > before + 2000


@pytest.mark.parametrize("scans", [False, True])
async def test_the_simulation_wakes_up_between_ticks_only_for_bytes(*, scans: bool) -> None:
    bench = Bench("lms-200", Pacer())
    turns, exchange = 0, bench.laser.exchange

    def counted(now: float) -> None:
        nonlocal turns
        turns += 1
        exchange(now)

    async with running(bench.simulation.run()):
        await bench.send(b"", 1.0)
        bench.laser.exchange = counted  # type: ignore[method-assign]
        if scans:
            await bench.stream(9600, 0.5)
        else:
            await bench.send(b"", 1.0)
    by_ticks = 2 * round(1.0 / TICK)
    assert turns <= by_ticks + (110 if scans else 2)
    assert (turns > by_ticks + 20) is scans
