"""Limits the TCP connections of the page: silent and slow ones give way to new ones.

A connection costs a file descriptor, and the robot's link, recordings and logs need some too. So
there are never more connections than this process can afford. A new connection is always accepted;
if there are too many, the least active one is closed: at the address that has the most, one without
a request before one that was answered, that before one that is being answered, and the oldest
first. So a stop gets through even from an address that attacks. WebSockets are counted apart, and
none is closed for a new connection.
"""

import asyncio
import logging
import socket
import ssl
from collections import Counter
from collections.abc import Callable
from enum import IntEnum
from itertools import count
from pathlib import Path
from typing import Any

import uvicorn
from uvicorn.protocols.http.h11_impl import H11Protocol
from uvicorn.server import ServerState

from pioneer3.tasks import next_tick
from pioneer3.web.websocket import BoundedWebSocket

log = logging.getLogger(__name__)

MOST_REQUESTS = 128
"""Most HTTP connections."""
MOST_SOCKETS = 200
"""Most WebSockets."""
KEPT_BACK = 48
"""File descriptors for the link, recordings, logs and other uses."""
USUAL_FILES = 1024
FILES = Path("/dev/fd")
"""Lists the open files of this process, on some systems."""
SHARE = 0.75
"""Greatest share of the WebSockets for one address."""
SILENCE = 5.0
"""Longest time from a connection, or an answer, to the next request [s]."""
REQUEST_TIME = 5.0
"""Longest time from the first byte of a request to its last [s]."""
ANSWER_TIME = 30.0
"""Longest time until an answer has been taken [s]."""
TICK = 0.1
"""Time between two looks at all connections [s], as uvicorn has it."""
STREAMING = "pioneer3.streaming"
"""Extension of the ASGI scope: a function that an answer without end calls before each piece."""
TAKING = "pioneer3.taking"
"""Extension of the ASGI scope: a function that a long answer calls before each piece."""
STREAM_BUFFER = 32 << 10
"""Send buffer of a stream's socket [bytes]; the system's would let old pieces wait."""
BACKLOG = 1024
"""Connections that wait in the operating system."""
BATCH = 4
"""Connections accepted at once; then the others have their turn."""
OUT_OF_FILES = 0.1
"""Pause when the operating system gives no connection [s]."""
FULL = b"HTTP/1.1 503 Service Unavailable\r\nConnection: close\r\nContent-Length: 0\r\n\r\n"


class TenfoldFilter(logging.Filter):
    """Lets the first, tenth, hundredth ... warning of one kind pass, with its number.

    Whoever sends what is no HTTP or no text fills no log.
    """

    def __init__(self) -> None:
        super().__init__()
        self._counts: Counter[str] = Counter()

    def filter(self, record: logging.LogRecord) -> bool:
        """Count `record`; return whether it passes."""
        if record.levelno != logging.WARNING:
            return True
        self._counts[record.msg] += 1
        number = str(self._counts[record.msg])
        record.msg += "" if number == "1" else f" ({number} times so far)"
        return number.rstrip("0") == "1"


class ConnectionPhase(IntEnum):
    """Progress of a connection; the lowest is closed first."""

    NEW = 0
    ANSWERED = 1
    ACTIVE = 2


class HttpConnection:
    """A connection of an IP address that is no WebSocket.

    It is to be closed when it is `due`, unless something happens [s, loop time].
    """

    def __init__(self, address: str, due: float, close: Callable[[], object]) -> None:
        self.address = address
        self.phase = ConnectionPhase.NEW
        self.due = due
        self.close = close


