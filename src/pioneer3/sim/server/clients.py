"""Hosts that connect to a simulated robot, and the single slot that a robot has for them.

Sending never waits: a host that takes nothing is disconnected. At a terminal, which always stays,
whole messages are left out. Rules of the slot:

1. A second host is turned away, unless the first leaves within :data:`GRACE`, or has been silent,
   or has sent more than can be taken, for :data:`STALE`.
2. Of several at once one waits and the others are turned away.
3. A permanent line, such as a serial one, takes a free slot by its first byte.
"""

import asyncio
import logging
from collections.abc import Callable
from contextlib import suppress
from io import FileIO
from math import inf
from socket import SocketIO
from typing import Protocol

from pioneer3.errors import LinkError
from pioneer3.links import Link
from pioneer3.links.serial import forget_unread, unread

CHUNK = 2048
"""Most that is read from one client in one round of the loop [bytes]."""
MOST_UNSENT = 256 * 1024
"""Most that waits for a client to take it [bytes]: 2 s of the longest laser sweeps."""
UNREAD = 3.0
"""At a terminal that nobody has read for this long [s, real] no host is left."""
LANDING = 0.01
"""Bytes written have come to the other end of a terminal by then [s, real]."""
STUCK = 0.5
"""A client that takes nothing for this long [s, real], with full buffers, is disconnected."""


class HostConnection(Protocol):
    """The connection of one host.

    Attributes:
        peer: The name of the host for people.
        permanent: The line exists whether a host uses it or not, as a serial line does.
    """

    peer: str
    permanent: bool

    @property
    def full(self) -> bool:
        """Whether the next message would be left out, as the host has not taken the last one."""

    def resume(self) -> None:
        """Begin to read; a new client is not read."""

    def pause(self) -> None:
        """Stop reading."""

    def send(self, data: bytes) -> None:
        """Send a message, at once or later; a client that takes nothing is closed instead."""

    def close(self) -> None:
        """Close the connection without telling the handler; a permanent line stays."""


class ClientHandler(Protocol):
    """Takes what clients send, and learns when they are gone."""

    def received(self, client: HostConnection, data: bytes) -> None:
        """Take bytes from `client`."""

    def disconnected(self, client: HostConnection) -> None:
        """Note that `client` has gone."""


class SocketClient:
    """A host at the far end of a socket; its file does not block, and is closed in the end."""

    permanent = False

    def __init__(self, handler: ClientHandler, file: FileIO | SocketIO, peer: str) -> None:
        self.peer = peer
        self._handler = handler
        self._file = file
        self._loop = asyncio.get_running_loop()
        self._listens = False
        self._unsent = bytearray()
        self._stuck_since = 0.0

    @property
    def full(self) -> bool:
        """Never: what a host does not take is kept, or the host is disconnected."""
        return False

    def resume(self) -> None:
        if not self._listens and not self._file.closed:
            self._listens = True
            self._loop.add_reader(self._file.fileno(), self._read)

    def pause(self) -> None:
        """Stop reading; the full buffers of the operating system make the host wait."""
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
                self._disconnect()
            return
        written = self._write(data)
        if written < len(data) and not self._file.closed:
            self._unsent += data[written:]
            self._stuck_since = self._loop.time()
            self._loop.add_writer(self._file.fileno(), self._write_rest)

    def close(self) -> None:
        """Close the socket."""
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
            self._handler.received(self, data)
        elif data is not None:
            self._disconnect()

    def _write(self, data: bytes | bytearray) -> int:
        try:
            return self._file.write(data) or 0
        except OSError:
            self._disconnect()
            return 0

    def _write_rest(self) -> None:
        if written := self._write(self._unsent):
            del self._unsent[:written]
            self._stuck_since = self._loop.time()
        if not self._unsent and not self._file.closed:
            self._loop.remove_writer(self._file.fileno())

    def _disconnect(self) -> None:
        self.close()
        self._handler.disconnected(self)


class PtyClient(SocketClient):
    """A host that opens a pseudo terminal.

    The rest of a message that the terminal has no room for waits. Meanwhile others are left out, so
    that a host that pauses finds each message whole or not at all.

    A serial port forgets unread bytes when its host leaves. Nobody tells when a host leaves a
    terminal, so they are forgotten when nobody has read for :data:`UNREAD`, and bytes still come.

    `slave` is the end that hosts open.
    """

    permanent = True

    def __init__(self, handler: ClientHandler, file: FileIO, peer: str, slave: int) -> None:
        super().__init__(handler, file, peer)
        self._slave = slave
        self._waiting, self._abandoned = 0, False
        self._read_at = self._looked_at = self._loop.time()

    @property
    def full(self) -> bool:
        """Whether a message waits for room."""
        if self._file.closed:
            return False
        if self._is_abandoned():
            forget_unread(self._slave)
            self._unsent.clear()
        elif self._unsent and (written := self._write(self._unsent)):
            del self._unsent[:written]
            self._read_at = self._loop.time()  # room comes by reading
        return bool(self._unsent)

    def send(self, data: bytes) -> None:
        """Send a message, or leave it out where the last one waits for room."""
        if not self._file.closed and not self.full:
            self._unsent += data[self._write(data) :]

    def _read(self) -> None:
        self._abandoned, self._read_at = False, self._loop.time()  # a host is there
        super()._read()

    def _is_abandoned(self) -> bool:
        """Return whether nobody reads; a host that begins to read shows in an empty terminal."""
        now = self._loop.time()
        if now - self._looked_at < LANDING:
            return self._abandoned
        self._looked_at = now
        before, self._waiting = self._waiting, unread(self._slave)
        if not self._waiting or (self._waiting < before and not self._abandoned):
            self._abandoned, self._read_at = False, now
        elif now - self._read_at > UNREAD:
            self._abandoned = True
        return self._abandoned

    def close(self) -> None:
        """Go on reading: the terminal stays for the next host."""
        self.resume()

    def remove(self) -> None:
        """Remove the terminal."""
        super().close()

    def _disconnect(self) -> None:
        self.remove()
        self._handler.disconnected(self)


