"""How much later a question to a robot is answered over a bridge, and what the bridge costs."""

import asyncio
import subprocess
import sys
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from statistics import median

from benchmarks.table import Row, percentile_99
from pioneer3.arcos import commands, reports
from pioneer3.arcos.device import Commanded, Device
from pioneer3.arcos.packet import PacketReader, encode
from pioneer3.state import Identity

QUESTIONS = 400
PAUSE = 0.01
SECONDS = 10.0
"""During which the bridge's share of a core is taken."""
REPORT = bytes.fromhex("326e00c8000000000000000000820000000001000000")
ANSWER = bytes([0x20]) + b"Pioneer\0p3at\0SIM\0"
ASK = encode(commands.to_payload(commands.RequestConfig()))


async def _robot(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    """Be a robot that answers at once, and reports ten times a second."""
    device = Device(Identity(name="bench", family="Pioneer", model="p3at"), watchdog=0)

    async def report() -> None:
        while True:
            await asyncio.sleep(0.1)
            device.send_frames(encode(REPORT))
            writer.write(device.outgoing())

    reporting = asyncio.ensure_future(report())
    try:
        while data := await reader.read(4096):
            for event in device.receive(data, 0.0):
                if isinstance(event, Commanded) and event.command == commands.RequestConfig():
                    device.send_frames(encode(ANSWER))
            writer.write(device.outgoing())
    finally:
        reporting.cancel()
        writer.close()


@asynccontextmanager
async def _session(
    port: int,
) -> AsyncIterator[tuple[asyncio.StreamReader, asyncio.StreamWriter, PacketReader]]:
    """Open a session, and close it."""
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    packets = PacketReader()
    for number in (0, 1, 2):
        writer.write(encode(bytes([number])))
        while not packets.feed(await reader.read(4096)):
            pass
    writer.write(encode(commands.to_payload(commands.Open())))
    try:
        yield reader, writer, packets
    finally:
        writer.close()


async def _answers(port: int) -> list[float]:
    """Return how long each question took to be answered [s]."""
    seconds = []
    async with _session(port) as (reader, writer, packets):
        await asyncio.sleep(0.5)
        packets.feed(await reader.read(65536))
        for _ in range(QUESTIONS):
            asked = time.perf_counter()
            writer.write(ASK)
            while True:
                found = packets.feed(await reader.read(4096))
                if any(payload[0] == reports.Config.ID for payload in found):
                    break
            seconds.append(time.perf_counter() - asked)
            await asyncio.sleep(PAUSE)
    return seconds


async def _share(port: int, process: int) -> float:
    """Return the share of a core that a process takes while a host drives ten times a second."""
    drive = encode(commands.to_payload(commands.Vel(speed=0.2)))
    async with _session(port) as (reader, writer, _):
        before, began = _busy(process), time.perf_counter()
        while time.perf_counter() < began + SECONDS:
            writer.write(drive)
            await reader.read(4096)
            await asyncio.sleep(0.1)
        return (_busy(process) - before) / (time.perf_counter() - began)


def _busy(process: int) -> float:
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / 100


async def _measured() -> list[Row]:
    server = await asyncio.start_server(_robot, "127.0.0.1", 0)
    number = server.sockets[0].getsockname()[1]
    words = ["bridge", "--port", f"localhost:{number}", "--listen", "0"]
    bridge = subprocess.Popen(
        [sys.executable, "-m", "pioneer3", *words], stdout=subprocess.PIPE, text=True
    )
    try:
        assert bridge.stdout is not None
        line = await asyncio.to_thread(bridge.stdout.readline)
        through = int(line.rpartition(":")[2])
        direct = await _answers(number)
        bridged = await _answers(through)
        share = await _share(through, bridge.pid)
    finally:
        bridge.terminate()
        await asyncio.to_thread(bridge.communicate)
        server.close()
    added = 1000 * (median(bridged) - median(direct))
    worst = 1000 * (percentile_99(bridged) - percentile_99(direct))
    return [
        Row("a question over a bridge: later than without, median", added, "ms", 2),
        Row("the same, 99th percentile", worst, "ms", 10),
        Row("one core per bridge, driving", 100 * share, "%", 3),
    ]


def rows() -> list[Row]:
    """Measure all of it."""
    return asyncio.run(_measured())
