"""A subscription to a topic of ROS 1: a connection to each of its publishers."""

import asyncio
import logging
from collections.abc import Awaitable, Callable, Iterable
from dataclasses import dataclass
from socket import gaierror
from typing import Final

from pioneer3.ros.tcpros.framing import Frames, header_frame, prepare, read_header
from pioneer3.ros.tcpros.master import connect
from pioneer3.ros.tcpros.publisher import ANY
from pioneer3.ros.tcpros.types import Definition
from pioneer3.tasks import cancelled

FIRST_PAUSE: Final = 0.2
LONGEST_PAUSE: Final = 5.0
"""Between two attempts to connect to a publisher [s]."""
CHUNK: Final = 1 << 16
"""Most that is read at once [bytes]."""
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

    async def close(self) -> None:
        """Receive no more."""
        await cancelled(self._following.values())

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
        reader, writer = await connect(host, port)
        connection = None
        try:
            prepare(writer)
            fields = {
                "callerid": self._caller,
                "md5sum": self.type.md5sum,
                "message_definition": self.type.text,
                "tcp_nodelay": "1",
                "topic": self.name,
                "type": self.type.name,
            }
            writer.write(header_frame(fields))
            header = await read_header(reader)
            if not self._fits(header, uri):
                return
            latched = header.get("latching") == "1"
            connection = PublisherConnection(
                header.get("callerid", ""),
                BRIDGE_FIELD in header,
                latched,
                was_there and latched,
                uri,
            )
            self._connected[uri] = connection
            old, frames = connection.maybe_old, Frames()
            while data := await reader.read(CHUNK):
                several = frames.of(data)
                for message in several if self._queue is None else several[-self._queue :]:
                    self._received(message, connection, old)
                    old = False
        except EOFError:
            return
        finally:
            writer.close()
            if connection is not None:
                self._connected.pop(uri, None)
                self._left(connection)

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