class LinkClient:
    """A host at the far end of a :class:`Link`; :meth:`live` reads and writes."""

    permanent = False
    full = False

    def __init__(self, handler: ClientHandler, link: Link) -> None:
        self.peer = link.url
        self._handler = handler
        self._link = link
        self._listening, self._closed = asyncio.Event(), asyncio.Event()
        self._unsent: list[bytes] = []
        self._has_unsent = asyncio.Event()

    def resume(self) -> None:
        self._listening.set()

    def pause(self) -> None:
        self._listening.clear()

    def send(self, data: bytes) -> None:
        """Hand `data` to the writer."""
        self._unsent.append(data)
        self._has_unsent.set()
        if sum(map(len, self._unsent)) > MOST_UNSENT:
            self.close()

    def close(self) -> None:
        """Close the link, soon."""
        self._closed.set()

    async def live(self) -> None:
        """Read and write until either side closes the connection."""
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
            self._handler.disconnected(self)
            await self._link.close()

    async def _read(self) -> None:
        with suppress(LinkError):
            while await self._listening.wait() and (data := await self._link.read()):
                self._handler.received(self, data)

    async def _write(self) -> None:
        with suppress(LinkError, TimeoutError):
            while await self._has_unsent.wait():
                self._has_unsent.clear()
                data = b"".join(self._unsent)
                self._unsent.clear()
                async with asyncio.timeout(STUCK):
                    await self._link.write(data)


log = logging.getLogger(__name__)

STALE = 2.0
"""A host that has been silent for this long [s] loses its slot to the next one."""
GRACE = 0.1
"""The end of a connection may be noticed this much after the next host connects [s, real]."""


class ClientSlot:
    """The slot for one host.

    `on_change` is called when another host takes the slot, before it is read.

    If it is `closed`, every host is turned away.
    """

    def __init__(
        self, on_change: Callable[[], None], robot: Callable[[], str] = lambda: "a robot"
    ) -> None:
        self.host: HostConnection | None = None
        self.closed = False
        self._on_change = on_change
        self._robot = robot
        self._waiting: HostConnection | None = None
        self._heard_at = -inf
        self._flooded_at = inf

    @property
    def full(self) -> bool:
        """Whether one more host would be turned away at once."""
        return self.closed or (self._waiting is not None and not self._is_free())

    def admit(self, client: HostConnection) -> None:
        """Give `client` the slot, now or soon, or turn it away."""
        if self.closed:
            client.close()
        elif self._is_free():
            self._connect(client)
        elif self._waiting is None:
            self._waiting = client
            asyncio.get_running_loop().call_later(GRACE, self._settle, client)
        else:
            self._refuse(client)

    def heard_from(self, client: HostConnection) -> bool:
        """Note that `client` has sent bytes; return whether the robot takes them."""
        if client is not self.host:
            if not client.permanent or self.closed or not self._is_free():
                return False
            self._connect(client)
        self._heard_at = _now()
        return True

    def set_flooded(self, *, flooded: bool) -> None:
        """Note whether the host has sent more than can be taken."""
        self._flooded_at = min(self._flooded_at, _now()) if flooded else inf

    def disconnected(self, client: HostConnection) -> bool:
        """Note that `client` has gone; return whether it was the host."""
        if client is self._waiting:
            self._waiting = None
        if client is not self.host:
            return False
        log.info("%s: gone from %s", client.peer, self._robot())
        self.host = None
        if self._waiting is not None:
            waiting, self._waiting = self._waiting, None
            self._connect(waiting)
        return True

    def disconnect_all(self) -> None:
        """Disconnect the host and the client that waits."""
        waiting, self._waiting = self._waiting, None
        for client in (waiting, self.host):
            if client is not None:
                client.close()
                self.disconnected(client)

    def _is_free(self) -> bool:
        since = min(self._heard_at, self._flooded_at)
        return self.host is None or _now() - since >= STALE

    def _connect(self, client: HostConnection) -> None:
        last, self.host = self.host, client
        if last is not None:
            log.info("%s: silent or flooding, gives way at %s", last.peer, self._robot())
            last.close()
        log.info("%s: connected to %s", client.peer, self._robot())
        self._heard_at, self._flooded_at = _now(), inf
        self._on_change()
        client.resume()

    def _settle(self, client: HostConnection) -> None:
        if client is not self._waiting:
            return
        self._waiting = None
        if self._is_free():
            self._connect(client)
        else:
            self._refuse(client)

    def _refuse(self, client: HostConnection) -> None:
        log.info("%s: turned away from %s, another host is there", client.peer, self._robot())
        client.close()


def _now() -> float:
    return asyncio.get_running_loop().time()
