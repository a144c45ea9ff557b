"""How soon a robot stands while clients mean no good.

Attackers, viewers and the server are processes of their own. The robot is simulated in this one,
which has nothing else to do, or in the server's, as `pioneer3 run` does. All are at one address, as
an attacker is who sits at this very computer, or behind the same router.
"""

import asyncio
import json
import time
from collections.abc import AsyncIterator, Callable, Coroutine, Iterator
from contextlib import AbstractContextManager, asynccontextmanager, suppress
from functools import partial
from math import hypot, inf
from statistics import median
from typing import TypeVar
from urllib.parse import urlsplit

from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed

from benchmarks.hostile_clients import attackers
from benchmarks.nav_goals import at_once
from benchmarks.table import Row
from benchmarks.web_server import server_process
from benchmarks.web_viewers import viewers_process
from benchmarks.web_wire import Wire, wire_to
from pioneer3 import MotionError, Robot, connect_async
from pioneer3.arcos import commands
from pioneer3.geometry import Pose2
from pioneer3.links import Link
from pioneer3.maps import shipped_map
from pioneer3.nav.places import find_place, home
from pioneer3.navigation.navigator import Navigator
from pioneer3.sim.server.start import simulator
from pioneer3.tasks import running
from tests.conftest import VirtualTimeLoop
from tests.lasers import LaserUnit
from tests.support import SimulatedRobot
from tests.unit.web.browser import Browser, playground

FILES = 256
"""What the server under attack may open."""
IDLE, DRIPPING, FLOODERS, ASKERS, VIEWERS = 400, 300, 4, 20, 50
STOPS, STANDS = 20, 6
PATIENCE, STOP_PATIENCE = 15.0, 3.0
SPEED = 0.3
RENEWAL, FEWEST = 0.066, 30
"""Between two requests of a page that drives [s], and how many until it asks afresh."""
SETTLE = 0.5
"""Until the motors are seen to be off after an emergency stop [s]."""
STAND_BAR, FROZEN_BAR, STOP_BAR = 300.0, 800.0, 300.0
ROLL_BAR = 0.1
"""An emergency stop during a drive leaves no more way [m]."""
ASLEEP_BAR = 3.0
"""A page is silent for 2 s until its robot is stopped, which brakes then [s]."""
GONE = 6.0
"""How long a laser is unplugged, and watched afterwards [s]."""
FLOOD = 6.5
"""How long a program asks for stops in a loop [s]."""
BAUD_BYTES = 960.0
"""What a line of 9600 baud carries [bytes/s]."""

T = TypeVar("T")
Stand = Callable[[float], Coroutine[None, None, float]]
"""Waits until the robot stands, at the earliest then; returns when [s, monotonic]."""


def rows() -> Iterator[Row]:
    """Measure everything of this file."""
    yield from asyncio.run(_stops("wait", IDLE, f"{IDLE} idle connections, {FILES} files"))
    yield from asyncio.run(_stops("drip", DRIPPING, f"{DRIPPING} slow senders, {FILES} files"))
    yield from asyncio.run(_stops("ask", ASKERS, f"{ASKERS} askers in a loop"))
    yield from asyncio.run(_stands_apart())
    yield from asyncio.run(_stands_here())
    yield from asyncio.run(_flooded_link())
    with asyncio.Runner(loop_factory=partial(VirtualTimeLoop, inf)) as runner:
        yield from runner.run(_on_its_way())
        yield from runner.run(_asleep())


async def _stops(manner: str, count: int, what: str) -> list[Row]:
    """Stop by HTTP during an attack; see when the robot is told."""
    async with (
        simulator(port=0) as robot,
        wire_to(robot.url) as wire,
        _beside(server_process([wire.url], FILES)) as server,
    ):
        alone = [await _stop(server.address, wire) or 0.0 for _ in range(STOPS)]
        async with _beside(attackers(manner, server.address, count)):
            took = [await _stop(server.address, wire) for _ in range(STOPS)]
    answered = [ms for ms in took if ms is not None]
    return [
        Row("nobody else: HTTP e-stop to the wire, worst", max(alone), "ms", None),
        Row(f"{what}: e-stops that got through", len(answered), "", STOPS, more_is_better=True),
        Row(f"{what}: HTTP e-stop to the wire, median", median(answered or [0]), "ms", None),
        Row(f"{what}: HTTP e-stop to the wire, worst", max(answered or [0]), "ms", STOP_BAR),
    ]


async def _stop(address: str, wire: Wire) -> float | None:
    """Post an emergency stop over a new connection; return how long it took [ms]."""
    where = urlsplit(address).netloc
    arrival, asked = wire.next(commands.Stop), time.monotonic()
    writer = None
    try:
        async with asyncio.timeout(STOP_PATIENCE):
            _, writer = await asyncio.open_connection(*where.split(":"))
            writer.write(
                f"POST /api/emergency_stop HTTP/1.1\r\nHost: {where}\r\nContent-Length: 0\r\n\r\n"
                "".encode()
            )
            took = (await arrival - asked) * 1000
    except (OSError, TimeoutError):
        return None
    finally:
        if writer is not None:
            writer.close()
    await asyncio.sleep(0.2)
    return took


