"""Latest value, many readers: a slow reader misses old values and never blocks the others."""

import asyncio
from collections.abc import AsyncIterator
from typing import Generic, TypeVar

T = TypeVar("T")


class Feed(Generic[T]):
    """A value that changes; readers always get the newest."""

    def __init__(self) -> None:
        self.latest: T | None = None
        self._count = 0
        self._changed = asyncio.Event()
        self._closed = False

    def publish(self, value: T) -> None:
        """Make `value` the latest and wake every reader."""
        self.latest = value
        self._count += 1
        self._wake()

    def close(self) -> None:
        """End every iteration."""
        self._closed = True
        self._wake()

    async def values(self) -> AsyncIterator[T]:
        """Yield each value published from now on, but only the newest to a slow reader.

        The last one before :meth:`close` is not skipped.
        """
        seen = self._count
        while True:
            if self._count != seen:
                seen = self._count
                if self.latest is not None:
                    yield self.latest
            elif self._closed:
                return
            else:
                await self._changed.wait()

    def _wake(self) -> None:
        self._changed.set()
        self._changed = asyncio.Event()
