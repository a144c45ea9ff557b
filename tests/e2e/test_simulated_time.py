"""Pacer: the same bytes give the same simulation at any speed; pause, steps, lock step."""

import asyncio
from collections.abc import AsyncIterator, Callable, Mapping
from contextlib import asynccontextmanager
from math import inf

import pytest

from pioneer3 import connect_async
from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command
from pioneer3.arcos.packet import PacketReader, encode
from pioneer3.geometry import Pose2
from pioneer3.links.memory import MemoryLink, null_modem
from pioneer3.models import load_model
from pioneer3.sim.body import Body
from pioneer3.sim.firmware import Firmware
from pioneer3.sim.realism import Realism
from pioneer3.sim.server import Simulation
from pioneer3.sim.server.faults import LinkFaults
from pioneer3.sim.server.pacer import PATIENCE, TICK, Pacer
from pioneer3.sim.world import World
from tests.support import frame, hold, until, wall_at

SYNCS = b"".join(encode(bytes([number])) for number in (0, 1, 2))
HELLO = SYNCS + frame(commands.Open())
PULSE = frame(commands.Pulse())
CYCLE = 5
"""Ticks."""


class Watched(World):
    """A world that tells when a step has been made."""

    ticks = 0

    def watch(self, stepped: Callable[[int], None]) -> None:
        self._stepped = stepped

    def step(self, dt: float) -> None:
        super().step(dt)
        self.ticks += 1
        self._stepped(self.ticks)


class Scripted:
    """A host that says what its script has for the tick, and keeps what it gets, and when."""

    permanent = False
    full = False

    def __init__(self, name: str, script: Mapping[int, bytes], world: World) -> None:
        self.peer, self.script, self.world = name, script, world
        self.got: list[tuple[float, bytes]] = []

    def resume(self) -> None: ...

    def pause(self) -> None: ...

    def close(self) -> None: ...

    def send(self, data: bytes) -> None:
        self.got.append((self.world.time, data))


def script(*commands_by_cycle: tuple[int, Command], cycles: int = 100) -> dict[int, bytes]:
    """Return what to say after which tick: one write in each cycle."""
    said = {CYCLE * cycle: PULSE for cycle in range(2, cycles)} | {CYCLE: HELLO}
    for cycle, command in commands_by_cycle:
        said[CYCLE * cycle] += frame(command)
    return said


ROUND = script(
    (3, commands.Enable(on=True)),
    (4, commands.Vel(0.4)),
    (12, commands.RVel(0.5)),
    (20, commands.RequestConfig()),
    (40, commands.Vel(-0.2)),
    (60, commands.DHead(1.0)),
    (80, commands.EStop()),
)
ANOTHER = script(
    (5, commands.Enable(on=True)),
    (6, commands.Move(1.5)),
    (50, commands.Vel2(10, -10)),
    (70, commands.IoRequest(commands.RequestMode.STREAM)),
    (90, commands.Close()),
)


async def played(pace: Pacer, faults: str = "") -> list[list[tuple[float, bytes]]]:
    """Return what two robots that see each other and a wall say to two scripts, and when."""
    model = load_model("p3dx-sh")
    bodies = [Body(model), Body(model, Pose2(1.5, 1.0, 3.0))]
    world = Watched(wall_at(4.0), bodies)
    simulation = Simulation(world, [Firmware(world, body) for body in bodies], pace=pace)
    hosts = [Scripted("one", ROUND, world), Scripted("other", ANOTHER, world)]

    def stepped(tick: int) -> None:
        if world.time > 10:
            pace.pause()  # as fast as possible leaves no moment to look
        for host, port in zip(hosts, simulation.ports, strict=True):
            if data := host.script.get(tick):
                port.received(host, data)

    world.watch(stepped)
    for host, port in zip(hosts, simulation.ports, strict=True):
        port.faults = LinkFaults.parse(faults)
        port.admit(host)
    async with running(simulation):
        await until(lambda: world.time > 10.0)
    ended = [[(at, data) for at, data in host.got if at < 10] for host in hosts]
    assert bodies[0].robot_in_world != bodies[0].home
    return ended


@asynccontextmanager
async def running(simulation: Simulation) -> AsyncIterator[None]:
    task = asyncio.ensure_future(simulation.run())
    await asyncio.sleep(0)
    try:
        yield
    finally:
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)