@asynccontextmanager
async def _beside(context: AbstractContextManager[T]) -> AsyncIterator[T]:
    """Enter and leave `context`, which waits for processes, beside this loop."""
    entered = await asyncio.to_thread(context.__enter__)
    try:
        yield entered
    finally:
        await asyncio.to_thread(context.__exit__, None, None, None)


async def _stands_apart() -> list[Row]:
    """Let pages drive a robot that is simulated here."""
    async with (
        simulator(port=0) as robot,
        _beside(server_process([robot.url])) as server,
    ):

        async def stand(after: float) -> float:
            assert robot.body.drive.linear.velocity, "it did not drive"
            while robot.body.drive.linear.velocity:
                await asyncio.sleep(0.002)
            return time.monotonic()

        return await _rows_of_stands("a robot elsewhere", server.address, stand)


async def _stands_here() -> list[Row]:
    """Let pages drive a robot that is simulated by their server."""
    async with _beside(server_process([])) as server:

        async def stand(after: float) -> float:
            while True:
                at = float(await asyncio.to_thread(server.lines.readline))
                if at > after:
                    return at

        return await _rows_of_stands("simulated by the server", server.address, stand)


async def _rows_of_stands(which: str, address: str, stand: Stand) -> list[Row]:
    """Drive from one page and stop from another, among viewers; then among flooders too."""
    url = f"{address.replace('http', 'ws', 1)}/ws"
    async with (
        connect(url) as driver,
        connect(url) as other,
        _beside(viewers_process(address, VIEWERS, 1e6)),
    ):
        pages = Pages(driver, other, stand)
        async with running(pages.look(), read(other)):
            alone = await _stands(f"{VIEWERS} viewers, {which}", pages, barred=False)
            async with _beside(attackers("ping", address, FLOODERS)):
                what = f"{FLOODERS} flooders, {VIEWERS} viewers, {which}"
                return alone + await _stands(what, pages, barred=True)


async def _stands(what: str, pages: "Pages", *, barred: bool) -> list[Row]:
    stopped, frozen = [], []
    for _ in range(STANDS):  # to and fro, so that it stays where nothing is in the way
        stopped.append(await pages.drive_and_end(SPEED, stop=True))
        frozen.append(await pages.drive_and_end(-SPEED, stop=False))
    return [
        Row(f"{what}: e-stop to stand, median", median(stopped), "ms", None),
        Row(f"{what}: e-stop to stand, worst", max(stopped), "ms", STAND_BAR if barred else None),
        Row(f"{what}: frozen to stand, median", median(frozen), "ms", None),
        Row(f"{what}: frozen to stand, worst", max(frozen), "ms", FROZEN_BAR if barred else None),
    ]


class Pages:
    """A page that drives, and an `other` one that stops."""

    def __init__(self, driver: ClientConnection, other: ClientConnection, stand: Stand) -> None:
        self._driver, self._other, self._stand = driver, other, stand
        self._speed = 0.0

    async def look(self) -> None:
        """Note how fast the robot is, until the page is closed."""
        with suppress(ConnectionClosed):
            async for text in self._driver:
                message = json.loads(text)
                if message["type"] == "robots":
                    self._speed = message["snapshots"][0]["twist"]["v"]

    async def drive_and_end(self, speed: float, *, stop: bool) -> float:
        """Drive until the robot does, then freeze, or stop; return the time to stand [ms]."""
        await self._other.send('{"type":"reset_emergency_stop"}')
        await asyncio.sleep(SETTLE)
        number = 0
        async with asyncio.timeout(PATIENCE):
            while number < FEWEST or self._speed / speed < 0.95:
                v = speed if number % FEWEST else 0  # a fresh wish, if the last was ignored
                await self._driver.send(f'{{"type":"drive","v":{v},"w":0}}')
                await asyncio.sleep(RENEWAL)
                number += 1
        await self._driver.send(f'{{"type":"drive","v":{speed},"w":0}}')
        asked = time.monotonic()
        if stop:
            await self._other.send('{"type":"emergency_stop"}')
        async with asyncio.timeout(PATIENCE):
            return (await self._stand(asked) - asked) * 1000


async def read(page: ClientConnection) -> None:
    """Read until the page is closed."""
    with suppress(ConnectionClosed):
        async for _ in page:
            pass


