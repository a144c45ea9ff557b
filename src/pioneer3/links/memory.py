"""A null-modem cable in memory, with faults, for tests and the embedded simulator."""

import asyncio
from collections.abc import Callable, Iterable

from pioneer3.errors import LinkError

Fault = Callable[[bytes], Iterable[bytes]]
"""Takes the bytes that one end sends; returns the pieces that arrive, in order."""


def clean(data: bytes) -> Iterable[bytes]:
    """Deliver as sent."""
    return (data,)


class MemoryLink:
    """One end of the cable; `fault` may split, drop or corrupt its bytes.

    Attributes:
        fault: May be changed at any time.
        delay: Travel time of bytes from this end [s].
        peer: The far end, or `None` without a cable.
        speed: Line speed [baud]; bytes between ends of different speed arrive as noise.
    """

    def __init__(self, url: str, fault: Fault = clean, speeds: tuple[int, ...] = ()) -> None:
        self.url = url
        self.speeds = speeds
        self.fault = fault
        self.delay = 0.0
        self.speed = speeds[0] if speeds else None
        self.peer: MemoryLink | None = None
        self._inbox: asyncio.Queue[bytes] = asyncio.Queue()
        self._closed = False

    @property
    def round_trip(self) -> float:
        """Travel time of bytes there and back [s]."""
        return self.delay + (self.peer.delay if self.peer is not None else 0.0)

    async def read(self) -> bytes:
        """Return the far end's bytes; `b""` once either end has closed."""
        if self._closed and self._inbox.empty():
            return b""
        data = await self._inbox.get()
        if not data:
            self._closed = True
        return data

    async def write(self, data: bytes) -> None:
        """Send `data` through the faults of this end."""
        if self._closed or self.peer is None:
            raise LinkError(f"{self.url}: the far end has closed")
        for piece in self.fault(data):
            if piece:
                self._deliver(piece)

    async def set_speed(self, baud: int) -> None:
        """Change the line speed of this end."""
        self.speed = baud

    async def close(self) -> None:
        """Unplug; the far end reads `b""`."""
        if not self._closed:
            self._closed = True
            self._inbox.put_nowait(b"")
            if self.peer is not None:
                self.peer._arrive(b"", self.delay)

    def _deliver(self, piece: bytes) -> None:
        peer = self.peer
        if peer is None or peer._closed:
            return
        if self.speed != peer.speed:  # like a UART at the wrong speed
            piece = bytes(byte * 37 % 256 | 0x80 for byte in piece)
        peer._arrive(piece, self.delay)

    def _arrive(self, data: bytes, delay: float) -> None:
        if delay:
            asyncio.get_running_loop().call_later(delay, self._inbox.put_nowait, data)
        else:
            self._inbox.put_nowait(data)


def null_modem(
    fault: Fault = clean, *, speeds: tuple[int, ...] = ()
) -> tuple[MemoryLink, MemoryLink]:
    """Return the two ends of a cable; `fault` applies to both directions."""
    ours = MemoryLink("memory:host", fault, speeds)
    theirs = MemoryLink("memory:robot", fault, speeds)
    ours.peer, theirs.peer = theirs, ours
    return ours, theirs
