"""Which TCP connections the page keeps: silent and slow ones make room for who has a request.

A connection costs a file descriptor, and the robot's link, recordings and logs need some too. So
there are never more than this process can afford; who comes when all are taken is let in, and the
connection that is worth the least is closed: at the address that has the most, the one that has
asked for nothing yet before one that was answered, that before one that is being answered, and the
oldest first. A stop therefore gets through from an address that attacks as well. WebSockets are
counted apart, and none is closed for a newcomer.
"""

import asyncio
import logging
import socket
import ssl
from collections.abc import Callable
from enum import IntEnum
from pathlib import Path
from typing import Any

import uvicorn
from uvicorn.protocols.http.h11_impl import H11Protocol
from uvicorn.server import ServerState

from pioneer3.web.websocket import ShortSocket

log = logging.getLogger(__name__)

MOST_REQUESTS, MOST_SOCKETS = 128, 200
"""HTTP connections, and WebSockets."""
KEPT_BACK = 48
"""File descriptors for the link, recordings, logs and whatever else."""
USUAL_FILES = 1024
FILES = Path("/dev/fd")
"""Lists what this process has open; not everywhere."""
SHARE = 0.75
"""Of the WebSockets, one address has no more than this."""
SILENCE = 5.0
"""Longest time from a connection, or an answer, to the next request [s]."""
REQUEST_TIME = 5.0
"""Longest time from the first byte of a request to its last [s]."""
ANSWER_TIME = 30.0
"""Longest time until an answer has been taken [s]."""
BACKLOG = 1024
"""Connections that wait in the operating system."""
BATCH = 4
"""Connections let in at once; then all others have their turn."""
OUT_OF_FILES = 0.1
"""Pause when the operating system gives no connection [s]."""
FULL = b"HTTP/1.1 503 Service Unavailable\r\nConnection: close\r\nContent-Length: 0\r\n\r\n"


class Stage(IntEnum):
    """How far somebody has come; the least is closed first."""

    NEW = 0
    ANSWERED = 1
    ASKING = 2


class Caller:
    """A connection that is no WebSocket.

    Attributes:
        address: Where it comes from.
        stage: How far it has come.
        due: When it is closed unless something happens [s, loop time].
        close: Closes it at once.
    """

    def __init__(self, address: str, due: float, close: Callable[[], object]) -> None:
        self.address = address
        self.stage = Stage.NEW
        self.due = due
        self.close = close


class Callers:
    """All connections that are no WebSockets; never more than `most`."""

    def __init__(self, most: int) -> None:
        self._most = most
        self._by_address: dict[str, dict[Caller, None]] = {}
        self._count = 0

    def __len__(self) -> int:
        return self._count

    def add(self, caller: Caller) -> None:
        """Take `caller` in; another goes if there are too many."""
        if self._count >= self._most:
            self.close_one()
        self._by_address.setdefault(caller.address, {})[caller] = None
        self._count += 1

    def remove(self, caller: Caller) -> None:
        """Forget `caller`, if it is still known."""
        there = self._by_address.get(caller.address, {})
        if caller in there:
            del there[caller]
            self._count -= 1
            if not there:
                del self._by_address[caller.address]

    def close_one(self) -> None:
        """Close the connection that is worth the least, if there is any."""
        if self._by_address:
            crowd = max(self._by_address.values(), key=len)
            self._close(min(crowd, key=lambda caller: caller.stage))

    def close_overdue(self, now: float) -> None:
        """Close whoever should have said something by `now`."""
        self._close_all(lambda caller: caller.due <= now)

    def close_silent(self) -> None:
        """Close whoever has asked for nothing yet."""
        self._close_all(lambda caller: caller.stage is Stage.NEW)

    def _close_all(self, which: Callable[[Caller], bool]) -> None:
        for caller in [c for crowd in self._by_address.values() for c in crowd if which(c)]:
            self._close(caller)

    def _close(self, caller: Caller) -> None:
        self.remove(caller)
        caller.close()