async def _on_its_way() -> list[Row]:
    """Stop a robot that drives to a place by itself; let its laser be unplugged and come back."""
    stopped = []
    for _ in range(STANDS):
        async with _going() as (sim, robot, _):
            stopped.append(await _coasts(sim, robot.emergency_stop))
    came = []
    for _ in range(2):
        async with _going() as (sim, _, laser):
            laser.unplug()
            await asyncio.sleep(GONE)
            there = sim.body.robot_in_world
            laser.plug_in()
            await asyncio.sleep(GONE)
            here = sim.body.robot_in_world
            came.append(hypot(here.x - there.x, here.y - there.y))
    return [
        Row("goto at 0.7 m/s: emergency stop to stand, worst", max(stopped), "m", ROLL_BAR),
        Row(f"goto, laser gone for {GONE:g} s and back: way afterwards", max(came), "m", 0.01),
    ]


async def _asleep() -> list[Row]:
    """Put the page to sleep that sent a robot through the office at full speed."""
    office = shipped_map("office")
    start, goal = home(office) or Pose2(), find_place(office, "Lobby")
    async with playground(start, line_map=office) as the, Browser(the.app) as page:
        for view in the.page.robots.values():
            view.navigation.in_thread = at_once
        await page.stay(1.0)
        page.say("goto", x=goal.x, y=goal.y, speed=0.7)
        body = the.simulation.robots[0].body
        while body.speeds[0] < 0.6:
            await page.stay(1.0)
        clock, begin = asyncio.get_running_loop().time, body.robot_in_world
        slept = clock()
        while any(body.speeds):
            await asyncio.sleep(0.01)
        end = body.robot_in_world
        way = hypot(end.x - begin.x, end.y - begin.y)
        return [
            Row("goto at 0.7 m/s, page asleep: to stand", clock() - slept, "s", ASLEEP_BAR),
            Row("the same: way", way, "m", None),
        ]


@asynccontextmanager
async def _going() -> AsyncIterator[tuple[SimulatedRobot, Robot, LaserUnit]]:
    """Let a robot be on its way through the office, at full speed."""
    office = shipped_map("office")
    start = home(office) or Pose2()
    sim = SimulatedRobot(office, home=start)
    async with (
        sim,
        LaserUnit(sim, "lms-111", serial=False) as laser,
        connect_async(sim.open, lasers=[laser.spec()]) as robot,
    ):
        navigator = await Navigator.on(robot, office, start=start, in_thread=at_once)
        async with running(navigator.run()):
            going = asyncio.ensure_future(navigator.goto(find_place(office, "Lobby"), 0.7))
            async with asyncio.timeout(PATIENCE):
                while sim.speed < 0.6:
                    await asyncio.sleep(0.02)
            yield sim, robot, laser
            going.cancel()
            await asyncio.gather(going, return_exceptions=True)


async def _coasts(sim: SimulatedRobot, stop: Callable[[], None]) -> float:
    """Stop a robot; return how far it comes until it stands [m]."""
    begin = sim.body.robot_in_world
    stop()
    async with asyncio.timeout(PATIENCE):
        while sim.speed:
            await asyncio.sleep(0.01)
    end = sim.body.robot_in_world
    return hypot(end.x - begin.x, end.y - begin.y)


class SlowLine:
    """A link that takes bytes as fast as 9600 baud carry them."""

    def __init__(self, link: Link) -> None:
        self._link = link
        self.url, self.speeds, self.round_trip = link.url, link.speeds, link.round_trip
        self.read, self.set_speed, self.close = link.read, link.set_speed, link.close

    async def write(self, data: bytes) -> None:
        """Send all of `data`, and wait until it has left."""
        await asyncio.sleep(len(data) / BAUD_BYTES)
        await self._link.write(data)


async def _flooded_link() -> list[Row]:
    """Ask for stops in a loop, of a robot at a slow line; see when it can be driven again."""
    rows = []
    for kind in ("stop", "emergency_stop"):
        async with SimulatedRobot() as sim:

            async def opened(sim: SimulatedRobot = sim) -> Link:
                return SlowLine(await sim.open())

            async with connect_async(opened) as robot:
                clock = asyncio.get_running_loop().time
                end, ask = clock() + FLOOD, getattr(robot, kind)
                while clock() < end:
                    ask()
                    await asyncio.sleep(0.001)
                asked = clock()
                robot.reset_emergency_stop()
                with suppress(TimeoutError):
                    async with asyncio.timeout(PATIENCE):
                        while not sim.speed:
                            with suppress(MotionError):
                                robot.drive(0.2)
                            await asyncio.sleep(0.05)
                took = clock() - asked
                stops = sum(isinstance(c, commands.Stop) for w in sim.wires for c in w.commands)
        rows.append(Row(f"{FLOOD:g} s of {kind} at 9600 baud: drives again", took, "s", 2))
        rows.append(Row(f"{FLOOD:g} s of {kind} at 9600 baud: STOPs sent", stops, "", None))
    return rows
