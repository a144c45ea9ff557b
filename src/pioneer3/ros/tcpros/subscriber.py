"""A subscription to a topic of ROS 1: a connection to each of its publishers."""

import asyncio
import logging
from asyncio import FIRST_COMPLETED
from collections.abc import Awaitable, Callable, Iterable
from dataclasses import dataclass
from functools import partial
from socket import gaierror
from typing import Final

from pioneer3.ros.tcpros.framing import PATIENCE, FrameReader, header_frame, parse_header, prepare
from pioneer3.ros.tcpros.master import connect_by
from pioneer3.ros.tcpros.publisher import ANY
from pioneer3.ros.tcpros.types import Definition

FIRST_PAUSE: Final = 0.2
LONGEST_PAUSE: Final = 5.0
"""Between two attempts to connect to a publisher [s]."""
log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True, eq=False)
class PublisherConnection:
    """A connection to a publisher on a node, whose address a program that starts again has not.

    A bridge passes on messages of another network. The first message may be old where the topic is
    latched, and the publisher was there before this subscription, or the connection broke.
    """

    node: str
    is_bridge: bool = False
    is_latched: bool = False
    maybe_old: bool = False
    uri: str = ""


Received = Callable[[bytes, PublisherConnection, bool], None]
"""Given a serialized message, its connection, and whether it may be old."""
Left = Callable[[PublisherConnection], None]
"""Given a connection that has ended."""
Locate = Callable[[str, str], Awaitable[tuple[str, int]]]
"""Given the address of a publisher's node and the topic, returns host and port of the topic."""
BRIDGE_FIELD: Final = "bridge"
"""Field in the headers of publishers that pass on messages of another network."""


