"""A node of ROS 1: its topics and services, registered with the master, whenever that is there."""

import asyncio
import os
import threading
from collections.abc import AsyncIterator, Awaitable, Callable, Iterable, Mapping
from contextlib import asynccontextmanager, suppress
from math import inf
from typing import Any, Final
from weakref import WeakValueDictionary

from pioneer3.errors import ConfigError, NoRobotError
from pioneer3.ros.addresses import Addresses, wait_for_master
from pioneer3.ros.tcpros.answers import MasterRefusalError, SystemState
from pioneer3.ros.tcpros.framing import header_frame, prepare, read_header
from pioneer3.ros.tcpros.liveness import Liveness
from pioneer3.ros.tcpros.master import LOST, Api, NodeApi
from pioneer3.ros.tcpros.publisher import QUEUE, TopicPublisher
from pioneer3.ros.tcpros.services import Handle, ServiceError, ServiceServer, call
from pioneer3.ros.tcpros.subscriber import Left, Received, TopicSubscription
from pioneer3.ros.tcpros.types import Definition
from pioneer3.tasks import cancelled, hand_over, running

LOOK: Final = 10.0
"""Pause between two looks at the master [s]; each costs it, and the node, a millisecond. That it
has ended, or is back, a connection to it tells at once."""
GRAPH_LOOK: Final = 1.0
"""Pause where the graph is kept [s]."""
SURVEY: Final = 9.0
"""Pause between two looks at our parameters [s]."""
AGAIN: Final = 3.0
"""Pause between two attempts to be connected to the master, and two looks while it is away [s]."""
SERVED: Final = 3.0
"""A service that does not respond within this time [s] hangs."""
CONNECTIONS: Final = 512
"""Connections to topics and services at once; further ones are refused."""
SETTLING: Final = 5.0
"""Longest wait for the master at the start [s]."""
ENDING: Final = 2.0
"""Longest wait for the master in the end [s]."""


