"""A link over an asyncio stream pair: sockets, serial ports and ptys differ only in opening."""

import asyncio
from collections.abc import Awaitable, Callable

from pioneer3.errors import LinkError
from pioneer3.links.base import HUNG_UP

CLOSE_PATIENCE = 0.5


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
        writer.transport.set_write_buffer_limits(high=0)  # what waits for the link waits above it

    async def read(self) -> bytes:
        """Return the next bytes; `b""` once the far end has closed."""
        try:
            return await self._reader.read(4096)
        except OSError as error:
            raise self._failed(error) from error

    async def write(self, data: bytes) -> None:
        """Send `data`; waits only while the far end does not take it."""
        if self._writer.is_closing():
            raise LinkError(f"{self.url}: the link is closed")
        try:
            self._writer.write(data)
            await self._writer.drain()
        except OSError as error:
            raise self._failed(error) from error

    def _failed(self, error: OSError) -> LinkError:
        if isinstance(error, ConnectionResetError | BrokenPipeError):
            return LinkError(f"{self.url}: the far end hung up; {HUNG_UP}")
        return LinkError(f"{self.url}: {error}")

    async def set_speed(self, baud: int) -> None:
        """Change the line speed, where there is one."""
        if self._change_speed is not None:
            await self._change_speed(baud)

    async def close(self) -> None:
        """Flush and close; a far end that takes nothing is cut off."""
        if self._closed:  # a second `wait_closed` would find the first one's cancellation
            return
        self._closed = True
        self._writer.close()
        try:
            async with asyncio.timeout(CLOSE_PATIENCE):
                await self._writer.wait_closed()
        except (OSError, TimeoutError):
            self._writer.transport.abort()
