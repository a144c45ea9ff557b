"""Latest value, many readers: who is slow misses old values, never blocks the others."""

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
        """Yield each value published from now on, skipping those that came while busy."""
        seen = self._count
        while not self._closed:
            if self._count == seen:
                await self._changed.wait()
                continue
            seen = self._count
            if self.latest is not None:
                yield self.latest

    def _wake(self) -> None:
        self._changed.set()
        self._changed = asyncio.Event()
