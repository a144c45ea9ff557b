"""A node of ROS 1: its topics and services, registered with the master, whenever that is there."""

import asyncio
import os
from collections.abc import AsyncIterator, Callable, Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import asynccontextmanager, suppress
from functools import partial
from typing import Any, Final
from weakref import WeakValueDictionary

from pioneer3.errors import ConfigError, NoRobotError
from pioneer3.ros.addresses import Addresses, wait_for_master
from pioneer3.ros.tcpros.answers import MasterRefusalError, SystemState
from pioneer3.ros.tcpros.framing import header_frame, prepare, read_header
from pioneer3.ros.tcpros.liveness import Liveness
from pioneer3.ros.tcpros.master import LOST, Api, NodeApi, NodeCalls
from pioneer3.ros.tcpros.publisher import TopicPublisher
from pioneer3.ros.tcpros.services import Handle, ServiceError, ServiceServer, call
from pioneer3.ros.tcpros.subscriber import Left, Received, TopicSubscription
from pioneer3.ros.tcpros.types import Definition
from pioneer3.tasks import cancelled, running

LOOK: Final = 1.0
"""Pause between two looks at the master [s]."""
SERVED: Final = 3.0
"""A service that does not respond within this time [s] hangs."""
WORKERS: Final = 8
"""Calls at once: to the master, to publishers, and to nodes whether they respond, of each."""
CONNECTIONS: Final = 512
"""Connections to topics and services at once; further ones are refused."""
MASTER, PUBLISHERS, NODES = range(3)
SETTLING: Final = 5.0
"""Longest wait for the master at the start [s]."""
ENDING: Final = 2.0
"""Longest wait for the master in the end [s]."""


