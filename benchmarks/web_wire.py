"""A cable to a simulator: every command is seen as it arrives, by the clock of who asked."""

import asyncio
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress

from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command
from pioneer3.arcos.packet import PacketReader


class Wire:
    """What passes towards the robot."""

    def __init__(self) -> None:
        self.url = ""
        self._awaited: list[tuple[type[Command], asyncio.Future[float]]] = []
        self._serving: set[asyncio.Task[None]] = set()

    def next(self, kind: type[Command]) -> "asyncio.Future[float]":
        """Return when the next command of this kind arrives [s, monotonic]."""
        arrival: asyncio.Future[float] = asyncio.get_running_loop().create_future()
        self._awaited.append((kind, arrival))
        return arrival

    def note(self, command: Command) -> None:
        """A command has arrived."""
        now = time.monotonic()
        for kind, arrival in self._awaited:
            if isinstance(command, kind) and not arrival.done():
                arrival.set_result(now)
        self._awaited = [(kind, arrival) for kind, arrival in self._awaited if not arrival.done()]


@asynccontextmanager
async def wire_to(url: str) -> AsyncIterator[Wire]:
    """Lay a cable to the simulator at `url`; its own `url` is for the host."""
    wire = Wire()
    host, port = url.removeprefix("tcp://").rsplit(":", 1)
    serving: set[asyncio.Task[None]] = set()

    async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        there, back = await asyncio.open_connection(host, int(port))
        task = asyncio.ensure_future(_pass_on(there, writer))
        serving.add(task)
        packets, opened = PacketReader(), 0
        with suppress(OSError):
            while data := await reader.read(4096):
                for payload in packets.feed(data):
                    opened += 1
                    if opened > 3:  # the SYNCs of the handshake come first
                        wire.note(commands.from_payload(payload))
                back.write(data)
        back.close()

    server = await asyncio.start_server(serve, "127.0.0.1", 0)
    wire.url = f"tcp://127.0.0.1:{server.sockets[0].getsockname()[1]}"
    try:
        yield wire
    finally:
        server.close()
        for task in serving:
            task.cancel()


async def _pass_on(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    with suppress(OSError):
        while data := await reader.read(4096):
            writer.write(data)
    writer.close()
