"""Passes the robot's reports on to subscribers; no subscriber can delay the driver.

:meth:`Reports.subscribe` gives each reader a queue of its own. :meth:`Reports.hand_to` passes each
report on at once, for a reader that must miss none, such as one that assembles a laser's sweep.
"""

import asyncio
import logging
from collections import deque
from collections.abc import AsyncGenerator, Callable, Iterator
from contextlib import contextmanager
from typing import Generic, TypeVar

from pioneer3.arcos.reports import Report

log = logging.getLogger(__name__)

R = TypeVar("R", bound=Report)
Taker = Callable[[Report, float], None]

RATE_WINDOW = 1.0
ROOM = 1000
"""Most reports that wait for a slow reader: ten seconds at 115200 baud."""


class ReportSubscription(Generic[R]):
    """The reports of some kinds, in order, from the subscription on; `async for` yields them.

    A reader that is too slow has `missed` some, always the oldest.
    """

    def __init__(self, room: int) -> None:
        self.missed = 0
        self._waiting: deque[R] = deque()
        self._room = room
        self._came = asyncio.Event()
        self._closed = False

    def put(self, report: R) -> None:
        """Append `report` to the queue; a full queue drops the oldest."""
        if len(self._waiting) == self._room:
            self._waiting.popleft()
            self.missed += 1
        self._waiting.append(report)
        self._came.set()

    def close(self) -> None:
        """End the iteration, after the reports that still wait."""
        self._closed = True
        self._came.set()

    async def __aiter__(self) -> AsyncGenerator[R, None]:
        while self._waiting or not self._closed:
            if self._waiting:
                yield self._waiting.popleft()
                continue
            self._came.clear()
            await self._came.wait()


class ArrivalRate:
    """Counts arrivals in the last second."""

    def __init__(self) -> None:
        self._stamps: deque[float] = deque()

    def add(self, now: float) -> None:
        """Take an arrival at `now` [s]."""
        self._stamps.append(now)
        self.at(now)

    def at(self, now: float) -> float:
        """Return the arrivals in the second before `now` [1/s]."""
        while self._stamps and now - self._stamps[0] >= RATE_WINDOW:
            self._stamps.popleft()
        return len(self._stamps) / RATE_WINDOW


class Reports:
    """Distributes every report of every session, by its class."""

    def __init__(self) -> None:
        self._takers: dict[type[Report], tuple[Taker, ...]] = {}
        self._closers: list[Callable[[], None]] = []
        self._closed = False

    @contextmanager
    def subscribe(self, *kinds: type[R], room: int = ROOM) -> Iterator[ReportSubscription[R]]:
        """Keep the reports of `kinds` for the block to read, the newest `room` of them."""
        subscription = ReportSubscription[R](room)

        def put(report: Report, stamp: float) -> None:
            assert isinstance(report, kinds)
            subscription.put(report)

        if self._closed:
            subscription.close()
        self._closers.append(subscription.close)
        end = self.hand_to(put, *kinds)
        try:
            yield subscription
        finally:
            end()
            self._closers.remove(subscription.close)

    def hand_to(self, taker: Taker, *kinds: type[Report]) -> Callable[[], None]:
        """Call `taker` with each report of `kinds` and its stamp [s]; return a function to end it.

        `taker` is called between two reads of the link: it must be quick.
        """
        for kind in kinds:
            self._takers[kind] = (*self._takers.get(kind, ()), taker)

        def end() -> None:
            for kind in kinds:
                self._takers[kind] = tuple(t for t in self._takers[kind] if t is not taker)

        return end

    def publish(self, report: Report, stamp: float) -> None:
        """Pass `report`, received at `stamp` [s], to the subscribers of its class."""
        for taker in self._takers.get(type(report), ()):
            try:
                taker(report, stamp)
            except Exception:
                log.exception("a subscriber failed on %s", type(report).__name__)

    def close(self) -> None:
        """End every subscription: no report will come any more."""
        self._closed = True
        for close in self._closers:
            close()
