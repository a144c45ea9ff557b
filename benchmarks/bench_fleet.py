"""What a crowd of robots costs, each with a host over TCP, and how regularly it is served.

Simulator and hosts are processes of their own: `rows` starts them as `bench_fleet simulator` and
`bench_fleet hosts`.
"""

import asyncio
import cProfile
import json
import os
import pstats
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from random import Random
from statistics import median

from benchmarks.bench_kernels import MODEL, crowd, office
from benchmarks.table import Row, percentile_99
from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command
from pioneer3.arcos.packet import HEADER, encode
from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap
from pioneer3.sim.body import Body
from pioneer3.sim.firmware import Firmware
from pioneer3.sim.kernels import build_grid, compiled_kernels
from pioneer3.sim.server import Simulation
from pioneer3.sim.world import World

ROBOTS, OFFICES = 200, 16
SECONDS = 20.0
SETTLE = 3.0
"""Until all have opened their sessions and are under way [s]."""
PROFILE = "PIONEER3_FLEET_PROFILE"
"""Environment variable: where the simulator writes where its time went."""
SIPS = (0x32, 0x33)
SWEEPS = (0x60, 0x61)
LASER_ON = [encode(bytes([number, kind, value, 0])) for number, kind, value in (
    (36, 0x1B, 90), (37, 0x3B, 90), (38, 0x3B, 100), (35, 0x3B, 2)
)]  # fmt: skip
"""ARIA's own set-up of 181 beams (protocol.md 3.3)."""


@dataclass(frozen=True, slots=True)
class Served:
    """What the hosts got, one entry per robot and report or sweep [s]."""

    gaps: list[float]
    sip_rates: list[float]
    sweep_rates: list[float]


