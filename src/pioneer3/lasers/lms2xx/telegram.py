"""Telegrams of the LMS-2xx: framing and checksum, both directions, no I/O (lms2xx.md 1.1 to 1.3).

Layout, all numbers low byte first::

    [ 0x02 ][ address ][ length: u16 ][ code ][ data: length - 1 bytes ][ checksum: u16 ]

Between telegrams stand single bytes: ACK for a request that arrived whole, NAK for a spoilt one.
"""

from collections import deque
from collections.abc import Collection
from dataclasses import dataclass
from enum import Enum
from math import inf
from typing import Final

from pioneer3.errors import CommandError
from pioneer3.lasers.line import ROUNDING

STX: Final = 0x02
FRAME: Final = 6
"""Bytes of a telegram that its length does not count."""
MAX_LENGTH: Final = 812
"""More than any telegram needs: 401 values with both indices make 808."""
LOWEST_CODE: Final = 0x10
"""No command has a lower code; noise often has 0."""
PAUSE: Final = 0.1
"""Silence [s] after which an unfinished telegram is noise; units pause for 14 ms at most."""
ANY_UNIT: Final = 0x00
"""Address of requests to whichever unit listens."""
UNITS: Final = range(0x80, 0x85)
"""Addresses that answers come from: 0x80 plus the unit's own (lms2xx.md 1.1)."""
USUAL_STATUS: Final = 0x10


class Sign(Enum):
    """A byte that stands alone."""

    ACK = 0x06
    NAK = 0x15


@dataclass(frozen=True, slots=True)
class Telegram:
    """One telegram, whose first byte began to arrive when it `began` [s, monotonic].

    An answer has an address and a code that are 0x80 more, and a status byte at the end of its
    data.
    """

    address: int
    code: int
    data: bytes
    began: float = 0.0

    @property
    def body(self) -> bytes:
        """The data of an answer, without its status byte."""
        return self.data[:-1]

    @property
    def status(self) -> int:
        """The status byte of an answer (lms2xx.md 1.11)."""
        return self.data[-1]


Item = Telegram | Sign


def checksum(data: bytes) -> int:
    """Return the checksum of `data`, which begins with STX (lms2xx.md 1.2).

    One shift a byte, unlike any usual CRC-16; so no library function serves. 732 bytes take 0.1 ms.
    """
    value = previous = 0
    for byte in data:
        value = value << 1 ^ previous << 8 ^ byte
        if value & 0x10000:
            value ^= 0x18005
        previous = byte
    return value


def encode(code: int, data: bytes = b"", address: int = ANY_UNIT) -> bytes:
    """Return a telegram as it goes over the wire; CommandError if the data are too long for one."""
    length = 1 + len(data)
    if length > MAX_LENGTH:
        raise CommandError(f"a telegram carries at most {MAX_LENGTH} bytes, not {length}")
    frame = bytes((STX, address)) + length.to_bytes(2, "little") + bytes((code,)) + data
    return frame + checksum(frame).to_bytes(2, "little")


class LmsTelegramReader:
    """Incremental decoder: feed it bytes in any chunks, get telegrams, ACK and NAK back.

    It never raises on bad input, and takes telegrams to `addresses` alone. A rejected telegram is
    searched for the true beginning inside it, so noise costs no telegram that arrived whole. A
    false beginning may claim many bytes to come; when the line pauses, those are given up. ACK and
    NAK are believed only where they directly follow a telegram, another one of them, or a pause:
    noise is full of them.

    `byte_time` is that of one byte on the wire [s], 0 without a serial line; telegrams with a wrong
    checksum are `rejected`, bytes that belong to nothing `skipped`.
    """

    def __init__(self, addresses: Collection[int]) -> None:
        self.byte_time = 0.0
        self.rejected = 0
        self.skipped = 0
        self._addresses = addresses
        self._buffer = bytearray()
        self._passed = 0
        self._arrivals: deque[tuple[int, float]] = deque()
        self._heard = -inf
        self._clean = True

    @property
    def due(self) -> float:
        """When an unfinished telegram is given up, if nothing comes before [s]; `inf`: never."""
        return self._heard + PAUSE if self._buffer else inf

    @property
    def has_begun(self) -> bool:
        """Whether a telegram has begun, as far as its code: noise hardly ever looks so."""
        return len(self._buffer) >= FRAME - 1

    def discard(self) -> None:
        """Drop a telegram that has begun: the next bytes have another speed."""
        self._pass(len(self._buffer))
        self._clean = True

    def feed(self, data: bytes, now: float) -> list[Item]:
        """Add bytes received at `now` [s, monotonic]; return all that they complete."""
        items: list[Item] = []
        if now >= self._heard + PAUSE - ROUNDING:
            items += self._take(over=True)
            self._clean = True
        if data:
            self._arrivals.append((self._passed + len(self._buffer), self._begin_of(data, now)))
            self._heard = now
            self._buffer += data
            items += self._take(over=False)
        return items

    def _begin_of(self, data: bytes, now: float) -> float:
        """Return when the first byte of `data` began: they came in a row after the last ones."""
        return min(now, max(self._heard, now - len(data) * self.byte_time))

    def _take(self, *, over: bool) -> list[Item]:
        """Take the complete telegrams; if the line is `over`, nothing completes the others."""
        buffer, start, items = self._buffer, 0, list[Item]()
        while start < len(buffer):
            size = self._size(start)
            if size and start + size > len(buffer):
                if not over:
                    break
                size = 0
            if size == 1:
                items.append(Sign(buffer[start]))
            elif size and (telegram := self._accept(start, size)):
                items.append(telegram)
            else:
                size = 0
                self.skipped += 1
            self._clean = size > 0
            start += size or 1
        self._pass(start)
        return items

    def _size(self, start: int) -> int:
        """Return the size of the item at `start`, as far as it can be seen, or 0 if there is none.

        A telegram whose length has not come yet has the smallest size.
        """
        buffer = self._buffer
        first, seen = buffer[start], len(buffer) - start
        if first != STX:
            return int(self._clean and first in {Sign.ACK.value, Sign.NAK.value})
        if seen > 1 and buffer[start + 1] not in self._addresses:
            return 0
        if seen < 4:
            return FRAME + 1
        if seen > 4 and buffer[start + 4] < LOWEST_CODE:
            return 0
        length = int.from_bytes(buffer[start + 2 : start + 4], "little")
        shortest = 2 if buffer[start + 1] in UNITS else 1  # an answer has a status byte
        return FRAME + length if shortest <= length <= MAX_LENGTH else 0

    def _accept(self, start: int, size: int) -> Telegram | None:
        frame = bytes(self._buffer[start : start + size])
        if checksum(frame[:-2]) != int.from_bytes(frame[-2:], "little"):
            self.rejected += 1
            return None
        return Telegram(frame[1], frame[4], frame[5:-2], self._began(start))

    def _began(self, start: int) -> float:
        """Return when the byte at `start` of the buffer began to arrive [s]."""
        at = self._passed + start
        index, began = next(a for a in reversed(self._arrivals) if a[0] <= at)
        return min(self._heard, began + (at - index) * self.byte_time)

    def _pass(self, count: int) -> None:
        """Forget the first `count` bytes of the buffer."""
        del self._buffer[:count]
        self._passed += count
        while len(self._arrivals) > 1 and self._arrivals[1][0] <= self._passed:
            self._arrivals.popleft()