class Limits:
    """What the servers of one page share: how many connections there may be, and who they are.

    Args:
        files: How many descriptors this process can still open; `None` finds out.
    """

    def __init__(self, files: int | None = None) -> None:
        room = max(0, (spare_files() if files is None else files) - KEPT_BACK)
        # a request may open a file to answer with
        self.callers = Callers(max(8 * BATCH, min(MOST_REQUESTS, room // 4)))
        self.most_sockets = max(4, min(MOST_SOCKETS, room // 2))
        self.state = ServerState()

    def has_seat(self, address: str) -> bool:
        """Whether there is room for a WebSocket from `address`."""
        sockets = [each for each in self.state.connections if isinstance(each, ShortSocket)]
        theirs = sum(each.client is not None and each.client[0] == address for each in sockets)
        return len(sockets) < self.most_sockets and theirs < self.most_sockets * SHARE


def spare_files() -> int:
    """Return how many more files this process may open."""
    try:
        from resource import RLIMIT_NOFILE, getrlimit  # noqa: PLC0415  not on Windows
    except ImportError:
        return USUAL_FILES
    most = getrlimit(RLIMIT_NOFILE)[0]
    open_now = len(list(FILES.iterdir())) if FILES.is_dir() else 0
    return (most if most >= 0 else USUAL_FILES) - open_now


class Exchange(H11Protocol):
    """HTTP on one connection, each request within its time."""

    def __init__(self, config: uvicorn.Config, limits: Limits, caller: Caller) -> None:
        super().__init__(config, limits.state, {})
        self._limits = limits
        self._caller = caller
        self._begun = False

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Note how to close it."""
        self._caller.close = transport.abort
        super().connection_made(transport)

    def data_received(self, data: bytes) -> None:
        """Take bytes; the first of a request starts its time."""
        if not self._begun:
            self._begun = True
            self._caller.due = self.loop.time() + REQUEST_TIME
        super().data_received(data)
        self._note_whole_request()

    def on_response_complete(self) -> None:
        """Wait for the next request."""
        self._begun = False
        self._caller.stage = Stage.ANSWERED
        self._caller.due = self.loop.time() + SILENCE
        super().on_response_complete()
        self._note_whole_request()

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget it."""
        self._limits.callers.remove(self._caller)
        super().connection_lost(exc)

    def handle_websocket_upgrade(self, event: Any) -> None:
        """Let it become a WebSocket, if there is room for one more."""
        if self._limits.has_seat(self._caller.address):
            self._limits.callers.remove(self._caller)
            super().handle_websocket_upgrade(event)
        else:
            self.transport.write(FULL)
            self.transport.close()

    def _note_whole_request(self) -> None:
        cycle = self.cycle
        if cycle is not None and not cycle.more_body and not cycle.response_complete:
            if self._caller.stage is not Stage.ASKING:
                self._caller.due = self.loop.time() + ANSWER_TIME
            self._caller.stage = Stage.ASKING


class Entrance:
    """Lets in who comes to a listening socket; a connection that is silent is no more than that.

    Args:
        listener: Not blocking.
        limits: Who is in.
        make: Returns what serves a caller, from its first byte on.
        context: For TLS; `None` without.
    """

    def __init__(
        self,
        listener: socket.socket,
        limits: Limits,
        make: Callable[[Caller], asyncio.BaseProtocol],
        context: ssl.SSLContext | None,
    ) -> None:
        self._listener = listener
        self._callers = limits.callers
        self._make = make
        self._context = context
        self._loop = asyncio.get_running_loop()
        self._open()

    def close(self) -> None:
        """Let nobody in any more."""
        if self._listener.fileno() >= 0:
            self._loop.remove_reader(self._listener)

    async def wait_closed(self) -> None:
        """Return at once: those who are in are the server's."""

    def _open(self) -> None:
        if self._listener.fileno() >= 0:
            self._loop.add_reader(self._listener, self._accept)

    def _accept(self) -> None:
        for _ in range(BATCH):
            try:
                connection, peer = self._listener.accept()
            except (BlockingIOError, InterruptedError, ConnectionAbortedError):
                return
            except OSError as error:
                log.warning("cannot take another connection: %s", error.strerror)
                self._callers.close_one()
                self.close()
                self._loop.call_later(OUT_OF_FILES, self._open)
                return
            connection.setblocking(False)
            self._await_word(connection, peer[0])

    def _await_word(self, connection: socket.socket, address: str) -> None:
        """Wait until `connection` says something; more is done for nobody before."""

        def close() -> None:
            self._loop.remove_reader(connection)
            connection.close()

        def heard() -> None:
            self._loop.remove_reader(connection)
            serving = asyncio.ensure_future(self._serve(connection, caller))
            serving.add_done_callback(handed_over)
            caller.close = serving.cancel

        def handed_over(serving: "asyncio.Task[bool]") -> None:
            if serving.cancelled() or not serving.result():
                self._callers.remove(caller)
                connection.close()

        caller = Caller(address, self._loop.time() + SILENCE, close)
        self._callers.add(caller)
        self._loop.add_reader(connection, heard)

    async def _serve(self, connection: socket.socket, caller: Caller) -> bool:
        """Shake hands, where there is TLS, and hand over to what serves it; return whether done."""

        def make() -> asyncio.BaseProtocol:
            return self._make(caller)

        try:
            await self._loop.connect_accepted_socket(make, connection, ssl=self._context)
        except OSError:  # it has gone again, or knows no TLS
            return False
        return True


class Server(uvicorn.Server):
    """uvicorn's, with an :class:`Entrance` for each of its sockets."""

    def __init__(self, config: uvicorn.Config, limits: Limits) -> None:
        super().__init__(config)
        self._limits = limits
        self.server_state = limits.state

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Let in who comes."""
        await self.lifespan.startup()

        def make(caller: Caller) -> Exchange:
            return Exchange(self.config, self._limits, caller)

        self.servers = [
            Entrance(each, self._limits, make, self.config.ssl)  # type: ignore[misc]
            for each in sockets or []
        ]
        self.started = True

    async def on_tick(self, counter: int) -> bool:
        """Close who is overdue; ten times a second."""
        self._limits.callers.close_overdue(asyncio.get_running_loop().time())
        return await super().on_tick(counter)

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """Close silent connections too; uvicorn does not know of them."""
        for entrance in self.servers:
            entrance.close()
        self._limits.callers.close_silent()
        await super().shutdown(sockets)
