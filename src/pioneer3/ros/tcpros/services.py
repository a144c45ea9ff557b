"""Services of ROS 1: offered, and called."""

import asyncio
from collections.abc import Awaitable, Callable
from contextlib import suppress
from typing import Final
from urllib.parse import urlsplit

from pioneer3.ros.tcpros.framing import (
    LENGTH,
    PATIENCE,
    framed,
    header_frame,
    prepare,
    read_content,
    read_frame,
    read_header,
)
from pioneer3.ros.tcpros.master import connect
from pioneer3.ros.tcpros.publisher import ANY
from pioneer3.ros.tcpros.types import Definition

Handle = Callable[[bytes], Awaitable[bytes]]
"""Given a serialized request, returns the response, or raises a :class:`ServiceError`."""
LONGEST_REQUEST: Final = 1 << 16
"""Longer requests are refused [bytes]."""
DONE, FAILED = b"\x01", b"\x00"


class ServiceError(Exception):
    """A service was called and has failed; the message says why."""


class ServiceServer:
    """A service that is offered; `handle` does the work."""

    def __init__(self, name: str, type_: Definition, handle: Handle) -> None:
        self.name, self.type, self._handle = name, type_, handle

    async def serve(
        self,
        header: dict[str, str],
        reader: asyncio.StreamReader,
        writer: asyncio.StreamWriter,
        caller: str,
    ) -> None:
        """Serve one client."""
        if header.get("md5sum") not in {ANY, self.type.md5sum}:
            writer.write(header_frame({"error": f"{self.name} is of {self.type.name}"}))
            return
        own = {"callerid": caller, "md5sum": self.type.md5sum, "type": self.type.name}
        own |= {f"{part.lower()}_type": own["type"] + part for part in ("Request", "Response")}
        writer.write(header_frame(own))
        persistent = header.get("persistent") == "1"
        if header.get("probe") == "1":
            return
        with suppress(EOFError):
            while True:
                async with asyncio.timeout(None if persistent else PATIENCE):
                    length = await reader.readexactly(LENGTH.size)
                async with asyncio.timeout(PATIENCE):
                    request = await read_content(reader, length, LONGEST_REQUEST)
                await self._respond(request, writer)
                if not persistent:
                    return

    async def _respond(self, request: bytes, writer: asyncio.StreamWriter) -> None:
        try:
            frame = DONE + framed(await self._handle(request))
        except ServiceError as error:
            frame = FAILED + framed(str(error).encode())
        writer.write(frame)
        await writer.drain()


async def call(uri: str, name: str, type_: Definition, caller: str, request: bytes) -> bytes:
    """Call the service at an address such as `rosrpc://robot:43211`; return the response.

    Raises:
        ServiceError: it is of another type, or has failed.
        OSError, EOFError, ValueError: nobody is there, it has ended, or that is no service.
    """
    address = urlsplit(uri)
    reader, writer = await connect(address.hostname, address.port)
    try:
        prepare(writer)
        header = {"callerid": caller, "md5sum": type_.md5sum, "service": name, "type": type_.name}
        writer.write(header_frame(header))
        theirs = await read_header(reader)
        if "error" in theirs:
            raise ServiceError(theirs["error"])
        writer.write(framed(request))
        done = await reader.readexactly(1)
        response = await read_frame(reader)
    finally:
        writer.close()
    if done != DONE:
        raise ServiceError(response.decode(errors="replace"))
    return response
