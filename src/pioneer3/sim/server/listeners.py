"""Listening sockets and pseudo terminals, through which hosts connect."""

import asyncio
import errno
import logging
import os
import socket
from collections.abc import AsyncIterator, Callable, Coroutine
from contextlib import asynccontextmanager, suppress
from io import FileIO
from math import inf
from typing import Any, Protocol

from pioneer3.errors import LinkError, PortBusyError
from pioneer3.links.hosts import url_of
from pioneer3.links.serial import make_pty, terminal_speed
from pioneer3.links.stream import tune
from pioneer3.sim.server.clients import ClientHandler, HostConnection, PtyClient, SocketClient

log = logging.getLogger(__name__)

BACKLOG = 128
"""Hosts that may wait in the operating system."""
OUT_OF_FILES = 1.0
"""Pause before the next try when this process may open no more files [s, real]."""
SEND_BUFFER = 64 * 1024
"""Send buffer of a socket [bytes]; the system's would hide a host that takes nothing."""

TRIES = 100
"""Ports that are tried, from the usual one on."""

SOCKETS_ARE_FILES = os.name == "posix"


def as_file(connection: socket.socket) -> FileIO | socket.SocketIO:
    """Return a file that reads, writes and closes `connection`; a descriptor is fastest."""
    if SOCKETS_ARE_FILES:
        return FileIO(connection.detach(), "r+")
    file = connection.makefile("rwb", buffering=0)
    connection.close()  # once the file is
    return file


class Port(ClientHandler, Protocol):
    """The port of a robot or another device, which hosts connect to."""

    @property
    def full(self) -> bool:
        """Whether one more host would be turned away at once."""

    def admit(self, client: HostConnection) -> None:
        """Connect `client`, now or soon, or turn it away."""


class TcpListener:
    """A listening socket in front of a port."""

    def __init__(self, port: Port, listener: socket.socket) -> None:
        self._port = port
        self._listener = listener
        self._loop = asyncio.get_running_loop()
        self._open()

    def close(self) -> None:
        """Stop listening."""
        if self._listener.fileno() >= 0:
            self._loop.remove_reader(self._listener)
            self._listener.close()

    def _open(self) -> None:
        if self._listener.fileno() >= 0:
            self._loop.add_reader(self._listener, self._accept)

    def _accept(self) -> None:
        """Accept one host; the next one is accepted in the next round of the loop."""
        try:
            connection, address = self._listener.accept()
        except OSError as error:
            if error.errno in {errno.EMFILE, errno.ENFILE, errno.ENOBUFS, errno.ENOMEM}:
                log.warning("cannot take another host: %s", error.strerror)
                self._loop.remove_reader(self._listener)
                self._loop.call_later(OUT_OF_FILES, self._open)
            return
        if self._port.full:
            connection.close()
            return
        connection.setblocking(False)
        with suppress(OSError):  # it has gone already; reading it reports that
            tune(connection)
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SEND_BUFFER)
        self._port.admit(
            SocketClient(self._port, as_file(connection), f"tcp://{address[0]}:{address[1]}")
        )


class PtyListener:
    """A pseudo terminal in front of a port; hosts open its `path`, such as `/dev/pts/3`."""

    def __init__(self, port: Port) -> None:
        pair = make_pty()
        os.set_blocking(pair.master, False)
        self.path = pair.path
        self._slave = pair.slave
        self._client = PtyClient(port, FileIO(pair.master, "r+"), pair.path, pair.slave)
        self._client.resume()

    @property
    def speed(self) -> int | None:
        """The speed that a host has set [baud], or `None` for one that serial ports lack."""
        return terminal_speed(self._slave) if self._slave >= 0 else None

    def close(self) -> None:
        """Remove the terminal."""
        self._client.remove()
        if self._slave >= 0:
            os.close(self._slave)
            self._slave = -1


class StreamServer:
    """Serves each connection to a listening socket in a task of its own.

    More than `most` connections at a time are closed at once; a first line is at most `limit` bytes
    long.
    """

    def __init__(
        self,
        serve: Callable[[asyncio.StreamReader, asyncio.StreamWriter], Coroutine[Any, Any, None]],
        *,
        most: float = inf,
        limit: int = 1 << 16,
    ) -> None:
        self._serve, self._most, self._limit = serve, most, limit
        self._server: asyncio.Server | None = None
        self._serving: set[asyncio.Task[None]] = set()

    async def listen(self, listener: socket.socket) -> tuple[str, int]:
        """Serve the hosts that connect to `listener`; return its address and number."""
        self._server = await asyncio.start_server(self._admit, sock=listener, limit=self._limit)
        address, number = listener.getsockname()[:2]
        return address, number

    def _admit(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        if len(self._serving) >= self._most:
            writer.close()
            return
        task = asyncio.ensure_future(self._serve(reader, writer))
        self._serving.add(task)
        task.add_done_callback(self._serving.discard)

    def close(self) -> None:
        """Stop listening, and cancel all tasks."""
        if self._server is not None:
            self._server.close()
        for task in self._serving:
            task.cancel()

    @asynccontextmanager
    async def at(self, host: str, number: int) -> AsyncIterator[str]:
        """Serve hosts at `host`:`number` while the block runs, 0 takes a free port; yield the URL.

        Raises:
            LinkError: The port cannot be listened on.
        """
        address = await self.listen(await listening(host, number))
        try:
            yield url_of(*address)
        finally:
            self.close()
            await asyncio.gather(*self._serving, return_exceptions=True)


async def first_free(host: str, number: int) -> socket.socket:
    """Return a socket that listens at `number`, or at the first free port after it.

    Raises:
        PortBusyError: There is none among the next :data:`TRIES`.
        LinkError: As for :func:`listening`.
    """
    for usual in range(number, number + TRIES - 1):
        with suppress(PortBusyError):
            return await listening(host, usual)
    return await listening(host, number + TRIES - 1)


async def listening(host: str, number: int) -> socket.socket:
    """Return a socket that listens at `host`:`number`; 0 takes a free port.

    Raises:
        PortBusyError: another program listens there.
        LinkError: this machine has no such address, or the port is not allowed.
    """
    if not 0 <= number < 65536:
        raise LinkError(f"{host}:{number}: ports are numbers from 1 to 65535")
    where = f"{host}:{number}"
    try:
        found = await asyncio.get_running_loop().getaddrinfo(
            host or None, number, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
        )
        family, _, _, _, address = min(found, key=lambda each: each[0] != socket.AF_INET)
        return _bound(family, address)
    except OSError as error:
        if error.errno == errno.EADDRINUSE:
            raise PortBusyError(
                f"{where}: in use; is another simulator running? Choose another port"
            ) from None
        raise LinkError(f"{where}: cannot listen there: {error.strerror}") from None


def _bound(family: int, address: tuple[Any, ...]) -> socket.socket:
    listener = socket.socket(family, socket.SOCK_STREAM)
    try:
        listener.setblocking(False)
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(address)
        listener.listen(BACKLOG)
    except OSError:
        listener.close()
        raise
    return listener