async def test_the_same_bytes_at_the_same_ticks_give_the_same_bytes_at_any_pace() -> None:
    faults = "drop=0.05,corrupt=0.002,delay=0.13,seed=4"
    loop = asyncio.get_running_loop()
    began = loop.time()
    real_time = await played(Pacer(), faults)
    assert loop.time() - began == pytest.approx(10, abs=0.3)
    assert all(len(said) > 80 for said in real_time)
    for pace in (
        Pacer(10),
        Pacer(0.5),
        Pacer(inf),
        Pacer(lock_step=True),
        Pacer(inf, lock_step=True),
    ):
        assert await played(pace, faults) == real_time


async def test_the_pace_may_change_at_any_time_without_a_trace() -> None:
    pace = Pacer()

    async def meddle() -> None:
        for speed in (3.0, 0.3, 50.0, 1.0):
            await asyncio.sleep(0.31)
            pace.speed = speed
            pace.pause()
            await asyncio.sleep(1)
            pace.step(0.06)
            await asyncio.sleep(1)
            pace.resume()

    meddling = asyncio.ensure_future(meddle())
    changed = await played(pace)
    await meddling
    assert changed == await played(Pacer())


TOLD = (
    (0.333, HELLO),
    (1.217, frame(commands.Enable(on=True)) + frame(commands.Vel(0.3))),
    (2.105, frame(commands.Vel(0))),
    (4.0, PULSE),
    (6.05, frame(commands.DHead(0.7))),
)
"""Bytes of a host that says nothing between, and when it sends them [s]."""


async def heard(seconds: float, *, watched: bool = False) -> tuple[list[tuple[float, bytes]], int]:
    """Return what a robot says to that host, and when, and how often the loop woke up."""
    loop, bodies = asyncio.get_running_loop(), [Body(load_model("p3dx-sh"))]
    world = World(wall_at(4.0), bodies, seed=3, realism=Realism())
    simulation, wakes = Simulation(world, [Firmware(world, world.robots[0])]), 0
    simulation.watched = watched
    turn = simulation._turn

    async def counted(clock: Callable[[], float]) -> float:
        nonlocal wakes
        wakes += 1
        return await turn(clock)

    simulation._turn = counted  # type: ignore[method-assign]
    ours, theirs = null_modem()
    began, got = loop.time(), list[tuple[float, bytes]]()

    async def listen() -> None:
        while data := await ours.read():
            got.append((round(loop.time() - began, 6), data))

    others = [asyncio.ensure_future(each) for each in (simulation.ports[0].serve(theirs), listen())]
    async with running(simulation):
        for at, data in TOLD:
            await asyncio.sleep(began + at - loop.time())
            await ours.write(data)
        await asyncio.sleep(began + seconds - loop.time())
    for task in others:
        task.cancel()
    await asyncio.gather(*others, return_exceptions=True)
    return got, wakes


