"""Bytes that leave at the speed of a serial line. No I/O."""

from math import inf
from typing import Final

BITS: Final = 10
"""Of a byte: start, eight, stop."""
AT_ONCE: Final = 14
"""Bytes that a serial port hands on together."""
AT_ONCE_TIME: Final = 0.002
"""A fast port hands on the bytes of this time together [s]."""
CHANGE_TIME: Final = 0.005
"""The speed changes so long after the last byte [s]."""
MAX_QUEUE: Final = 1 << 17
"""A network host that does not read loses further scans from here on."""


class Line:
    """The queue of bytes towards a host.

    Args:
        baud: Speed, or `None` for a link that takes all bytes at once.

    Attributes:
        baud: The same.
        due: When bytes may leave [s]; `inf`: never.
    """

    def __init__(self, baud: int | None) -> None:
        self.baud = baud
        self.due = inf
        self._queue = bytearray()
        self._next_baud: int | None = None
        self._free_at = 0.0

    @property
    def busy(self) -> bool:
        """Whether a scan would have to wait."""
        return bool(self._queue) if self.baud else len(self._queue) > MAX_QUEUE

    def put(self, data: bytes, now: float) -> None:
        """Queue `data`."""
        if not self._queue:
            self._free_at = max(self._free_at, now)
        self._queue += data
        self._plan()

    def take(self, now: float) -> bytes:
        """Return and forget the bytes that have left completely by `now`."""
        count = len(self._queue)
        if self.baud:
            count = min(count, int((now - self._free_at) * self.baud / BITS + 1e-6))
            self._free_at += count * BITS / self.baud
        data = bytes(self._queue[:count])
        del self._queue[:count]
        if self._next_baud and not self._queue:
            if data:
                self._free_at = now + CHANGE_TIME
            elif now >= self._free_at:
                self.baud, self._next_baud = self._next_baud, None
        self._plan()
        return data

    def change_speed(self, baud: int) -> None:
        """Change the speed when the queue has left."""
        self._next_baud = baud
        self._plan()

    def clear(self) -> None:
        """Forget all bytes, and the change of speed."""
        self._queue.clear()
        self._next_baud, self.due = None, inf

    def _plan(self) -> None:
        if not self._queue:
            self.due = self._free_at if self._next_baud else inf
        elif self.baud:
            together = max(AT_ONCE, int(self.baud / BITS * AT_ONCE_TIME))
            self.due = self._free_at + min(len(self._queue), together) * BITS / self.baud
        else:
            self.due = self._free_at
