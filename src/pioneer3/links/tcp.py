"""TCP: a simulator, or a robot behind an Ethernet-to-serial bridge."""

import asyncio
import errno
import socket

from pioneer3.errors import LinkError, PortNotFoundError
from pioneer3.links.stream import StreamLink

CONNECT_PATIENCE = 5.0
LONGEST_ROUND_TRIP = 1.0
"""Connecting takes one round trip; what takes longer was looking up the name [s]."""
KEEPALIVE = {"TCP_KEEPIDLE": 5, "TCP_KEEPINTVL": 2, "TCP_KEEPCNT": 3, "TCP_USER_TIMEOUT": 10_000}
"""A far end that is gone without a word is noticed within about 10 s [s, s, times, ms]."""


async def open_tcp(host: str, port: int) -> StreamLink:
    """Connect to `host`:`port`.

    Raises:
        PortNotFoundError: the name is unknown, or nobody listens there.
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
        raise PortNotFoundError(f"{url}: no host of the name {host!r} is known") from None
    except OSError as error:
        if error.errno == errno.ECONNREFUSED or "Connect call failed" in str(error):
            raise PortNotFoundError(
                f"{url}: nobody listens there; a simulator starts with: pioneer3 sim -p {port}"
            ) from None
        raise LinkError(f"{url}: {error}") from error
    return accepted(url, reader, writer, round_trip=min(clock() - began, LONGEST_ROUND_TRIP))


def accepted(
    url: str,
    reader: asyncio.StreamReader,
    writer: asyncio.StreamWriter,
    *,
    round_trip: float = 0.0,
) -> StreamLink:
    """Make a link of a connected socket."""
    tune(writer.get_extra_info("socket"))
    return StreamLink(url, reader, writer, round_trip=round_trip)


def tune(connection: socket.socket) -> None:
    """Let small packets go at once, and a dead far end be noticed."""
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for name, value in KEEPALIVE.items():
        if (option := getattr(socket, name, None)) is not None:  # not all systems have all
            connection.setsockopt(socket.IPPROTO_TCP, option, value)
