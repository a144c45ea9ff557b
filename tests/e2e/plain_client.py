"""A host without a driver: it says what a test wants, and keeps what it hears."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from typing import TypeVar

from pioneer3.arcos import commands, reports
from pioneer3.arcos.commands import Command
from pioneer3.arcos.packet import PacketReader, encode
from pioneer3.arcos.reports import Report
from tests.support import frame

PATIENCE = 30.0
"""Longest wait for anything on a busy machine [s]."""
RETRY = 1.0
"""How long ARIA waits for the answer to a SYNC [s]."""
SYNCS = [encode(bytes([number])) for number in (0, 1, 2)]

R = TypeVar("R")


class TurnedAwayError(ConnectionError):
    """The robot hung up."""


class PlainClient:
    """The host's end of a connection to a simulated robot.

    Attributes:
        heard: Every report since the connection, in order.
    """

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.heard: list[Report] = []
        self.packets = PacketReader()
        self._reader, self._writer = reader, writer
        self._unread = 0

    @classmethod
    async def connect(cls, port: int) -> "PlainClient":
        """Connect to a robot on this machine."""
        return cls(*await asyncio.open_connection("127.0.0.1", port))

    async def open(self) -> reports.SyncIdentity:
        """Shake hands, open a session, and return who answered.

        As ARIA does (protocol.md 2.2), a SYNC without an answer is said again after a second, and a
        robot that is still in somebody's session is sent CLOSE.

        Raises:
            TurnedAwayError: Another host is connected.
        """
        wanted: tuple[Report, ...] = (reports.SyncEcho(0), reports.SyncEcho(1))
        step = 0
        while True:
            self.send(SYNCS[step])
            try:
                async with asyncio.timeout(RETRY):
                    answer = await self.next(object)
            except TimeoutError:
                continue
            if isinstance(answer, reports.SyncIdentity):
                self.say(commands.Open())
                return answer
            if step < 2 and answer == wanted[step]:
                step += 1
            elif not isinstance(answer, reports.SyncEcho):
                self.say(commands.Close())
                step = 0

    def say(self, *said: Command) -> None:
        """Send commands."""
        self.send(b"".join(frame(command) for command in said))

    def send(self, data: bytes) -> None:
        """Send bytes as they are."""
        self._writer.write(data)

    async def next(self, kind: type[R]) -> R:
        """Return the next report of a type; others on the way are passed over.

        Raises:
            TurnedAwayError: The robot hung up before.
        """
        async with asyncio.timeout(PATIENCE):
            while True:
                while self._unread < len(self.heard):
                    report = self.heard[self._unread]
                    self._unread += 1
                    if isinstance(report, kind):
                        return report
                try:
                    data = await self._reader.read(65536)
                except ConnectionError:
                    data = b""
                if not data:
                    await self.drop()
                    raise TurnedAwayError
                self.heard += map(reports.from_payload, self.packets.feed(data))

    async def leave(self) -> None:
        """Say goodbye and close the connection."""
        self.say(commands.Enable(on=False), commands.Close())
        await self.drop()

    async def drop(self) -> None:
        """Close the connection without a word."""
        self._writer.close()
        with suppress(ConnectionError):
            await self._writer.wait_closed()

    def abort(self) -> None:
        """Vanish: what is on its way is lost."""
        self._writer.transport.abort()


@asynccontextmanager
async def session(port: int) -> AsyncIterator[PlainClient]:
    """Open a session that ends with the block."""
    client = await PlainClient.connect(port)
    try:
        await client.open()
        yield client
    finally:
        await client.leave()
