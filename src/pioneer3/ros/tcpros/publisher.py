"""A publisher on a topic of ROS 1."""

import asyncio
import threading
from collections import deque
from collections.abc import Iterator, Mapping
from contextlib import suppress
from typing import Final

from pioneer3.ros.tcpros.framing import LENGTH, framed, header_frame
from pioneer3.ros.tcpros.types import Definition
from pioneer3.tasks import hand_over

QUEUE: Final = 10
"""Messages that wait for a slow subscriber; the newest stay."""
ANY: Final = "*"
"""The md5sum or type of subscribers that take all."""
FLUSHING: Final = 0.2
"""Longest wait for messages to be on their way [s]."""
LOOK: Final = 0.005


class TopicPublisher:
    """Sends messages to all who subscribe; a slow one holds up nobody.

    If `latched`, new subscribers get the last message; `extra` are further fields of the header. Of
    `queue` messages that wait for a subscriber the newest stay. The `loop` runs in a `thread`.
    """

    def __init__(
        self,
        name: str,
        type_: Definition,
        *,
        latched: bool,
        queue: int,
        extra: Mapping[str, str],
        loop: asyncio.AbstractEventLoop,
        thread: int,
    ) -> None:
        self.name, self.type, self.latched = name, type_, latched
        self._queue, self._extra = queue, extra
        self._loop, self._thread = loop, thread
        self._number = 0
        self._last: bytes | None = None
        self._outlets: set[_Outlet] = set()

    @property
    def matched(self) -> bool:
        """Whether anybody subscribes."""
        return bool(self._outlets)

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names of the nodes that subscribe."""
        return iter([outlet.node for outlet in self._outlets])

    def write(self, data: bytes) -> None:
        """Send a serialized message, whose header gets a number; in any thread."""
        if threading.get_ident() != self._thread:
            hand_over(self._loop, self.write, data)
            return
        if self.type.is_stamped:
            self._number = (self._number + 1) % (1 << 32)
            data = LENGTH.pack(self._number) + data[LENGTH.size :]
        frame = framed(data)
        if self.latched:
            self._last = frame
        for outlet in self._outlets:
            outlet.send(frame)

    async def flush(self) -> None:
        """Return when all messages are on their way, or after a short time."""
        with suppress(TimeoutError):
            async with asyncio.timeout(FLUSHING):
                while not all(each.is_empty for each in self._outlets):  # noqa: ASYNC110
                    await asyncio.sleep(LOOK)

    def refusal(self, header: Mapping[str, str]) -> str:
        """Return the reason not to serve a subscriber with this header; empty for none."""
        theirs, md5sum = header.get("type", ANY), header.get("md5sum", "")
        if md5sum not in {ANY, self.type.md5sum}:
            return (
                f"topic types do not match: [{theirs}] vs. [{self.type.name}]: {self.name} is of"
                f" {self.type.name}, md5sum {self.type.md5sum}"
            )
        return ""

    async def serve(self, writer: asyncio.StreamWriter, caller: str, node: str) -> None:
        """Send to a subscriber on a node until it leaves."""
        fields = {
            "callerid": caller,
            "latching": "1" if self.latched else "0",
            "md5sum": self.type.md5sum,
            "message_definition": self.type.text,
            "topic": self.name,
            "type": self.type.name,
            **self._extra,
        }
        writer.write(header_frame(fields))
        outlet = _Outlet(writer, node, self._queue)
        if self._last is not None:
            outlet.send(self._last)
        self._outlets.add(outlet)
        try:
            await outlet.run()
        finally:
            self._outlets.discard(outlet)


class _Outlet:
    """The connection to a subscriber: what the system does not take at once waits here."""

    def __init__(self, writer: asyncio.StreamWriter, node: str, queue: int) -> None:
        self.node = node
        self._writer, self._transport = writer, writer.transport
        self._waiting: deque[bytes] = deque(maxlen=queue)
        self._is_blocked, self._blocked = False, asyncio.Event()
        writer.transport.set_write_buffer_limits(high=0)  # so that `drain` waits for all

    @property
    def is_empty(self) -> bool:
        """Whether nothing waits."""
        return not self._waiting and not self._transport.get_write_buffer_size()

    def send(self, frame: bytes) -> None:
        """Send a frame as soon as possible."""
        if self._is_blocked:
            self._waiting.append(frame)
        elif not self._transport.is_closing():
            self._transport.write(frame)
            if self._transport.get_write_buffer_size():
                self._is_blocked = True
                self._blocked.set()

    async def run(self) -> None:
        """Send what waits until the subscriber is gone."""
        while not self._writer.is_closing():
            await self._blocked.wait()
            await self._writer.drain()
            while self._waiting:
                self._writer.write(self._waiting.popleft())
                await self._writer.drain()
            self._blocked.clear()
            self._is_blocked = False
