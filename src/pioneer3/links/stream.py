"""Links over a pair of asyncio streams: serial ports, and TCP to simulators and serial bridges."""

import asyncio
import errno
import socket
import sys
from array import array
from collections.abc import Awaitable, Callable, Iterator, Mapping
from contextlib import contextmanager

from pioneer3.errors import HungUpError, LinkError, PortNotFoundError, UnknownHostError
from pioneer3.links.base import HUNG_UP, WRITTEN
from pioneer3.links.hosts import is_loopback

try:
    import fcntl
    import termios
except ImportError:  # Windows
    fcntl = termios = None  # type: ignore[assignment]

CLOSE_PATIENCE = 0.5
CONNECT_PATIENCE = 5.0
LONGEST_ROUND_TRIP = 1.0
"""Upper bound of the measured round trip [s]; connecting can take longer because of the name
lookup."""
READ = 1 << 14
"""Most that is read at once [bytes]."""
KEEPALIVE = {"TCP_KEEPIDLE": 5, "TCP_KEEPINTVL": 2, "TCP_KEEPCNT": 3, "TCP_USER_TIMEOUT": 10_000}
"""A far end that vanishes without closing is noticed within about 10 s [s, s, times, ms]."""


class StreamLink:
    """A byte pipe over a stream reader and writer."""

    def __init__(
        self,
        url: str,
        reader: asyncio.StreamReader,
        writer: asyncio.StreamWriter,
        *,
        speeds: tuple[int, ...] = (),
        round_trip: float = 0.0,
        change_speed: Callable[[int], Awaitable[None]] | None = None,
    ) -> None:
        self.url = url
        self.speeds = speeds
        self.round_trip = round_trip
        self._reader = reader
        self._writer = writer
        self._change_speed = change_speed
        self._closed = False
        writer.transport.set_write_buffer_limits(high=0)  # the callers keep the queue

    async def read(self) -> bytes:
        """Return the next bytes; `b""` once the far end has closed."""
        try:
            return await self._reader.read(READ)
        except OSError as error:
            raise self._failed(error) from error

    @contextmanager
    def handing(self, take: Callable[[bytes], None]) -> Iterator[None]:
        """Give all that comes to `take`: to wake a task for it costs a round of the loop."""
        self._reader.feed_data = take  # type: ignore[assignment, method-assign]
        try:
            yield
        finally:
            del self._reader.feed_data

    def write(self, data: bytes) -> Awaitable[None]:
        """Send `data`; there is something to wait for only while the far end does not take it."""
        if self._writer.is_closing():
            raise LinkError(f"{self.url}: the link is closed")
        self._writer.write(data)
        transport = self._writer.transport
        if transport.get_write_buffer_size() or transport.is_closing():
            return self._drain()
        return WRITTEN

    async def _drain(self) -> None:
        try:
            await self._writer.drain()
        except OSError as error:
            raise self._failed(error) from error

    def _failed(self, error: OSError) -> LinkError:
        if isinstance(error, ConnectionResetError | BrokenPipeError):
            return HungUpError(f"{self.url}: the far end hung up; {HUNG_UP}")
        return LinkError(f"{self.url}: {error}")

    async def set_speed(self, baud: int) -> None:
        """Change the line speed, where there is one."""
        if self._change_speed is not None:
            await self._change_speed(baud)

    async def close(self) -> None:
        """Flush and close; abort if the far end does not read."""
        if self._closed:  # a second `wait_closed` would raise the first one's cancellation
            return
        self._closed = True
        self._writer.close()
        try:
            async with asyncio.timeout(CLOSE_PATIENCE):
                await self._writer.wait_closed()
        except (OSError, TimeoutError):
            self._writer.transport.abort()


async def open_tcp(host: str, port: int) -> StreamLink:
    """Connect to `host`:`port`.

    Raises:
        PortNotFoundError: the name is unknown, or nothing listens there.
        LinkError: the host cannot be reached.
    """
    url = f"tcp://{host}:{port}"
    clock = asyncio.get_running_loop().time
    began = clock()
    try:
        async with asyncio.timeout(CONNECT_PATIENCE):
            reader, writer = await asyncio.open_connection(host, port)
    except TimeoutError:
        raise LinkError(
            f"{url}: no answer within {CONNECT_PATIENCE:g} s; is {host} on, and in this network?"
        ) from None
    except (socket.gaierror, UnicodeError):  # unknown, or not even a name
        raise UnknownHostError(f"{url}: no host of the name {host!r} is known") from None
    except OSError as error:
        if error.errno == errno.ECONNREFUSED or "Connect call failed" in str(error):
            starts = (
                f"a simulator starts with: pioneer3 sim -p {port}"
                if is_loopback(host)
                else "on the robot's computer start pioneer3 bridge, or the "
                "service of pioneer3 fleet deploy"
            )
            raise PortNotFoundError(f"{url}: nobody listens there; {starts}") from None
        raise LinkError(f"{url}: {error}") from error
    return accepted(url, reader, writer, round_trip=min(clock() - began, LONGEST_ROUND_TRIP))


def accepted(
    url: str,
    reader: asyncio.StreamReader,
    writer: asyncio.StreamWriter,
    *,
    round_trip: float = 0.0,
) -> StreamLink:
    """Return a link over a connected socket."""
    tune(writer.get_extra_info("socket"))
    # asyncio's 256 KiB are memory that the system maps and unmaps for each read
    writer.transport.max_size = READ  # type: ignore[attr-defined]
    return StreamLink(url, reader, writer, round_trip=round_trip)


def tune(connection: socket.socket, keepalive: Mapping[str, int] = KEEPALIVE) -> None:
    """Send small packets at once, and notice a far end that has vanished."""
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for name, value in keepalive.items():
        if (option := getattr(socket, name, None)) is not None:  # differs between systems
            connection.setsockopt(socket.IPPROTO_TCP, option, value)


def unacknowledged(file: int) -> int | None:
    """Return the number of bytes sent over a TCP socket that the far computer has not confirmed.

    `file` is the descriptor of the socket. Linux counts them (tcp(7), SIOCOUTQ); `None` on another
    system, and for a socket that is closed.
    """
    if sys.platform != "linux":
        return None
    count = array("i", [0])
    try:
        fcntl.ioctl(file, termios.TIOCOUTQ, count)
    except OSError:
        return None
    return count[0]
