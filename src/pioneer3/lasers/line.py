"""The sending half of a line: bytes leave one after the other at its speed. No I/O."""

from collections import deque
from math import inf
from typing import Final

BITS_PER_BYTE: Final = 10
"""With start and stop bit."""
PIECE: Final = 16
"""Bytes that are worth a wake-up: as many as a UART collects."""
PIECE_TIME: Final = 0.002
"""On a fast line the bytes of this time are one piece [s]."""
MOST_HELD: Final = 4096
"""Bytes that wait for a host that takes none [bytes], above which the line counts as busy."""
ROUNDING: Final = 1e-9
"""Event loops wake up this much early [s]."""


def duration(count: int, baud: int | None) -> float:
    """Return the time that `count` bytes take [s]; 0 where there is no speed."""
    return count * BITS_PER_BYTE / baud if baud else 0.0


class SerialLine:
    """Bytes on their way out; so many are `waiting`, and have not left yet.

    `speed` [baud] is `None` for a line that takes all bytes at once, such as a network's.
    """

    def __init__(self, speed: int | None) -> None:
        self.speed = speed
        self.waiting = 0
        self._queue: deque[tuple[float, bytes | int]] = deque()
        self._free_at = -inf

    def send(self, data: bytes, now: float) -> None:
        """Let `data` leave from `now` on, behind all that is queued."""
        self.waiting += len(data)
        self._queue.append((now, data))

    def then_change_to(self, baud: int) -> None:
        """Change the speed once all that is queued has left."""
        self._queue.append((-inf, baud))

    def clear(self, speed: int | None) -> None:
        """Forget all that has not left, and be at `speed`."""
        self._queue.clear()
        self.waiting, self.speed, self._free_at = 0, speed, -inf

    def drop(self) -> None:
        """Forget the bytes that have not left; changes of the speed remain."""
        self._queue = deque(entry for entry in self._queue if isinstance(entry[1], int))
        self.waiting = 0

    @property
    def free_at(self) -> float:
        """When all that is queued will have left [s]."""
        at, speed = self._free_at, self.speed
        for since, entry in self._queue:
            if isinstance(entry, int):
                speed = entry
            else:
                at = max(at, since) + duration(len(entry), speed)
        return at

    def is_busy(self, now: float) -> bool:
        """Tell whether a message sent at `now` [s] would have to wait."""
        return self.free_at > now + ROUNDING or self.waiting > MOST_HELD

    @property
    def due(self) -> float:
        """When another piece of bytes will have left [s]; `inf`: never."""
        if not self._queue:
            return inf
        since, entry = self._queue[0]
        size = 0
        if isinstance(entry, bytes) and self.speed:
            size = min(max(PIECE, int(PIECE_TIME * self.speed / BITS_PER_BYTE)), len(entry))
        return max(self._free_at, since) + duration(size, self.speed)

    def take(self, now: float) -> bytes:
        """Return and forget the bytes that have left by `now`, all at one speed.

        It is the speed from before the call. Where the speed changes, the call ends.
        """
        out = bytearray()
        while self._queue:
            since, entry = self._queue[0]
            if isinstance(entry, int):
                self.speed = entry
                self._queue.popleft()
                break
            at = max(self._free_at, since)
            count = self._count(len(entry), now - at)
            if count <= 0:
                break
            out += entry[:count]
            self._free_at = at + duration(count, self.speed)
            if count < len(entry):
                self._queue[0] = (since, entry[count:])
                break
            self._queue.popleft()
        self.waiting -= len(out)
        return bytes(out)

    def _count(self, most: int, seconds: float) -> int:
        """Return how many bytes leave in so many seconds, at most `most`."""
        if not self.speed:
            return most if seconds >= -ROUNDING else 0
        return min(most, int((seconds + ROUNDING) * self.speed / BITS_PER_BYTE))
