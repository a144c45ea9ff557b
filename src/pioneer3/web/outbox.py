"""What one visitor is still to be told. However slow they are, it stays small."""

import asyncio
from collections import deque
from collections.abc import Iterator
from typing import Any

from pioneer3.web.channel import Channel
from pioneer3.web.messages import encode
from pioneer3.web.page import Page

MOST_ANSWERS = 32
"""Who takes none misses the oldest."""


class Outbox:
    """Texts for the guest `number` of `page`, made when they can be sent: the newest then.

    Snapshots begin with the first one that comes: an old one would look like a fresh one.

    Attributes:
        watched: What this visitor alone has opened.
    """

    def __init__(self, page: Page, number: int) -> None:
        self._page = page
        self._number = number
        self._people = 0
        self._seen: dict[Channel, int] = {
            page.snapshots: page.snapshots.version,
            page.scans: page.scans.version,
        }
        self.watched: Channel | None = None
        self._answers: deque[str] = deque(maxlen=MOST_ANSWERS)
        self._news = asyncio.Event()
        self._news.set()

    def wake(self) -> None:
        """Look again for what is new."""
        self._news.set()

    def answer(self, message: dict[str, Any]) -> None:
        """Tell this visitor alone."""
        self._answers.append(encode(message))
        self.wake()

    async def news(self) -> Iterator[str]:
        """Wait for something new; return all of it, to be sent one by one."""
        await self._news.wait()
        self._news.clear()
        return self._due()

    def _due(self) -> Iterator[str]:
        page = self._page
        yield from self._newer(page.notices)
        if page.people.version != self._people:
            self._people = page.people.version
            yield page.people.told_to(self._number)
        if page.world_news is not None:
            yield from self._newer(page.world_news)
        yield from self._newer(page.snapshots)
        if self.watched is not None:
            yield from self._newer(self.watched)
        if page.scans.wanted_by(self._number):
            yield from self._newer(page.scans)
        while self._answers:
            yield self._answers.popleft()

    def _newer(self, channel: Channel) -> list[str]:
        seen = self._seen.get(channel, 0)
        self._seen[channel] = channel.version
        return channel.since(seen) if channel.version > seen else []