async def test_a_world_sleeps_between_reports_and_nobody_notices(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asleep, wakes = await heard(9.0)
    monkeypatch.setattr(Simulation, "_idle_ticks", lambda simulation: 0)
    awake, all_wakes = await heard(9.0)
    assert len(awake) > 50
    assert [data for _, data in asleep] == [data for _, data in awake]
    earlier = [one - other for (one, _), (other, _) in zip(awake, asleep, strict=True)]
    assert all(-1e-6 <= each <= TICK for each in earlier)  # answers need not wait for a tick
    assert wakes < all_wakes / 3


async def test_a_world_that_somebody_looks_at_sleeps_only_while_nothing_moves() -> None:
    alone, wakes = await heard(9.0)
    seen, more_wakes = await heard(9.0, watched=True)
    assert [data for _, data in seen] == [data for _, data in alone]
    assert more_wakes > 1.2 * wakes


async def test_steps_that_take_long_are_not_put_off_while_a_robot_moves() -> None:
    simulation = Simulation(world := World(None, [Body(load_model("p3dx-sh"))]), [])
    world.robots[0].enable_motors(on=True)
    world.robots[0].drive.linear.go(0.3)
    simulation._effort = 3e-4
    assert simulation._idle_ticks() == 4
    simulation._effort = 9e-4
    assert simulation._idle_ticks() == 2
    simulation._effort = 0.1
    assert simulation._idle_ticks() == 0
    world.robots[0].drive.linear.go(0.0)
    assert simulation._idle_ticks() == 4


class Lab:
    """Robots with cables in memory."""

    def __init__(self, pace: Pacer, count: int = 1) -> None:
        self.bodies = [Body(load_model("p3dx-sh"), Pose2(0, 3 * n, 0)) for n in range(count)]
        self.world = World(None, self.bodies)
        firmwares = [Firmware(self.world, body) for body in self.bodies]
        self.simulation = Simulation(self.world, firmwares, pace=pace)
        self.tasks: list[asyncio.Task[None]] = []

    async def __aenter__(self) -> "Lab":
        self.tasks.append(asyncio.ensure_future(self.simulation.run()))
        return self

    async def __aexit__(self, *error: object) -> None:
        for task in self.tasks:
            task.cancel()
        await asyncio.gather(*self.tasks, return_exceptions=True)

    async def open(self, number: int = 0) -> MemoryLink:
        ours, theirs = null_modem()
        port = self.simulation.ports[number]
        self.tasks.append(asyncio.ensure_future(port.serve(theirs)))
        return ours


async def sips(link: MemoryLink, count: int) -> None:
    """Wait until `count` reports have come."""
    reader, seen = PacketReader(), 0
    while seen < count:
        seen += sum(payload[0] in {0x32, 0x33} for payload in reader.feed(await link.read()))


async def passed(lab: Lab, seconds: float) -> float:
    """Return how much time passes in the world while `seconds` pass outside."""
    before = lab.world.time
    await asyncio.sleep(seconds)
    return lab.world.time - before


@pytest.mark.parametrize("speed", [10.0, 100.0])
async def test_a_driver_of_ours_drives_in_a_world_that_is_faster(speed: float) -> None:
    async with Lab(Pacer(speed)) as lab, connect_async(lab.open) as driver:
        assert await hold(driver, 0.3, seconds=3) == 0
        assert not lab.bodies[0].drive.held
        assert lab.bodies[0].robot_in_world.x > 3 * 0.3 * speed / 2


async def test_the_watchdog_counts_the_hosts_seconds_when_time_is_fast() -> None:
    async with Lab(Pacer(10)) as lab:
        link = await lab.open()
        await link.write(HELLO)
        await asyncio.sleep(1.9)
        assert not lab.bodies[0].drive.held
        await asyncio.sleep(0.3)
        assert lab.bodies[0].drive.held


async def test_in_a_pause_hosts_are_welcome_and_nothing_is_lost() -> None:
    async with Lab(Pacer(paused=True)) as lab:
        link = await lab.open()
        await link.write(SYNCS)
        await asyncio.sleep(0.1)
        assert (await link.read()).startswith(SYNCS[:12])
        await link.write(frame(commands.Open()))
        await asyncio.sleep(0.1)
        await link.write(frame(commands.Enable(on=True)) + frame(commands.Vel(0.3)))
        assert await passed(lab, 30) == 0
        body = lab.bodies[0]
        assert body.drive.powered
        assert body.speeds[0] == 0
        lab.simulation.pace.step(0.5)
        assert await passed(lab, 0.1) == pytest.approx(0.5)
        assert body.speeds[0] > 0
        lab.simulation.pace.resume()
        assert await passed(lab, 1.0) == pytest.approx(1.0, abs=0.03)
        assert body.speeds[0] == pytest.approx(0.3, abs=0.01)
        assert not body.drive.held


async def test_a_flood_in_a_pause_waits_and_is_all_heard() -> None:
    async with Lab(Pacer(paused=True)) as lab:
        link = await lab.open()
        await link.write(HELLO)
        await asyncio.sleep(0.1)
        reader = lab.simulation.ports[0].firmware.device.reader
        before = reader.packets
        for _ in range(100):
            await link.write(PULSE * 100)
        await asyncio.sleep(60)
        assert reader.packets - before == 10_000


async def test_lock_step_waits_for_the_slowest_host() -> None:
    async with Lab(Pacer(inf, lock_step=True), 2) as lab:
        links = [await lab.open(number) for number in range(2)]
        for link in links:
            await link.write(HELLO)

        async def answers(link: MemoryLink, after: float) -> None:
            while True:
                await sips(link, 1)
                await asyncio.sleep(after)
                await link.write(PULSE)

        tasks = [
            asyncio.ensure_future(answers(link, after))
            for link, after in zip(links, (0.0, 0.4), strict=True)
        ]
        await asyncio.sleep(1.0)
        assert await passed(lab, 4.0) == pytest.approx(1.0, abs=0.11)
        assert lab.simulation.pace.real_time_factor == pytest.approx(0.25, abs=0.1)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


async def test_lock_step_is_no_faster_than_asked_for() -> None:
    async with Lab(Pacer(2.0, lock_step=True)) as lab:
        link = await lab.open()
        await link.write(HELLO)

        async def answers() -> None:
            while True:
                await sips(link, 1)
                await link.write(PULSE)

        task = asyncio.ensure_future(answers())
        await asyncio.sleep(1.0)
        assert await passed(lab, 3.0) == pytest.approx(6.0, abs=0.2)
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)