class ConnectionPool:
    """All connections that are no WebSockets; never more than `most`."""

    def __init__(self, most: int) -> None:
        self._most = most
        self._by_address: dict[str, dict[HttpConnection, None]] = {}
        self._count = 0

    def __len__(self) -> int:
        return self._count

    def add(self, connection: HttpConnection) -> None:
        """Add `connection`; another is closed if there are too many."""
        if self._count >= self._most:
            self.close_one()
        self._by_address.setdefault(connection.address, {})[connection] = None
        self._count += 1

    def remove(self, connection: HttpConnection) -> None:
        """Remove `connection`, if it is there."""
        there = self._by_address.get(connection.address, {})
        if connection in there:
            del there[connection]
            self._count -= 1
            if not there:
                del self._by_address[connection.address]

    def close_one(self) -> None:
        """Close the least active connection, if there is any."""
        if self._by_address:
            group = max(self._by_address.values(), key=len)
            self._close(min(group, key=lambda connection: connection.phase))

    def close_overdue(self, now: float) -> None:
        """Close the connections that are due at `now`."""
        self._close_all(lambda connection: connection.due <= now)

    def close_silent(self) -> None:
        """Close the connections without a request."""
        self._close_all(lambda connection: connection.phase is ConnectionPhase.NEW)

    def _close_all(self, which: Callable[[HttpConnection], bool]) -> None:
        for connection in [c for group in self._by_address.values() for c in group if which(c)]:
            self._close(connection)

    def _close(self, connection: HttpConnection) -> None:
        self.remove(connection)
        connection.close()


