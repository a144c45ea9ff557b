"""What the page costs with many robots and viewers, and how soon a press reaches the robot.

Simulator, server and viewers are processes of their own; all have one clock.
"""

import asyncio
import time
from collections.abc import Iterator
from contextlib import suppress
from statistics import median

from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed

from benchmarks.bench_fleet import cpu_seconds
from benchmarks.bench_fleet import simulator as simulators
from benchmarks.simulator import simulator_process
from benchmarks.table import Row, percentile_99
from benchmarks.web_key import rows_of_keys
from benchmarks.web_server import server_process
from benchmarks.web_soak import rows_of_soak
from benchmarks.web_viewers import viewers_process
from benchmarks.web_wire import Wire, wire_to
from pioneer3.arcos import commands

ROBOTS, VIEWERS = 20, 50
SECONDS = 15.0
PAGES, PRESSES = 10, 200
MESSAGES = 200
PATIENCE = 5.0


def rows() -> Iterator[Row]:
    """Measure everything of this file."""
    yield from rows_of_load()
    yield from asyncio.run(_presses())
    yield from rows_of_keys()
    yield from rows_of_soak()


def rows_of_load(seconds: float = SECONDS) -> Iterator[Row]:
    """Let many look at many."""
    with simulators(ROBOTS) as (_, ports):
        urls = [f"tcp://127.0.0.1:{port}" for port in ports]
        with server_process(urls) as server:
            with viewers_process(server.address, VIEWERS, seconds) as what_they_saw:
                before, began = cpu_seconds(server.pid), time.perf_counter()
                seen = what_they_saw()
                share = (cpu_seconds(server.pid) - before) / (time.perf_counter() - began)
            server.end()
            delays = [
                (at - server.arrivals[which]) * 1000
                for heard in seen.heard
                for which, at in heard.items()
                if which in server.arrivals
            ]
    who = f"{VIEWERS} viewers of {ROBOTS} robots"
    reports = len(seen.heard[0]) / ROBOTS / seconds
    yield Row(f"{who}: server with its drivers", share * 100, "%", 40)
    yield Row(f"{who}: report to page, median", median(delays), "ms", 30)
    yield Row(f"{who}: report to page, 99th percentile", percentile_99(delays), "ms", None)
    frames = seen.frames / VIEWERS / seconds
    yield Row(f"{who}: frames to each viewer", frames, "Hz", None)
    yield Row(f"{who}: reports seen of each robot", reports, "Hz", 9, more_is_better=True)


async def _presses() -> list[Row]:
    """Press and drive from a page among others; see when the robot is told."""
    with simulator_process() as url:
        async with wire_to(url) as wire:
            # the server connects through us: it is started and ended beside this loop
            context = server_process([wire.url])
            server = await asyncio.to_thread(context.__enter__)
            try:
                address = f"{server.address.replace('http', 'ws', 1)}/ws"
                pages = [await connect(address) for _ in range(PAGES)]
                reading = [asyncio.ensure_future(_read(page)) for page in pages]
                holding = asyncio.ensure_future(_hold(pages[0]))
                stops = [await _press(pages[-1], wire) for _ in range(PRESSES)]
                holding.cancel()
                # a key that is held must be let go before it counts again
                await pages[0].send('{"type":"drive","v":0,"w":0}')
                await _drive_off(pages[0], wire)
                drives = [await _drive(pages[0], wire, number) for number in range(MESSAGES)]
                for task in reading:
                    task.cancel()
                for page in pages:
                    await page.close()
            finally:
                await asyncio.to_thread(context.__exit__, None, None, None)
    return [
        Row(f"e-stop of a page of {PAGES} to the wire, median", median(stops), "ms", None),
        Row(f"e-stop of a page of {PAGES} to the wire, 99th", percentile_99(stops), "ms", 50),
        Row("drive message to velocity on the wire, median", median(drives), "ms", 10),
        Row("drive message to velocity on the wire, 99th", percentile_99(drives), "ms", None),
    ]


async def _hold(page: ClientConnection) -> None:
    """Hold a key all the while, as somebody does who has not noticed."""
    while True:
        await page.send('{"type":"drive","v":0.2,"w":0}')
        await asyncio.sleep(0.066)


async def _press(page: ClientConnection, wire: Wire) -> float:
    """Stop, while somebody else holds a key; return how long that took [ms]."""
    await asyncio.sleep(0.1)
    arrival, asked = wire.next(commands.Stop), time.monotonic()
    await page.send('{"type":"emergency_stop"}')
    took = await asyncio.wait_for(arrival, PATIENCE) - asked
    await page.send('{"type":"reset_emergency_stop"}')
    return took * 1000


async def _drive_off(page: ClientConnection, wire: Wire) -> None:
    """Hold a key until the robot is told of it; its motors may have to come on first."""
    arrival = wire.next(commands.Vel)
    async with asyncio.timeout(PATIENCE):
        while not arrival.done():
            await page.send('{"type":"drive","v":0.2,"w":0}')
            await asyncio.sleep(0.05)


async def _drive(page: ClientConnection, wire: Wire, number: int) -> float:
    """Ask for another velocity; return how long it took [ms]."""
    await asyncio.sleep(0.07)  # the driver sends a velocity every 0.05 s at most
    arrival, asked = wire.next(commands.Vel), time.monotonic()
    await page.send(f'{{"type":"drive","v":{0.1 + number % 2 / 10},"w":0}}')
    return (await asyncio.wait_for(arrival, PATIENCE) - asked) * 1000


async def _read(page: ClientConnection) -> None:
    with suppress(ConnectionClosed):
        async for _ in page:
            pass
