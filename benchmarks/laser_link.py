"""From a simulated UTM-30LX over TCP to `Scan`: what it costs, how late, whether all come.

The simulator is another process. It writes down when it hands the last byte of each scan to the
operating system; both processes read the same monotonic clock.

    python -m benchmarks laser_link            # 30 s
    python -m benchmarks.laser_link 600        # so many seconds
"""

import asyncio
import subprocess
import sys
import time
from contextlib import suppress
from statistics import median
from threading import Thread
from typing import Any

from benchmarks.table import Row, percentile_99
from pioneer3.lasers.device import DeviceConnection
from pioneer3.links.urls import opener
from pioneer3.robot.lasers.driver import LaserConfig, LaserDriver
from pioneer3.sim.server.start import simulator
from pioneer3.sim.worldfile import parse_equipment
from pioneer3.sim.worldfile.arguments import WorldOverrides
from pioneer3.tasks import running

SECONDS = 30.0
WARM_UP = 2.0
ECHO = b"MD"


class Noted:
    """A connection that notes when scans leave; same contract as the connection inside."""

    def __init__(self, inside: DeviceConnection) -> None:
        self._inside = inside

    def receive(self, data: bytes, now: float) -> None:
        """Pass it on."""
        self._inside.receive(data, now)

    def outgoing(self, now: float) -> bytes:
        """Return the bytes, and print the time for each scan among them."""
        data = self._inside.outgoing(now)
        for _ in range(data.count(b"\n99b\n")):
            print(f"{time.monotonic():.6f}", flush=True)
        return data

    def close(self) -> None:
        """Pass it on."""
        self._inside.close()


async def serve() -> None:
    """Simulate the laser; print its URL, and a line for each scan, until cancelled."""
    overrides = WorldOverrides(equipment=parse_equipment("laser=utm-30lx"), seed=1)
    async with simulator(port=0, overrides=overrides) as running_simulator:
        laser = running_simulator.robots[0].laser
        assert laser is not None
        device: Any = laser.device
        connect = device.connect
        device.connect = lambda: Noted(connect())
        print(laser.url, flush=True)
        await asyncio.get_running_loop().create_future()


async def measure(seconds: float) -> list[Row]:
    """Receive scans for `seconds`."""
    command = [sys.executable, "-m", "benchmarks.laser_link", "serve"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        url = process.stdout.readline().strip()
        sent: list[float] = []
        reader = Thread(target=lambda: sent.extend(map(float, process.stdout or ())))
        reader.start()
        driver = LaserDriver(LaserConfig(url=url, open=opener(url)))
        arrivals: list[float] = []
        async with running(driver.run()):
            await driver.reading()
            await asyncio.sleep(WARM_UP)
            cpu, began, first = time.process_time(), time.monotonic(), driver.scans
            with suppress(TimeoutError):
                async with asyncio.timeout(seconds):
                    async for _ in driver.values():
                        arrivals.append(time.monotonic())  # noqa: PERF401
            share = (time.process_time() - cpu) / (time.monotonic() - began)
            received = driver.scans - first
        process.terminate()
        reader.join()
    late = [_after(sent, moment) for moment in arrivals]
    in_window = sum(began <= moment < began + seconds for moment in sent)
    return [
        Row("one UTM-30LX, 1081 beams at 40 Hz: driver", 100 * share, "%", 12),
        Row("last byte sent to Scan, median", 1000 * median(late), "ms", 2),
        Row("last byte sent to Scan, 99th percentile", 1000 * percentile_99(late), "ms", None),
        Row(f"scans in {seconds:g} s", received, "", None),
        Row("scans lost", max(0, in_window - received - 1), "", 0),
        Row("losses of the link", driver.losses, "", 0),
    ]


def _after(sent: list[float], moment: float) -> float:
    """Return how long after the last scan that was sent before it `moment` is [s]."""
    from bisect import bisect_right

    number = bisect_right(sent, moment)
    return moment - sent[number - 1] if number else 0.0


def rows() -> list[Row]:
    """Measure for half a minute."""
    return asyncio.run(measure(SECONDS))


if __name__ == "__main__":
    if sys.argv[1:] == ["serve"]:
        asyncio.run(serve())
    else:
        for row in asyncio.run(measure(float(sys.argv[1]) if sys.argv[1:] else SECONDS)):
            print(row, flush=True)