class ConnectionLimits:
    """The connections of one page and their limits, shared by its servers.

    The process can still open so many files; `None` finds out.
    """

    def __init__(self, files: int | None = None) -> None:
        room = max(0, (spare_files() if files is None else files) - KEPT_BACK)
        # a request may open a file to answer with
        self.pool = ConnectionPool(max(8 * BATCH, min(MOST_REQUESTS, room // 4)))
        self.most_sockets = max(4, min(MOST_SOCKETS, room // 2))
        self.state = ServerState()

    def has_room(self, address: str) -> bool:
        """Whether there is room for a WebSocket from `address`."""
        sockets = [each for each in self.state.connections if isinstance(each, BoundedWebSocket)]
        theirs = sum(each.client is not None and each.client[0] == address for each in sockets)
        return len(sockets) < self.most_sockets and theirs < self.most_sockets * SHARE


def spare_files() -> int:
    """Return the number of files that this process can still open."""
    try:
        from resource import RLIMIT_NOFILE, getrlimit  # not on Windows
    except ImportError:
        return USUAL_FILES
    most = getrlimit(RLIMIT_NOFILE)[0]
    open_now = len(list(FILES.iterdir())) if FILES.is_dir() else 0
    return (most if most >= 0 else USUAL_FILES) - open_now


class HttpProtocol(H11Protocol):
    """HTTP on one connection, with time limits for each request."""

    def __init__(
        self, config: uvicorn.Config, limits: ConnectionLimits, connection: HttpConnection
    ) -> None:
        super().__init__(config, limits.state, {})
        self._limits = limits
        self._connection = connection
        self._begun = self._streams = False

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Note the way to close it."""
        self._connection.close = transport.abort
        super().connection_made(transport)

    def data_received(self, data: bytes) -> None:
        """Take data; the first byte of a request starts its time."""
        if not self._begun:
            self._begun = True
            self._connection.due = self.loop.time() + REQUEST_TIME
        super().data_received(data)
        self._note_whole_request()

    def on_response_complete(self) -> None:
        """Wait for the next request."""
        self._begun = False
        self._connection.phase = ConnectionPhase.ANSWERED
        self._connection.due = self.loop.time() + SILENCE
        super().on_response_complete()
        self._note_whole_request()

    def connection_lost(self, exc: Exception | None) -> None:
        """Remove it from the pool."""
        self._limits.pool.remove(self._connection)
        super().connection_lost(exc)

    def handle_websocket_upgrade(self, event: Any) -> None:
        """Turn it into a WebSocket, if there is room for one more."""
        if self._limits.has_room(self._connection.address):
            self._limits.pool.remove(self._connection)
            super().handle_websocket_upgrade(event)
        else:
            self.transport.write(FULL)
            self.transport.close()

    def _note_whole_request(self) -> None:
        cycle = self.cycle
        if cycle is not None and not cycle.more_body and not cycle.response_complete:
            scope: Any = cycle.scope
            extensions = scope.setdefault("extensions", {})
            extensions |= {STREAMING: self._stream, TAKING: self._go_on}
            if self._connection.phase is not ConnectionPhase.ACTIVE:
                self._connection.due = self.loop.time() + ANSWER_TIME
            self._connection.phase = ConnectionPhase.ACTIVE

    def _stream(self) -> None:
        """Let an answer without end go on, none of whose pieces waits for long."""
        if not self._streams:
            self._streams = True
            self.transport.set_write_buffer_limits(high=0)
            connection = self.transport.get_extra_info("socket")
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, STREAM_BUFFER)
        self._go_on()

    def _go_on(self) -> None:
        """Let an answer last for as long as its pieces are taken."""
        self._connection.due = self.loop.time() + ANSWER_TIME


class Acceptor:
    """Accepts the connections of a listening socket; a silent one costs nothing but its socket.

    `make` returns the protocol of a connection. The listener does not block.
    """

    def __init__(
        self,
        listener: socket.socket,
        limits: ConnectionLimits,
        make: Callable[[HttpConnection], asyncio.BaseProtocol],
        context: ssl.SSLContext | None,
    ) -> None:
        self._listener = listener
        self._pool = limits.pool
        self._make = make
        self._context = context
        self._loop = asyncio.get_running_loop()
        self._open()

    def close(self) -> None:
        """Accept no more connections."""
        if self._listener.fileno() >= 0:
            self._loop.remove_reader(self._listener)

    async def wait_closed(self) -> None:
        """Return at once: the server closes the connections."""

    def _open(self) -> None:
        if self._listener.fileno() >= 0:
            self._loop.add_reader(self._listener, self._accept)

    def _accept(self) -> None:
        for _ in range(BATCH):
            try:
                sock, peer = self._listener.accept()
            except (BlockingIOError, InterruptedError, ConnectionAbortedError):
                return
            except OSError as error:
                log.warning("cannot take another connection: %s", error.strerror)
                self._pool.close_one()
                self.close()
                self._loop.call_later(OUT_OF_FILES, self._open)
                return
            sock.setblocking(False)
            self._await_data(sock, peer[0])

    def _await_data(self, sock: socket.socket, address: str) -> None:
        """Wait for the first data of `sock`; nothing more is kept for a silent connection."""

        def close() -> None:
            self._loop.remove_reader(sock)
            sock.close()

        def serve() -> None:
            self._loop.remove_reader(sock)
            serving = asyncio.ensure_future(self._serve(sock, connection))
            serving.add_done_callback(finish)
            connection.close = serving.cancel

        def finish(serving: "asyncio.Task[bool]") -> None:
            if serving.cancelled() or not serving.result():
                self._pool.remove(connection)
                sock.close()

        connection = HttpConnection(address, self._loop.time() + SILENCE, close)
        self._pool.add(connection)
        self._loop.add_reader(sock, serve)

    async def _serve(self, sock: socket.socket, connection: HttpConnection) -> bool:
        """Do the TLS handshake, where there is TLS, and start the protocol; return the success."""

        def make() -> asyncio.BaseProtocol:
            return self._make(connection)

        try:
            await self._loop.connect_accepted_socket(make, sock, ssl=self._context)
        except OSError:  # it has gone again, or knows no TLS
            return False
        return True


class WebServer(uvicorn.Server):
    """uvicorn's, with an :class:`Acceptor` for each of its sockets."""

    def __init__(self, config: uvicorn.Config, limits: ConnectionLimits) -> None:
        super().__init__(config)
        self._limits = limits
        self.server_state = limits.state

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Accept connections."""
        await self.lifespan.startup()

        def make(connection: HttpConnection) -> HttpProtocol:
            return HttpProtocol(self.config, self._limits, connection)

        self.servers = [
            Acceptor(each, self._limits, make, self.config.ssl)  # type: ignore[misc]
            for each in sockets or []
        ]
        self.started = True

    async def main_loop(self) -> None:
        """Tick, at the same time as what else goes on in this program, until told to stop."""
        ticks = count()
        while not await self.on_tick(next(ticks)):
            await next_tick(TICK)

    async def on_tick(self, counter: int) -> bool:
        """Close overdue connections; each tenth call renews the date of answers."""
        self._limits.pool.close_overdue(asyncio.get_running_loop().time())
        return await super().on_tick(counter)

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """Close silent connections too; uvicorn does not know them."""
        for acceptor in self.servers:
            acceptor.close()
        self._limits.pool.close_silent()
        await super().shutdown(sockets)