class Host(asyncio.Protocol):
    """A frugal host: opens a session, drives about, notes when reports come."""

    def __init__(self, number: int, *, laser: bool) -> None:
        self.sips: list[float] = []
        self.sweeps: list[float] = []
        self._random = Random(number)
        self._laser = laser
        self._buffer = bytearray()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Say hello."""
        assert isinstance(transport, asyncio.Transport)
        self._transport = transport
        transport.write(encode(b"\0"))

    def data_received(self, data: bytes) -> None:
        """Note reports; answer the handshake."""
        now, buffer = time.perf_counter(), self._buffer
        buffer += data
        while len(buffer) > 3 and len(buffer) >= (end := buffer[2] + 3):
            assert buffer.startswith(HEADER), "the simulator sent nonsense"
            self._take(buffer, now)
            del buffer[:end]

    def drive(self) -> None:
        """Go elsewhere, or say that we are still here."""
        if self._random.random() < 0.5:
            self._send(commands.Pulse())
        else:
            self._send(commands.Vel(self._random.uniform(-0.1, 0.4)))
            self._send(commands.RVel(self._random.uniform(-1, 1)))

    def leave(self) -> None:
        """Say goodbye."""
        self._send(commands.Close())
        self._transport.close()

    def _take(self, packet: bytearray, now: float) -> None:
        kind = packet[3]
        if kind in SIPS:
            self.sips.append(now)
        elif kind in SWEEPS and packet[6:8] == b"\0\0":
            self.sweeps.append(now)
        elif kind in {0, 1}:
            self._transport.write(encode(bytes([kind + 1])))
        elif kind == 2:
            self._send(commands.Open())
            self._send(commands.Enable(on=True))
            if self._laser:
                self._transport.writelines(LASER_ON)

    def _send(self, command: Command) -> None:
        self._transport.write(encode(commands.to_payload(command)))


async def visit(ports: list[int], seconds: float, *, laser: bool) -> Served:
    """Drive every robot for a while; return what came once all were under way."""
    loop = asyncio.get_running_loop()
    hosts = [Host(number, laser=laser) for number in range(len(ports))]
    for port, host in zip(ports, hosts, strict=True):
        await loop.create_connection(lambda host=host: host, "127.0.0.1", port)  # type: ignore[misc]
    began = time.perf_counter()
    counted_from = began + SETTLE
    for round_ in range(round((SETTLE + seconds) * 10)):
        for host in hosts[round_ % 5 :: 5]:
            host.drive()
        await asyncio.sleep(max(0.0, began + (round_ + 1) / 10 - time.perf_counter()))
    for host in hosts:
        host.leave()
    await asyncio.sleep(0.1)
    sips = [[at for at in host.sips if at > counted_from] for host in hosts]
    sweeps = [[at for at in host.sweeps if at > counted_from] for host in hosts]
    gaps = [later - earlier for times in sips for earlier, later in pairwise(times)]
    return Served(gaps, [_rate(times) for times in sips], [_rate(times) for times in sweeps])


def _rate(times: list[float]) -> float:
    return (len(times) - 1) / (times[-1] - times[0]) if len(times) > 1 else 0.0


async def simulate(count: int) -> None:
    """Run `count` robots in offices; print their ports."""
    kernels, walls = compiled_kernels(), office(OFFICES)
    places = crowd(kernels, build_grid(walls), count).poses.T.tolist()
    bodies = [Body(MODEL, Pose2(*place)) for place in places]
    world = World(LineMap(name="offices", walls=walls), bodies, kernels)
    simulation = Simulation(world, [Firmware(world, body) for body in bodies])
    await simulation.listen(0)
    task = asyncio.ensure_future(simulation.run())
    asyncio.get_running_loop().add_signal_handler(signal.SIGTERM, task.cancel)
    print(json.dumps([number for _, number in simulation.addresses]), flush=True)
    with suppress(asyncio.CancelledError):
        await task


@contextmanager
def simulator(count: int) -> Iterator[tuple[int, list[int]]]:
    """Run the simulator in a process of its own; yield its number and the robots' ports."""
    command = [sys.executable, "-m", "benchmarks.bench_fleet", "simulator", str(count)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            yield process.pid, json.loads(process.stdout.readline())
        finally:
            process.terminate()


def cpu_seconds(pid: int) -> float:
    """Return what a process has used of all cores [s]."""
    fields = Path(f"/proc/{pid}/stat").read_text("ascii").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def measured(count: int, seconds: float, *, laser: bool) -> tuple[float, Served]:
    """Return the simulator's share of a core and what its hosts got."""
    with simulator(count) as (pid, ports):
        arguments = [json.dumps(ports), str(seconds), "laser" if laser else ""]
        command = [sys.executable, "-m", "benchmarks.bench_fleet", "hosts", *arguments]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as hosts:
            time.sleep(SETTLE + 1.0)
            before, began = cpu_seconds(pid), time.perf_counter()
            time.sleep(seconds - 2.0)
            share = (cpu_seconds(pid) - before) / (time.perf_counter() - began)
            text = hosts.communicate()[0]
    return share, Served(**json.loads(text))


def rows(robots: int = ROBOTS, seconds: float = SECONDS) -> Iterator[Row]:
    """Measure everything of this file."""
    share, served = measured(robots, seconds, laser=False)
    who = f"{robots} robots over TCP"
    yield Row(f"{who}: simulator", share * 100, "%", 60)
    yield Row(f"{who}: pause between reports, median", median(served.gaps) * 1e3, "ms", 101)
    yield Row(
        f"{who}: pause between reports, 99th percentile",
        percentile_99(served.gaps) * 1e3,
        "ms",
        110,
    )
    yield Row(f"{who}: reports, slowest robot", min(served.sip_rates), "Hz", 9.95, True)
    share, served = measured(robots, seconds, laser=True)
    yield Row(f"{who}, 181 beams: simulator", share * 100, "%", 100)
    yield Row(
        f"{who}, 181 beams: pause, 99th percentile", percentile_99(served.gaps) * 1e3, "ms", 110
    )
    yield Row(f"{who}, 181 beams: sweeps, slowest robot", min(served.sweep_rates), "Hz", 9.95, True)


def main(role: str, *arguments: str) -> None:
    """Be the simulator, or the hosts."""
    if role == "hosts":
        ports, seconds, laser = arguments
        served = asyncio.run(visit(json.loads(ports), float(seconds), laser=bool(laser)))
        print(json.dumps({name: getattr(served, name) for name in Served.__slots__}))
    elif file := os.environ.get(PROFILE):
        profile = cProfile.Profile()
        with suppress(asyncio.CancelledError):
            profile.runcall(asyncio.run, simulate(int(arguments[0])))
        with Path(file).open("w", encoding="utf-8") as out:
            pstats.Stats(profile, stream=out).sort_stats("tottime").print_stats(45)
    else:
        asyncio.run(simulate(int(arguments[0])))


if __name__ == "__main__":
    main(*sys.argv[1:])