async def test_each_step_in_lock_step_is_one_report() -> None:
    async with Lab(Pacer(inf, lock_step=True)) as lab:
        link = await lab.open()
        await link.write(HELLO)
        await sips(link, 1)
        await asyncio.sleep(0.2)
        for _ in range(20):
            before = lab.world.time
            await link.write(PULSE)
            await sips(link, 1)
            await asyncio.sleep(0.2)
            assert lab.world.time - before == pytest.approx(0.1)


async def test_a_silent_host_in_lock_step_costs_patience_until_its_watchdog_expires() -> None:
    async with Lab(Pacer(lock_step=True)) as lab:
        link = await lab.open()
        assert await passed(lab, 1.0) == pytest.approx(1.0, abs=0.03)  # nobody to wait for
        await link.write(HELLO)
        await asyncio.sleep(2.0)
        assert await passed(lab, 10 * PATIENCE) == pytest.approx(1.0, abs=0.11)
        await until(lambda: lab.bodies[0].drive.held)
        assert await passed(lab, 1.0) == pytest.approx(1.0, abs=0.15)
        await link.write(PULSE)
        await asyncio.sleep(0.3)
        assert await passed(lab, 2 * PATIENCE) == pytest.approx(0.2, abs=0.11)
        await link.close()
        await asyncio.sleep(PATIENCE)
        assert await passed(lab, 1.0) == pytest.approx(1.0, abs=0.15)


async def test_sessions_that_open_together_report_in_different_ticks() -> None:
    async with Lab(Pacer(), 20) as lab:
        links = [await lab.open(number) for number in range(20)]
        for link in links:
            await link.write(SYNCS)
        await asyncio.sleep(0.1)
        for link in links:
            await link.write(frame(commands.Open()))
        await asyncio.sleep(0.2)
        slots = [port.report_tick for port in lab.simulation.ports if port.is_open]
        assert sorted(slots) == [slot for slot in range(5) for _ in range(4)]


async def test_robots_come_and_go_while_time_passes() -> None:
    async with Lab(Pacer(10)) as lab:
        firmware = Firmware(lab.world, lab.bodies[0])
        port = lab.simulation.attach(firmware)
        lab.bodies.append(lab.bodies[0])
        link = await lab.open(1)
        await link.write(HELLO)
        await sips(link, 3)
        assert port.connected
        assert firmware.device.watchdog == 20
        await lab.simulation.remove(firmware)
        async with asyncio.timeout(5):
            while await link.read():
                pass
        assert not firmware.device.is_open
        with pytest.raises(ValueError, match="has no port here"):
            await lab.simulation.remove(firmware)
        assert await passed(lab, 1.0) == pytest.approx(10, abs=0.3)


async def test_simstat_tells_how_time_passes() -> None:
    async with Lab(Pacer(10)) as lab:
        await asyncio.sleep(2.5)
        times = lab.simulation.ports[0].firmware.console.step_times
        assert (times.simulated, times.wanted) == (0.1, 0.01)
        assert times.measured == pytest.approx(0.01, rel=0.05)


async def test_a_still_world_keeps_its_pace_and_bears_a_cable_that_is_pulled_out() -> None:
    lab = Lab(Pacer())
    async with lab:
        await asyncio.sleep(3.0)
        assert lab.simulation.pace.real_time_factor == pytest.approx(1.0, abs=0.03)
        link = await lab.open()
        await link.write(HELLO)
        await sips(link, 3)
        lab.simulation.ports[0].faults = LinkFaults.parse("unplugged")
        await asyncio.sleep(0.5)
        assert await passed(lab, 1.0) == pytest.approx(1.0, abs=0.11)
