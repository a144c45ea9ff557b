"""FrameReader and headers of TCPROS, the protocol of topics and services (http://wiki.ros.org/ROS/TCPROS).

Everything is in frames: a length in 4 bytes, little-endian, and as many bytes. The first frame of
each side is a header, whose fields `name=value` are frames, too.
"""

import asyncio
from collections.abc import Mapping
from struct import Struct
from typing import Final

from pioneer3.links.stream import tune

LENGTH: Final = Struct("<I")
LONGEST_HEADER: Final = 1 << 20
"""Longer headers are refused [bytes]."""
LONGEST_MESSAGE: Final = 1 << 28
"""Longer messages are refused [bytes]: the other side speaks another protocol."""
PATIENCE: Final = 5.0
"""Longest wait for the header of the other side [s]."""
KEEPALIVE: Final = {
    "TCP_KEEPIDLE": 3,
    "TCP_KEEPINTVL": 2,
    "TCP_KEEPCNT": 2,
    "TCP_USER_TIMEOUT": 7000,
}
"""Another side without power is found out after 7 s: asked after 3 s without a byte, twice in all;
what is sent to it waits as long. Options of the system, where it has them [s, s, 1, ms]."""


def framed(data: bytes) -> bytes:
    """Return a frame."""
    return LENGTH.pack(len(data)) + data


def header_frame(fields: Mapping[str, str]) -> bytes:
    """Return the frame of a header."""
    return framed(b"".join(framed(f"{name}={value}".encode()) for name, value in fields.items()))


def parse_header(data: bytes) -> dict[str, str]:
    """Return the fields of a header; ValueError if it is none."""
    fields, at = {}, 0
    while at < len(data):
        if at + LENGTH.size > len(data):
            raise ValueError("a header of TCPROS is cut off")
        (size,) = LENGTH.unpack_from(data, at)
        field = data[at + LENGTH.size : at + LENGTH.size + size]
        name, equals, value = field.partition(b"=")
        if len(field) != size or not equals:
            raise ValueError("a field in a header of TCPROS is malformed")
        fields[name.decode()] = value.decode()
        at += LENGTH.size + size
    return fields


class FrameReader:
    """Takes frames from bytes as they come."""

    def __init__(self) -> None:
        self._rest = bytearray()

    def of(self, data: bytes) -> list[bytes]:
        """Return the contents of the frames that are whole now; ValueError for one too long."""
        rest = self._rest
        if not rest and data[: LENGTH.size] == LENGTH.pack(max(0, len(data) - LENGTH.size)):
            return [data[LENGTH.size :]]  # as nearly always
        rest += data
        found, at = [], 0
        while at + LENGTH.size <= len(rest):
            (size,) = LENGTH.unpack_from(rest, at)
            if size > LONGEST_MESSAGE:
                raise ValueError(f"a frame of {size} bytes: that is not TCPROS")
            end = at + LENGTH.size + size
            if end > len(rest):
                break
            found.append(bytes(rest[at + LENGTH.size : end]))
            at = end
        del rest[:at]
        return found


async def read_frame(reader: asyncio.StreamReader, longest: int = LONGEST_MESSAGE) -> bytes:
    """Return the content of the next frame; errors as of :func:`read_content`."""
    return await read_content(reader, await reader.readexactly(LENGTH.size), longest)


async def read_content(reader: asyncio.StreamReader, length: bytes, longest: int) -> bytes:
    """Return the content of a frame whose `length` is read.

    Raises:
        EOFError: the other side has closed the connection.
        ValueError: the frame is longer than `longest` [bytes].
    """
    (size,) = LENGTH.unpack(length)
    if size > longest:
        raise ValueError(f"a frame of {size} bytes: that is not TCPROS")
    return await reader.readexactly(size)


async def read_header(reader: asyncio.StreamReader) -> dict[str, str]:
    """Return the header of the other side.

    Raises:
        EOFError: it has closed the connection.
        ValueError: that is no header.
        TimeoutError: nothing comes.
    """
    async with asyncio.timeout(PATIENCE):
        return parse_header(await read_frame(reader, LONGEST_HEADER))


def prepare(writer: asyncio.StreamWriter | asyncio.BaseTransport) -> None:
    """Have a connection send at once, and notice when the other side is gone."""
    if (connection := writer.get_extra_info("socket")) is not None:
        tune(connection, KEEPALIVE)
