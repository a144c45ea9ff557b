"""Clients that mean no good, in a process of their own: `python -m benchmarks.hostile_clients`.

Takes what they do, the page's address and how many there are; prints a line when all are at work,
and goes on until it is ended. Who is shown out comes back.
"""

import asyncio
import subprocess
import sys
from collections.abc import Awaitable, Callable, Iterator
from contextlib import contextmanager, suppress
from urllib.parse import urlsplit

COME_BACK = 0.5
"""Pause of those who only wait, before they come back [s]."""
SOON = 0.05
"""And of those who talk without end [s]."""
DRIP = 0.5
"""Between two bytes of who sends slowly [s]."""
PING = b'{"type":"ping","t":1}'
FRAMES = (b"\x81" + bytes([0x80 | len(PING)]) + bytes(4) + PING) * 2000
"""Text frames, masked with zeros."""
UPGRADE = (
    "GET /ws HTTP/1.1\r\nHost: {}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n"
)
QUESTION = "GET /api/robots HTTP/1.1\r\nHost: {}\r\n\r\n"

Streams = tuple[asyncio.StreamReader, asyncio.StreamWriter]
Manner = Callable[[Streams, str], Awaitable[None]]


async def wait(streams: Streams, where: str) -> None:
    """Say nothing, until shown out."""
    await streams[0].read()
    await asyncio.sleep(COME_BACK)


async def drip(streams: Streams, where: str) -> None:
    """Send a request a byte at a time."""
    reader, writer = streams
    for byte in f"GET / HTTP/1.1\r\nHost: {where}\r\nX: {'x' * 1000}".encode():
        writer.write(bytes([byte]))
        await writer.drain()
        await asyncio.sleep(DRIP)
        if reader.at_eof():
            break


async def ping(streams: Streams, where: str) -> None:
    """Ping in a loop over a WebSocket."""
    await _pour(streams, UPGRADE.format(where).encode(), FRAMES)


async def ask(streams: Streams, where: str) -> None:
    """Ask the API in a loop over one connection."""
    question = QUESTION.format(where).encode()
    await _pour(streams, question, question * 500)


async def _pour(streams: Streams, first: bytes, again: bytes) -> None:
    reader, writer = streams
    writer.write(first)
    await reader.readuntil(b"\r\n\r\n")
    reading = asyncio.ensure_future(_read(reader))
    try:
        while not reading.done():
            writer.write(again)
            await writer.drain()
            await asyncio.sleep(0)
    finally:
        reading.cancel()
        await asyncio.gather(reading, return_exceptions=True)
        await asyncio.sleep(SOON)


async def _read(reader: asyncio.StreamReader) -> None:
    while await reader.read(65_536):
        pass


MANNERS: dict[str, Manner] = {"wait": wait, "drip": drip, "ping": ping, "ask": ask}


async def attack(manner: Manner, where: str, count: int) -> None:
    """Attack `where` (host:port) with so many clients; print a line when all have tried."""
    host, port = where.split(":")
    tried: set[int] = set()
    all_tried = asyncio.Event()

    async def one(number: int) -> None:
        while True:
            with suppress(OSError, asyncio.IncompleteReadError):
                async with asyncio.timeout(5):
                    streams = await asyncio.open_connection(host, int(port))
                try:
                    _note(number)
                    await manner(streams, where)
                finally:
                    streams[1].transport.abort()
            _note(number)
            await asyncio.sleep(SOON)

    def _note(number: int) -> None:
        tried.add(number)
        if len(tried) == count:
            all_tried.set()

    clients = [asyncio.ensure_future(one(number)) for number in range(count)]
    await all_tried.wait()
    print("at work", flush=True)
    await asyncio.gather(*clients)


@contextmanager
def attackers(manner: str, address: str, count: int) -> Iterator[None]:
    """Let so many attack the page at `address` during the block."""
    command = [sys.executable, "-m", "benchmarks.hostile_clients", manner, address, str(count)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as process:
        assert process.stdout is not None
        try:
            process.stdout.readline()
            yield
        finally:
            process.kill()


if __name__ == "__main__":
    asyncio.run(attack(MANNERS[sys.argv[1]], urlsplit(sys.argv[2]).netloc, int(sys.argv[3])))