class TopicSubscription:
    """Connects to the publishers that the master names, for `caller`, our node.

    `locate` finds topics of nodes; `received` and `left` are called in the loop; `tell` is given
    sentences for a person. Of messages that come together the newest `queue` count, `None` for all.
    """

    def __init__(
        self,
        name: str,
        type_: Definition,
        caller: str,
        *,
        locate: Locate,
        received: Received,
        left: Left,
        tell: Callable[[str], None],
        queue: int | None = None,
    ) -> None:
        self.name, self.type, self._queue = name, type_, queue
        self._caller, self._locate, self._tell = caller, locate, tell
        self._received, self._left = received, left
        self._following: dict[str, asyncio.Task[None]] = {}
        self._connected: dict[str, PublisherConnection] = {}
        self._wanted: set[str] = set()
        self._told: set[str] = set()

    def update(self, publishers: Iterable[str], *, at_start: bool = False) -> None:
        """Connect to the publishers that the master knows, by the addresses of their nodes.

        Others that are connected stay so until they leave: a new master does not know them.
        `at_start` says that these were there before this subscription.
        """
        wanted = set(publishers)
        if at_start:  # news may have come before this reply of the master
            wanted |= self._wanted
        for uri in self._following.keys() - wanted - self._connected.keys():
            self._following.pop(uri).cancel()
        self._wanted = wanted
        for uri in wanted - self._following.keys():
            follow = self._follow(uri, was_there=at_start)
            self._following[uri] = asyncio.create_task(follow)

    @property
    def matched(self) -> bool:
        """Whether anybody publishes."""
        return bool(self._connected)

    @property
    def publishers(self) -> Iterable[str]:
        """The addresses of the nodes that are connected."""
        return self._connected.keys()

    def close(self) -> None:
        """Receive no more."""
        self._wanted.clear()
        for task in self._following.values():
            task.cancel()

    async def _follow(self, uri: str, *, was_there: bool) -> None:
        """Receive from a publisher; connect again whenever the connection ends."""
        pause = FIRST_PAUSE
        while uri in self._wanted:
            try:
                await self._receive(uri, was_there=was_there)
                pause = FIRST_PAUSE
            except (OSError, EOFError, ValueError) as error:
                log.debug("%s of %s: %s", self.name, uri, error)
                if isinstance(error, gaierror):
                    self._tell_once(
                        uri,
                        f"a publisher of ROS 1 {self.name} at {uri} CANNOT BE REACHED: this"
                        " computer does not know that name; set ROS_IP there, or /etc/hosts here",
                    )
            except Exception:
                log.exception("a message on %s of %s", self.name, uri)
            was_there = True
            await asyncio.sleep(pause)
            pause = min(2 * pause, LONGEST_PAUSE)
        self._following.pop(uri, None)

    async def _receive(self, uri: str, *, was_there: bool) -> None:
        """Receive from a publisher until the connection ends."""
        host, port = await self._locate(uri, self.name)
        incoming = _Incoming(partial(self._begin, uri, was_there=was_there))
        opening = partial(asyncio.get_running_loop().create_connection, lambda: incoming)
        transport, _ = await connect_by(opening, host, port)
        try:
            prepare(transport)
            fields = {
                "callerid": self._caller,
                "md5sum": self.type.md5sum,
                "message_definition": self.type.text,
                "tcp_nodelay": "1",
                "topic": self.name,
                "type": self.type.name,
            }
            transport.write(header_frame(fields))
            async with asyncio.timeout(PATIENCE):
                await asyncio.wait({incoming.begun, incoming.ended}, return_when=FIRST_COMPLETED)
            await incoming.ended
        finally:
            transport.close()
            if (connection := self._connected.pop(uri, None)) is not None:
                self._left(connection)

    def _begin(self, uri: str, data: bytes, *, was_there: bool) -> Callable[[list[bytes]], None]:
        """Return the function that takes messages of a publisher; ValueError for another type."""
        header = parse_header(data)
        if not self._fits(header, uri):
            raise ValueError(f"{uri} does not publish {self.type.name}")
        latched = header.get("latching") == "1"
        node, old = header.get("callerid", ""), was_there and latched
        connection = PublisherConnection(node, BRIDGE_FIELD in header, latched, old, uri)
        self._connected[uri] = connection

        def take(several: list[bytes]) -> None:
            nonlocal old
            for message in several if self._queue is None else several[-self._queue :]:
                self._received(message, connection, old)
                old = False

        return take

    def _fits(self, header: dict[str, str], uri: str) -> bool:
        """Return whether a publisher has our type; tell once if not."""
        problem = header.get("error", "")
        if header.get("md5sum") not in {ANY, self.type.md5sum}:
            theirs = header.get("type", "another type")
            problem = problem or f"it is published as {theirs}"
        if problem:
            self._tell_once(
                uri, f"ROS 1 {self.name} is IGNORED: it must be {self.type.name}, but {problem}"
            )
        return not problem

    def _tell_once(self, uri: str, sentence: str) -> None:
        if uri not in self._told:
            self._told.add(uri)
            self._tell(sentence)


class _Incoming(asyncio.Protocol):
    """The connection to a publisher, whose messages need no task; `begin` is given its header."""

    def __init__(self, begin: Callable[[bytes], Callable[[list[bytes]], None]]) -> None:
        loop = asyncio.get_running_loop()
        self.begun: asyncio.Future[None] = loop.create_future()
        self.ended: asyncio.Future[None] = loop.create_future()
        self._begin, self._frames = begin, FrameReader()
        self._take: Callable[[list[bytes]], None] | None = None

    def data_received(self, data: bytes) -> None:
        """Take bytes; what is wrong with them ends the connection."""
        if self.ended.done():
            return
        try:
            several = self._frames.of(data)
            if self._take is None and several:
                self._take = self._begin(several.pop(0))
                self.begun.set_result(None)
            if self._take is not None and several:
                self._take(several)
        except Exception as error:  # told by who waits for the end
            self.ended.set_exception(error)

    def connection_lost(self, exc: Exception | None) -> None:
        """Tell of the end."""
        if not self.ended.done():
            self.ended.set_result(None)
