"""ARCOS packets: framing and checksum, both directions, no I/O (protocol.md 1.2, 1.4, 1.6).

Layout::

    [ 0xFA ][ 0xFB ][ count ][ payload: count - 2 bytes ][ checksum: 2 bytes, high byte first ]

The payload is the packet's id followed by its arguments.
"""

from typing import Final

from pioneer3.errors import CommandError

HEADER: Final = b"\xfa\xfb"
MAX_PAYLOAD: Final = 253
"""The most that a one-byte count can carry; robots stay below 200 bytes a frame."""
PAUSE: Final = 0.05
"""Silence [s] after which an unfinished frame is suspected to be noise."""
MAX_REJECTED: Final = 8


def checksum(payload: bytes) -> int:
    """Return the 16-bit ARCOS checksum: big-endian words added up, an odd last byte XORed."""
    words = payload[: len(payload) & ~1]
    total = (sum(words[::2]) << 8) + sum(words[1::2]) & 0xFFFF
    return total ^ payload[-1] if len(payload) & 1 else total


def encode(payload: bytes) -> bytes:
    """Wrap `payload` in header, count and checksum; CommandError if it is empty or too long."""
    if not 1 <= len(payload) <= MAX_PAYLOAD:
        raise CommandError(f"a packet carries 1 to {MAX_PAYLOAD} bytes, not {len(payload)}")
    count = len(payload) + 2
    return HEADER + bytes([count]) + payload + checksum(payload).to_bytes(2, "big")


class PacketReader:
    """Incremental decoder: feed it bytes in any chunks, get payloads back.

    It never raises on bad input. A rejected frame is searched for the true header inside it, so
    noise costs no packet that arrived whole. A false header may claim up to 255 bytes to come; when
    the line pauses, complete frames behind it are taken out without waiting for those.

    Attributes:
        packets: Frames accepted.
        bad_checksums: Frames rejected because of their checksum.
        bytes_skipped: Bytes that belonged to no accepted frame.
        rejected: Payloads of the frames rejected by the latest :meth:`feed`, the last few.
    """

    def __init__(self) -> None:
        self.packets = 0
        self.bad_checksums = 0
        self.bytes_skipped = 0
        self.rejected: list[bytes] = []
        self._buffer = bytearray()
        self._heard = 0.0

    @property
    def unfinished(self) -> bytes:
        """The bytes of a packet that has begun, and is not whole yet."""
        return bytes(self._buffer)

    def discard(self) -> None:
        """Drop a packet that has begun: the next bytes have another sender."""
        self._buffer.clear()

    def feed(self, data: bytes, now: float = 0.0) -> list[bytes]:
        """Add bytes received at `now` [s, monotonic]; return every payload they complete."""
        self.rejected.clear()
        payloads = self._take_behind_pause() if now - self._heard > PAUSE else []
        self._heard = now
        self._buffer += data
        buffer, start = self._buffer, 0
        while (start := self._find_header(start)) + 2 < len(buffer):
            end = start + 3 + buffer[start + 2]
            if end > len(buffer):
                break
            payload = self._accept(start, end)
            if payload is None:
                start += 1
                self.bytes_skipped += 1
            else:
                payloads.append(payload)
                start = end
        del buffer[:start]
        return payloads

    def _find_header(self, start: int) -> int:
        """Return where the next header may begin; count the bytes before it as skipped."""
        found = self._buffer.find(HEADER, start)
        if found < 0:  # keep a lone trailing 0xFA: its 0xFB may be in the next chunk
            end = len(self._buffer)
            found = max(start, end - self._buffer.endswith(HEADER[:1]))
        self.bytes_skipped += found - start
        return found

    def _accept(self, start: int, end: int) -> bytes | None:
        payload = bytes(self._buffer[start + 3 : end - 2])
        if payload and checksum(payload) == int.from_bytes(self._buffer[end - 2 : end], "big"):
            self.packets += 1
            return payload
        self.bad_checksums += 1
        if len(self.rejected) < MAX_REJECTED:
            self.rejected.append(payload)
        return None

    def _take_behind_pause(self) -> list[bytes]:
        """Drop the unfinished frame if a complete one lies behind its header."""
        buffer = self._buffer
        start = 0
        while 0 <= (start := buffer.find(HEADER, start + 1)) < len(buffer) - 2:
            end = start + 3 + buffer[start + 2]
            if end <= len(buffer) and (payload := self._accept(start, end)) is not None:
                self.bytes_skipped += start
                del buffer[:end]
                return [payload]
        return []