class Ros1Node:
    """A node; use :func:`ros1_node`. Others subscribe and call in the loop, you in any thread.

    Its topics and services are at a port, and its publishers' headers have `extra` fields; `tell`
    is given a sentence when the master goes, and when it is back; then `on_registered` is awaited.
    `ended` is set, and `on_shutdown` called, when somebody shuts the node down. With `graph` its
    `state` is that of the master, `None` while that is away. `master` is called for all else.
    """

    def __init__(
        self,
        name: str,
        at: Addresses,
        port: int,
        tell: Callable[[str], None],
        extra: Mapping[str, str],
        *,
        graph: bool,
    ) -> None:
        self.name, self.ended = name, asyncio.Event()
        self.state: SystemState | None = None
        self.master = Api(at.master, name)
        self.on_registered: Callable[[], Awaitable[object]] | None = None
        self.on_shutdown: list[Callable[[], None]] = []
        self._at, self._port, self._tell, self._extra = at, port, tell, extra
        self._keeps_graph = graph
        self._loop, self._thread = asyncio.get_running_loop(), threading.get_ident()
        self._located: WeakValueDictionary[str, asyncio.Lock] = WeakValueDictionary()
        self._liveness = Liveness(self.is_alive)
        self._publishers: dict[str, TopicPublisher] = {}
        self._subscriptions: dict[str, list[TopicSubscription]] = {}
        self._services: dict[str, ServiceServer] = {}
        self._registered: set[tuple[str, str]] = set()
        self._parameters: object = None
        self._surveyed_at = -inf
        self._is_new = False
        self._news = asyncio.Event()
        self._settled = asyncio.Event()
        self._away = False
        self._api = NodeApi(at.host, at.bind, self._answers())

    def advertise(
        self, name: str, type_: Definition, *, latched: bool = False, queue: int = QUEUE
    ) -> TopicPublisher:
        """Publish on a topic; the same publisher for the same name.

        Of `queue` messages that wait for a subscriber the newest stay.
        """
        if name not in self._publishers:
            self._publishers[name] = TopicPublisher(
                name,
                type_,
                latched=latched,
                queue=queue,
                extra=self._extra,
                loop=self._loop,
                thread=self._thread,
            )
            self._change()
        return self._publishers[name]

    def subscribe(
        self,
        name: str,
        type_: Definition,
        received: Received,
        left: Left,
        queue: int | None = None,
    ) -> TopicSubscription:
        """Subscribe to a topic; the functions are called in the loop.

        Of messages that come together the newest `queue` count, `None` for all.
        """
        subscription = TopicSubscription(
            name,
            type_,
            self.name,
            locate=self._locate,
            received=received,
            left=left,
            tell=self._tell,
            queue=queue,
        )
        self._subscriptions.setdefault(name, []).append(subscription)
        self._registered.discard(("subscriber", name))  # once more, for its publishers
        self._change()
        return subscription

    def unsubscribe(self, subscription: TopicSubscription) -> None:
        """Receive messages of a subscription no more."""
        several = self._subscriptions.get(subscription.name, [])
        if subscription in several:
            several.remove(subscription)
            subscription.close()
            if not several:
                del self._subscriptions[subscription.name]
                self._change()

    def serve(self, name: str, type_: Definition, handle: Handle) -> None:
        """Offer a service."""
        self._services[name] = ServiceServer(name, type_, handle)
        self._change()

    def has(self, name: str) -> bool:
        """Return whether a topic or service of this name is here."""
        return any(name in each for each in (self._publishers, self._subscriptions, self._services))

    async def call(self, name: str, type_: Definition, request: bytes) -> bytes:
        """Call a service; return the response. ServiceError if it has failed, or is not there."""
        try:
            async with asyncio.timeout(SERVED):
                uri = str(await self.master.call("lookupService", name))
                return await call(uri, name, type_, self.name, request)
        except TimeoutError:
            raise ServiceError(f"{name} has not responded within {SERVED:g} s") from None
        except (*LOST, MasterRefusalError, ValueError) as error:
            raise ServiceError(f"{name} cannot be called in ROS 1: {error}") from error

    async def get(self, name: str, otherwise: Any = None) -> Any:
        """Return a parameter, or `otherwise`; errors as of :meth:`Api.call`."""
        try:
            return await self.master.call("getParam", name)
        except MasterRefusalError:
            return otherwise

    async def settle(self) -> None:
        """Return when the master knows everything, and its graph is here, or after a while."""
        with suppress(TimeoutError):
            async with asyncio.timeout(SETTLING):
                await self._settled.wait()

    async def is_alive(self, node: str) -> bool:
        """Return whether a node responds: one that was killed stays registered."""
        try:
            uri = str(await self.master.call("lookupNode", node))
            await Api(uri, self.name).call("getPid")
        except (*LOST, MasterRefusalError):
            return False
        return True

    async def alive_among(self, nodes: Iterable[str]) -> set[str]:
        """Return the nodes that respond; one that hangs counts until it is found out."""
        return await self._liveness.among(nodes)

    async def refuse_double(self) -> None:
        """Raise ConfigError if another node has our name: the master would end that one."""
        try:
            uri = str(await self.master.call("lookupNode", self.name))
            if uri != self._api.uri:
                await Api(uri, self.name).call("getPid")
        except (*LOST, MasterRefusalError):
            return
        raise ConfigError(
            f"a node {self.name} is on the ROS master already, at {uri}: end it, or take another"
            " --name"
        )

    async def run(self) -> None:
        """Register with the master, and again with the one that follows it, for ever."""
        async with running(self._watch()):
            while True:
                self._news.clear()
                if await self._look() and not self._news.is_set():
                    self._settled.set()
                pause = AGAIN if self._away else LOOK
                with suppress(TimeoutError):
                    async with asyncio.timeout(GRAPH_LOOK if self._keeps_graph else pause):
                        await self._news.wait()

    async def open(self) -> None:
        """Let others call this node; OSError where it cannot listen."""
        await self._api.open()

    async def close(self) -> None:
        """Send what waits, and leave."""
        await asyncio.gather(*(each.flush() for each in self._publishers.values()))
        await self._liveness.close()
        for several in list(self._subscriptions.values()):
            for subscription in several:
                subscription.close()
        with suppress(TimeoutError, *LOST, MasterRefusalError):
            async with asyncio.timeout(ENDING):
                if not self._away:
                    await self._unregister()
        await self._api.close()

    async def take(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Serve a subscriber, or a client of a service, until it leaves."""
        try:
            prepare(writer)
            header = await read_header(reader)
            if (service := self._services.get(header.get("service", ""))) is not None:
                await service.serve(header, reader, writer, self.name)
                return
            topic = self._publishers.get(header.get("topic", ""))
            refusal = topic.refusal(header) if topic else "nothing of this name is here"
            if topic is None or refusal:
                writer.write(header_frame({"error": refusal}))
                return
            async with running(_until_closed(reader)):
                await topic.serve(writer, self.name, header.get("callerid", ""))
        except (OSError, EOFError, ValueError):
            return
        finally:
            writer.close()

    def _change(self) -> None:
        """Have the master told of something new, in any thread."""
        self._settled.clear()
        hand_over(self._loop, self._news.set)

    async def _watch(self) -> None:
        """Have the master looked at when a connection to it begins, and when it ends."""
        while True:
            with suppress(*LOST):
                reader, writer = await self.master.connect()
                self._news.set()
                try:
                    await _until_closed(reader)
                finally:
                    writer.close()
                    self._news.set()
            await asyncio.sleep(AGAIN)

    async def _look(self) -> bool:
        """See to it that the master knows all of us; keep the graph; return whether it is there."""
        try:
            await self._see_to_registration()
            if self._keeps_graph:
                publishers, subscribers, *_ = await self.master.call("getSystemState")
                self.state = SystemState(dict(publishers), dict(subscribers))
        except (*LOST, MasterRefusalError) as error:
            self.state = None
            if not self._away:
                self._away = True
                self._tell(
                    f"ROS MASTER LOST at {self._at.master} ({error}): connections last, new ones"
                    " wait; registers again when it is back"
                )
            return False
        if self._away:
            self._away = False
            self._tell("the ROS master is back; registered with it")
        return True

    async def _see_to_registration(self) -> None:
        """Register what the master does not know; with a new one all, and our parameters."""
        if self._registered and not await self._is_known():
            self._registered.clear()
            self._is_new = True  # until all is done: half of it would make us known, too
        if self._is_new and self._parameters:
            await self.master.call("setParam", self.name, self._parameters)
        await self._register()
        if self._is_new and self.on_registered is not None:
            await self.on_registered()
        self._is_new = False
        now = self._loop.time()
        if now >= self._surveyed_at + SURVEY:
            self._parameters, self._surveyed_at = await self.get(self.name), now

    async def _is_known(self) -> bool:
        """Return whether the master knows us; another node of our name ends us."""
        try:
            uri = await self.master.call("lookupNode", self.name)
        except MasterRefusalError:
            return False
        if uri != self._api.uri:
            self._shut_down(self.name, "another node has this name")
        return True

    async def _register(self) -> None:
        uri = self._api.uri
        for name, service in list(self._services.items()):
            if ("service", name) not in self._registered:
                at = f"rosrpc://{self._at.host}:{self._port}"
                await self.master.call("registerService", service.name, at, uri)
                self._registered.add(("service", name))
        for name, topic in list(self._publishers.items()):
            if ("publisher", name) not in self._registered:
                await self.master.call("registerPublisher", name, topic.type.name, uri)
                self._registered.add(("publisher", name))
        for name, several in list(self._subscriptions.items()):
            if ("subscriber", name) not in self._registered:
                type_name = several[0].type.name
                there = await self.master.call("registerSubscriber", name, type_name, uri)
                self._registered.add(("subscriber", name))
                self._update(name, there, at_start=True)
        for kind, name in list(self._registered):
            if kind == "subscriber" and name not in self._subscriptions:
                self._registered.discard((kind, name))
                await self.master.call("unregisterSubscriber", name, uri)

    async def _unregister(self) -> None:
        uri = self._api.uri
        for kind, name in self._registered:
            if kind == "service":
                at = f"rosrpc://{self._at.host}:{self._port}"
                await self.master.call("unregisterService", name, at)
            else:
                await self.master.call(f"unregister{kind.title()}", name, uri)

    def _update(self, topic: str, publishers: list[str], *, at_start: bool = False) -> None:
        """Take news about the publishers of a topic; we do not subscribe to ourselves."""
        others = [uri for uri in publishers if uri != self._api.uri]
        for subscription in self._subscriptions.get(topic, ()):
            subscription.update(others, at_start=at_start)

    async def _locate(self, uri: str, topic: str) -> tuple[str, int]:
        lock = self._located.setdefault(uri, asyncio.Lock())
        async with lock:  # a node that hangs is asked once at a time
            found = await Api(uri, self.name).call("requestTopic", topic, [["TCPROS"]])
        return found[1], found[2]

    def _answers(self) -> Mapping[str, Callable[..., object]]:
        """Return the answers of a node by method (http://wiki.ros.org/ROS/Slave_API)."""
        return {
            "publisherUpdate": self._publisher_update,
            "requestTopic": self._request_topic,
            "shutdown": self._shut_down,
            "getPid": lambda caller: os.getpid(),
            "getMasterUri": lambda caller: self._at.master,
            "getPublications": lambda caller: [
                [name, each.type.name] for name, each in list(self._publishers.items())
            ],
            "getSubscriptions": lambda caller: [
                [name, several[0].type.name] for name, several in list(self._subscriptions.items())
            ],
            "getBusInfo": lambda caller: self._connections(),
            "getBusStats": lambda caller: [[], [], []],
            "paramUpdate": lambda caller, name, value: 0,
        }

    def _connections(self) -> list[list[object]]:
        """Return number, other end, direction, transport, topic, whether connected, and words."""
        topics, several = list(self._publishers.values()), list(self._subscriptions.values())
        rows = [("o", topic.name, node) for topic in topics for node in topic]
        rows += [("i", each.name, uri) for of in several for each in of for uri in each.publishers]
        return [
            [number, end, way, "TCPROS", topic, True, f"TCPROS connection of {self._port}"]
            for number, (way, topic, end) in enumerate(rows, start=1)
        ]

    def _publisher_update(self, caller: str, topic: str, publishers: list[str]) -> int:
        if not isinstance(publishers, list) or not all(isinstance(uri, str) for uri in publishers):
            raise TypeError("publishers are a list of addresses")
        self._update(topic, publishers)
        return 0

    def _request_topic(self, caller: str, topic: str, protocols: list[list[str]]) -> list[object]:
        if topic not in self._publishers or not any(each[:1] == ["TCPROS"] for each in protocols):
            raise MasterRefusalError(f"{topic} is not published here over TCPROS")
        return ["TCPROS", self._at.host, self._port]

    def _shut_down(self, caller: str, reason: str = "") -> int:
        self.ended.set()
        for told in self.on_shutdown:
            told()
        return 0


@asynccontextmanager
async def ros1_node(
    name: str,
    at: Addresses,
    tell: Callable[[str], None],
    extra: Mapping[str, str] | None = None,
    *,
    graph: bool = True,
    replaces: bool = False,
) -> AsyncIterator[Ros1Node]:
    """Be a node of ROS 1 while the block lasts; it begins when the master is there.

    The parameters are those of :class:`Ros1Node`. A node that `replaces` takes the place of another
    one of its name, which the master ends.

    Raises:
        ConfigError: another node has this name.
        NoRobotError: this computer does not have the address that it is to listen on.
    """
    nodes: list[Ros1Node] = []
    clients: set[asyncio.Task[None]] = set()

    async def take(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        task = asyncio.current_task()
        assert task is not None
        if len(clients) >= CONNECTIONS:
            writer.close()
            return
        clients.add(task)
        try:
            await nodes[0].take(reader, writer)
        except asyncio.CancelledError:
            return  # the node ends
        finally:
            clients.discard(task)

    await wait_for_master(at.master, tell)
    try:
        server = await asyncio.start_server(take, at.bind, 0)
        port = int(server.sockets[0].getsockname()[1])
        node = Ros1Node(name, at, port, tell, extra or {}, graph=graph)
        await node.open()
    except OSError as error:
        raise NoRobotError(f"cannot listen on {at.bind}: {error}; set ROS_IP") from error
    nodes.append(node)
    try:
        if not replaces:
            await node.refuse_double()
        async with running(node.run()):
            yield node
    finally:
        server.close()
        await node.close()
        await cancelled(clients)


async def _until_closed(reader: asyncio.StreamReader) -> None:
    """Raise EOFError when the other side closes its connection."""
    while await reader.read(1024):
        pass
    raise EOFError
