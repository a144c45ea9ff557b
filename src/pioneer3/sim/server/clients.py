"""Hosts as the simulator sees them. Sending never waits: who takes nothing is cut off."""

import asyncio
from contextlib import suppress
from io import FileIO
from socket import SocketIO
from typing import Protocol

from pioneer3.errors import LinkError
from pioneer3.links import Link

CHUNK = 2048
"""Most that is read from one client in one round of the loop [bytes]."""
MOST_UNSENT = 256 * 1024
"""Most that waits for a client to take it [bytes]: 2 s of the longest laser sweeps."""
STUCK = 0.5
"""A client that takes nothing for this long [s, real], its buffers full, is cut off."""


class Client(Protocol):
    """One host.

    Attributes:
        peer: Who that is, for people.
        standing: The line is there whether somebody uses it or not, as a serial one.
    """

    peer: str
    standing: bool

    def resume(self) -> None:
        """Let its bytes come; in the beginning they do not."""

    def pause(self) -> None:
        """Leave its bytes where they are."""

    def send(self, data: bytes) -> None:
        """Hand over `data`, at once or later; a client that is stuck is closed instead."""

    def close(self) -> None:
        """Part from it without a word to the place; a standing line stays."""


class Place(Protocol):
    """Where a client belongs."""

    def hear(self, client: Client, data: bytes) -> None:
        """Take bytes from `client`."""

    def leave(self, client: Client) -> None:
        """Take note that `client` has gone."""


class Connection:
    """A host at the far end of a socket.

    Args:
        place: Where it wants to be.
        file: Reads and writes without blocking; is closed in the end.
        peer: Its address.
    """

    standing = False

    def __init__(self, place: Place, file: FileIO | SocketIO, peer: str) -> None:
        self.peer = peer
        self._place = place
        self._file = file
        self._loop = asyncio.get_running_loop()
        self._listens = False
        self._unsent = bytearray()
        self._stuck_since = 0.0

    def resume(self) -> None:
        """Let its bytes come."""
        if not self._listens and not self._file.closed:
            self._listens = True
            self._loop.add_reader(self._file.fileno(), self._read)

    def pause(self) -> None:
        """Leave its bytes in the buffers of the operating system, which tell the host to wait."""
        if self._listens and not self._file.closed:
            self._listens = False
            self._loop.remove_reader(self._file.fileno())

    def send(self, data: bytes) -> None:
        """Send what the operating system takes; keep the rest until it does."""
        if self._file.closed:
            return
        if self._unsent:
            self._unsent += data
            if len(self._unsent) > MOST_UNSENT or self._loop.time() - self._stuck_since > STUCK:
                self._end()
            return
        written = self._write(data)
        if written < len(data) and not self._file.closed:
            self._unsent += data[written:]
            self._stuck_since = self._loop.time()
            self._loop.add_writer(self._file.fileno(), self._write_rest)

    def close(self) -> None:
        """Hang up."""
        if not self._file.closed:
            self._loop.remove_reader(self._file.fileno())
            self._loop.remove_writer(self._file.fileno())
            with suppress(OSError):
                self._file.close()

    def _read(self) -> None:
        try:
            data = self._file.read(CHUNK)
        except OSError:
            data = b""
        if data:
            self._place.hear(self, data)
        elif data is not None:
            self._end()

    def _write(self, data: bytes | bytearray) -> int:
        try:
            return self._file.write(data) or 0
        except OSError:
            self._end()
            return 0

    def _write_rest(self) -> None:
        if written := self._write(self._unsent):
            del self._unsent[:written]
            self._stuck_since = self._loop.time()
        if not self._unsent and not self._file.closed:
            self._loop.remove_writer(self._file.fileno())

    def _end(self) -> None:
        self.close()
        self._place.leave(self)


class Terminal(Connection):
    """Whoever opens a pseudo terminal. What nobody reads is lost, as on a serial line."""

    standing = True

    def send(self, data: bytes) -> None:
        """Send what the terminal takes."""
        if not self._file.closed:
            self._write(data)

    def close(self) -> None:
        """Let go; the terminal stays, and is listened to."""
        self.resume()

    def shut(self) -> None:
        """Take the terminal away."""
        super().close()

    def _end(self) -> None:
        self.shut()
        self._place.leave(self)


class LinkClient:
    """A host at the far end of a link of ours; :meth:`live` does its reading and writing."""

    standing = False

    def __init__(self, place: Place, link: Link) -> None:
        self.peer = link.url
        self._place = place
        self._link = link
        self._listening, self._closed = asyncio.Event(), asyncio.Event()
        self._unsent: list[bytes] = []
        self._has_unsent = asyncio.Event()

    def resume(self) -> None:
        """Let its bytes come."""
        self._listening.set()

    def pause(self) -> None:
        """Leave its bytes in the link."""
        self._listening.clear()

    def send(self, data: bytes) -> None:
        """Hand `data` to the writer."""
        self._unsent.append(data)
        self._has_unsent.set()
        if sum(map(len, self._unsent)) > MOST_UNSENT:
            self.close()

    def close(self) -> None:
        """Hang up, soon."""
        self._closed.set()

    async def live(self) -> None:
        """Read and write until either side has had enough."""
        tasks = [
            asyncio.ensure_future(work)
            for work in (self._read(), self._write(), self._closed.wait())
        ]
        try:
            await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)
            self._place.leave(self)
            await self._link.close()

    async def _read(self) -> None:
        with suppress(LinkError):
            while await self._listening.wait() and (data := await self._link.read()):
                self._place.hear(self, data)

    async def _write(self) -> None:
        with suppress(LinkError, TimeoutError):
            while await self._has_unsent.wait():
                self._has_unsent.clear()
                data = b"".join(self._unsent)
                self._unsent.clear()
                async with asyncio.timeout(STUCK):
                    await self._link.write(data)
