"""Connections of hosts: over TCP, and from within this process."""

import asyncio
from collections.abc import Awaitable, Callable
from contextlib import suppress
from typing import Final, Protocol

from pioneer3.bridge.client import BridgeClient, HostPort
from pioneer3.errors import HungUpError
from pioneer3.links.base import HUNG_UP
from pioneer3.links.stream import tune, unacknowledged

MOST_UNSENT: Final = 64 * 1024
"""Most that waits for a host to take it [bytes]: 5 s of the longest laser sweeps. A host that takes
less is disconnected."""


class PortServer(Protocol):
    """Takes connections and their bytes."""

    def join(self, port: HostPort) -> BridgeClient | None:
        """Take a new connection; return `None` if it was turned away."""

    def receive(self, client: BridgeClient, data: bytes) -> bool:
        """Take bytes of a host; return whether it may send more at once."""

    def leave(self, client: BridgeClient) -> None:
        """Note that a host has gone."""


class SocketPort(asyncio.Protocol):
    """A host at the far end of a socket, by its address; `ports` has it while it is connected.

    It cannot know whether to give way. So many bytes were `sent` to it, those that wait included.
    """

    gives_way = False

    def __init__(self, server: PortServer, ports: "set[SocketPort]") -> None:
        self.name = "a host"
        self.sent = 0
        self._server, self._ports = server, ports
        self._client: BridgeClient | None = None
        self._transport: asyncio.Transport | None = None
        self._file = -1

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Join the bridge."""
        assert isinstance(transport, asyncio.Transport)
        self._transport = transport
        connection = transport.get_extra_info("socket")
        peer = transport.get_extra_info("peername")
        self._file = connection.fileno()
        if peer is not None:
            self.name = f"{peer[0]}:{peer[1]}"
        with suppress(OSError):  # it has gone already
            tune(connection)
        self._ports.add(self)
        self._client = self._server.join(self)

    def data_received(self, data: bytes) -> None:
        """Pass bytes of the host on."""
        if self._client is not None and not self._server.receive(self._client, data):
            self.pause()

    def connection_lost(self, error: Exception | None) -> None:
        """Tell the bridge."""
        self._ports.discard(self)
        if self._client is not None:
            self._server.leave(self._client)

    def send(self, data: bytes) -> None:
        """Send `data`, or disconnect a host that takes nothing."""
        transport = self._transport
        if transport is None or transport.is_closing():
            return
        self.sent += len(data)
        transport.write(data)
        if transport.get_write_buffer_size() > MOST_UNSENT:
            transport.abort()

    def close(self) -> None:
        """Close the socket once the bytes sent have left."""
        if self._transport is not None:
            self._transport.close()

    def abort(self) -> None:
        """Close the socket at once."""
        if self._transport is not None:
            self._transport.abort()

    def pause(self) -> None:
        """Stop reading; the full buffers of the operating system make the host wait."""
        if self._transport is not None and not self._transport.is_closing():
            self._transport.pause_reading()

    def resume(self) -> None:
        """Read again."""
        if self._transport is not None and not self._transport.is_closing():
            self._transport.resume_reading()

    @property
    def unacknowledged(self) -> int | None:
        """Number of bytes sent that the host's computer has not confirmed; `None` if unknown."""
        if self._transport is None or self._transport.is_closing():
            return None
        waiting = unacknowledged(self._file)
        return None if waiting is None else waiting + self._transport.get_write_buffer_size()


class MemoryPort:
    """A host within this process, as the bridge sees it."""

    def __init__(self, name: str, *, gives_way: bool) -> None:
        self.name, self.gives_way = name, gives_way
        self.closed = False
        self._inbox: asyncio.Queue[bytes] = asyncio.Queue()
        self._unread = 0

    def send(self, data: bytes) -> None:
        """Let the host read `data`; a host that reads nothing is disconnected."""
        if self.closed or not data:
            return
        self._unread += len(data)
        if self._unread > MOST_UNSENT:
            self.close()
        else:
            self._inbox.put_nowait(data)

    def close(self) -> None:
        """End the connection once the host has read all bytes."""
        if not self.closed:
            self.closed = True
            self._inbox.put_nowait(b"")

    async def take(self) -> bytes:
        """Return the next bytes for the host; `b""` at the end."""
        if self.closed and self._inbox.empty():
            return b""
        data = await self._inbox.get()
        self._unread -= len(data)
        return data


class BridgeLink:
    """The link of a host within this process to the robot of a bridge; see `Link`.

    `drained` waits until the robot takes more bytes.
    """

    speeds: tuple[int, ...] = ()
    round_trip = 0.0

    def __init__(
        self, server: PortServer, port: MemoryPort, drained: Callable[[], Awaitable[object]]
    ) -> None:
        self.url = f"bridge:{port.name}"
        self._server, self._port = server, port
        self._drained = drained
        self._client = server.join(port)

    async def read(self) -> bytes:
        """Return the robot's next bytes; `b""` once either side has closed."""
        data = await self._port.take()
        if self._port.closed and self._client is not None:
            self._server.leave(self._client)  # the bridge knows, unless the inbox was full
        return data

    async def write(self, data: bytes) -> None:
        """Send `data` to the robot; LinkError if the connection has ended."""
        if self._port.closed or self._client is None:
            raise HungUpError(f"{self.url}: the bridge has closed the connection; {HUNG_UP}")
        if not self._server.receive(self._client, data):
            await self._drained()

    async def set_speed(self, baud: int) -> None:
        """Do nothing: the bridge sets the speed of the line."""

    async def close(self) -> None:
        """Leave the bridge; safe to call twice."""
        self._port.close()
        if self._client is not None:
            self._server.leave(self._client)