class Ros1Node:
    """A node; use :func:`ros1_node`.

    Its topics and services are at a port, and its publishers' headers have `extra` fields; `tell`
    is given a sentence when the master goes, and when it is back. `ended` is set when somebody
    shuts the node down; `state` is the graph, `None` while the master is away.
    """

    def __init__(
        self,
        name: str,
        at: Addresses,
        port: int,
        tell: Callable[[str], None],
        extra: Mapping[str, str],
    ) -> None:
        self.name, self.ended = name, asyncio.Event()
        self.state: SystemState | None = None
        self._at, self._port, self._tell, self._extra = at, port, tell, extra
        self._loop = asyncio.get_running_loop()
        # by kind of calls: nobody waits for another's
        names = {MASTER: "ros1 master", PUBLISHERS: "ros1 publishers", NODES: "ros1 nodes"}
        self._workers = {kind: ThreadPoolExecutor(WORKERS, name) for kind, name in names.items()}
        self._located: WeakValueDictionary[str, asyncio.Lock] = WeakValueDictionary()
        self._liveness = Liveness(self.is_alive)
        self._publishers: dict[str, TopicPublisher] = {}
        self._subscriptions: dict[str, TopicSubscription] = {}
        self._services: dict[str, ServiceServer] = {}
        self._registered: set[tuple[str, str]] = set()
        self._news = asyncio.Event()
        self._settled = asyncio.Event()
        self._away = False
        self._master = Api(at.master, name)
        calls = NodeCalls(
            publisher_update=lambda *news: self._soon(self._update, *news),
            topic_address=lambda topic: (at.host, port) if topic in self._publishers else None,
            topics=self._topics,
            shut_down=lambda: self._soon(self.ended.set),
        )
        self._api = NodeApi(at.host, at.bind, at.master, os.getpid(), calls)

    def advertise(self, name: str, type_: Definition, *, latched: bool = False) -> TopicPublisher:
        """Publish on a topic; the same publisher for the same name."""
        if name not in self._publishers:
            made = TopicPublisher(name, type_, latched=latched, extra=self._extra)
            self._publishers[name] = made
            self._change()
        return self._publishers[name]

    def subscribe(
        self, name: str, type_: Definition, received: Received, left: Left
    ) -> TopicSubscription:
        """Subscribe to a topic, once; the functions are called in the loop."""
        subscription = self._subscriptions[name] = TopicSubscription(
            name,
            type_,
            self.name,
            locate=self._locate,
            received=received,
            left=left,
            tell=self._tell,
        )
        self._change()
        return subscription

    async def unsubscribe(self, name: str) -> None:
        """Receive messages of a topic no more."""
        if (subscription := self._subscriptions.pop(name, None)) is None:
            return
        await subscription.close()
        if ("subscriber", name) in self._registered:
            self._registered.discard(("subscriber", name))
            with suppress(*LOST, MasterRefusalError):
                await self._ask(self._master, "unregisterSubscriber", name, self._api.uri)

    def serve(self, name: str, type_: Definition, handle: Handle) -> None:
        """Offer a service."""
        self._services[name] = ServiceServer(name, type_, handle)
        self._change()

    async def call(self, name: str, type_: Definition, request: bytes) -> bytes:
        """Call a service; return the response. ServiceError if it has failed, or is not there."""
        try:
            async with asyncio.timeout(SERVED):
                uri = str(await self._ask(self._master, "lookupService", name))
                return await call(uri, name, type_, self.name, request)
        except TimeoutError:
            raise ServiceError(f"{name} has not responded within {SERVED:g} s") from None
        except (*LOST, MasterRefusalError, EOFError, ValueError) as error:
            raise ServiceError(f"{name} cannot be called in ROS 1: {error}") from error

    async def settle(self) -> None:
        """Return when the master knows everything, and its graph is here, or after a while."""
        with suppress(TimeoutError):
            async with asyncio.timeout(SETTLING):
                await self._settled.wait()

    async def is_alive(self, node: str) -> bool:
        """Return whether a node responds: one that was killed stays registered."""
        try:
            uri = str(await self._ask(self._master, "lookupNode", node))
            await self._ask(Api(uri, self.name), "getPid", kind=NODES)
        except (*LOST, MasterRefusalError):
            return False
        return True

    async def alive_among(self, nodes: Iterable[str]) -> set[str]:
        """Return the nodes that respond; one that hangs counts until it is found out."""
        return await self._liveness.among(nodes)

    async def refuse_double(self) -> None:
        """Raise ConfigError if another node has our name: the master would end that one."""
        try:
            uri = str(await self._ask(self._master, "lookupNode", self.name))
            if uri != self._api.uri:
                await self._ask(Api(uri, self.name), "getPid", kind=NODES)
        except (*LOST, MasterRefusalError):
            return
        raise ConfigError(
            f"a node {self.name} is on the ROS master already, at {uri}: end it, or take another"
            " --name"
        )

    async def run(self) -> None:
        """Register with the master, and again with the one that follows it, for ever."""
        while True:
            self._news.clear()
            if await self._look() and not self._news.is_set():
                self._settled.set()
            with suppress(TimeoutError):
                async with asyncio.timeout(LOOK):
                    await self._news.wait()

    async def close(self) -> None:
        """Send what waits, and leave."""
        await asyncio.gather(*(each.flush() for each in self._publishers.values()))
        await self._liveness.close()
        for subscription in self._subscriptions.values():
            await subscription.close()
        with suppress(TimeoutError, *LOST, MasterRefusalError):
            async with asyncio.timeout(ENDING):
                if not self._away:
                    await self._unregister()
        await asyncio.to_thread(self._api.close)
        for workers in self._workers.values():
            workers.shutdown(wait=False, cancel_futures=True)

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
                await topic.serve(writer, self.name)
        except (OSError, EOFError, ValueError):
            return
        finally:
            writer.close()

    def _change(self) -> None:
        """Have the master told of something new."""
        self._news.set()
        self._settled.clear()

    async def _look(self) -> bool:
        """See to it that the master knows all of us; keep the graph; return whether it is there."""
        try:
            if self._registered and not await self._is_known():
                self._registered.clear()
            await self._register()
            state = await self._ask(self._master, "getSystemState")
        except (*LOST, MasterRefusalError) as error:
            self.state = None
            if not self._away:
                self._away = True
                self._tell(
                    f"ROS 1 MASTER LOST at {self._at.master} ({error}): connections last, new ones"
                    " wait; registers again when it is back"
                )
            return False
        self.state = SystemState(dict(state[0]), dict(state[1]))
        if self._away:
            self._away = False
            self._tell("the ROS 1 master is back; registered with it")
        return True

    async def _is_known(self) -> bool:
        try:
            return bool(await self._ask(self._master, "lookupNode", self.name) == self._api.uri)
        except MasterRefusalError:
            return False

    async def _register(self) -> None:
        uri = self._api.uri
        for name, service in list(self._services.items()):
            if ("service", name) not in self._registered:
                at = f"rosrpc://{self._at.host}:{self._port}"
                await self._ask(self._master, "registerService", service.name, at, uri)
                self._registered.add(("service", name))
        for name, topic in list(self._publishers.items()):
            if ("publisher", name) not in self._registered:
                await self._ask(self._master, "registerPublisher", name, topic.type.name, uri)
                self._registered.add(("publisher", name))
        for name, subscription in list(self._subscriptions.items()):
            if ("subscriber", name) not in self._registered:
                type_name = subscription.type.name
                there = await self._ask(self._master, "registerSubscriber", name, type_name, uri)
                self._registered.add(("subscriber", name))
                self._update(name, there, at_start=True)

    async def _unregister(self) -> None:
        uri = self._api.uri
        for kind, name in self._registered:
            if kind == "service":
                at = f"rosrpc://{self._at.host}:{self._port}"
                await self._ask(self._master, "unregisterService", name, at)
            else:
                await self._ask(self._master, f"unregister{kind.title()}", name, uri)

    def _update(self, topic: str, publishers: list[str], *, at_start: bool = False) -> None:
        """Take news about the publishers of a topic; we do not subscribe to ourselves."""
        if topic in self._subscriptions:
            others = [uri for uri in publishers if uri != self._api.uri]
            self._subscriptions[topic].update(others, at_start=at_start)

    async def _locate(self, uri: str, topic: str) -> tuple[str, int]:
        try:
            lock = self._located.setdefault(uri, asyncio.Lock())
            async with lock:  # a node that hangs holds up its own topics only
                api, how = Api(uri, self.name), [["TCPROS"]]
                found = await self._ask(api, "requestTopic", topic, how, kind=PUBLISHERS)
            return found[1], found[2]
        except LOST as error:
            raise ValueError(f"{uri} does not respond: {error}") from error

    async def _ask(self, api: Api, method: str, *arguments: object, kind: int = MASTER) -> Any:
        ask = partial(api.call, method, *arguments)
        return await self._loop.run_in_executor(self._workers[kind], ask)

    def _topics(self) -> tuple[list[list[str]], list[list[str]]]:
        return (
            [[name, each.type.name] for name, each in list(self._publishers.items())],
            [[name, each.type.name] for name, each in list(self._subscriptions.items())],
        )

    def _soon(self, act: Callable[..., object], *arguments: object) -> None:
        with suppress(RuntimeError):  # the loop has ended
            self._loop.call_soon_threadsafe(act, *arguments)


@asynccontextmanager
async def ros1_node(
    name: str, at: Addresses, tell: Callable[[str], None], extra: Mapping[str, str] | None = None
) -> AsyncIterator[Ros1Node]:
    """Be a node of ROS 1 while the block lasts; it begins when the master is there.

    The parameters are those of :class:`Ros1Node`.

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
    except OSError as error:
        raise NoRobotError(f"cannot listen on {at.bind}: {error}; set ROS_IP") from error
    node = Ros1Node(name, at, int(server.sockets[0].getsockname()[1]), tell, extra or {})
    nodes.append(node)
    try:
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
