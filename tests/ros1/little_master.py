"""A master of ROS 1 in this process, as far as topics, services and the graph go."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from socket import SHUT_RDWR
from socketserver import ThreadingMixIn
from typing import Any
from xmlrpc.client import ServerProxy
from xmlrpc.server import SimpleXMLRPCServer

from pioneer3.ros.addresses import LOCAL, Addresses

Registered = dict[str, dict[str, str]]


@dataclass
class LittleMaster:
    """A master.

    Attributes:
        uri: Its address.
        publishers: Addresses of nodes by name, by topic.
        subscribers: The same.
        services: Addresses by name.
        nodes: Addresses by name.
        parameters: Values by full name, without folders.
        turn: Held by who is answered; a test that holds it has the master hang.
    """

    uri: str
    publishers: Registered = field(default_factory=dict)
    subscribers: Registered = field(default_factory=dict)
    services: dict[str, str] = field(default_factory=dict)
    nodes: dict[str, str] = field(default_factory=dict)
    parameters: dict[str, Any] = field(default_factory=dict)
    turn: threading.RLock = field(default_factory=threading.RLock)

    @property
    def at(self) -> Addresses:
        return Addresses(master=self.uri, host=LOCAL, bind=LOCAL)

    def registerPublisher(self, caller: str, topic: str, kind: str, uri: str) -> list[Any]:  # noqa: N802
        self.nodes[caller] = uri
        self.publishers.setdefault(topic, {})[caller] = uri
        self._tell(topic)
        return [1, "", list(self.subscribers.get(topic, {}).values())]

    def unregisterPublisher(self, caller: str, topic: str, uri: str) -> list[Any]:  # noqa: N802
        self.publishers.get(topic, {}).pop(caller, None)
        self._tell(topic)
        return [1, "", 1]

    def registerSubscriber(self, caller: str, topic: str, kind: str, uri: str) -> list[Any]:  # noqa: N802
        self.nodes[caller] = uri
        self.subscribers.setdefault(topic, {})[caller] = uri
        return [1, "", list(self.publishers.get(topic, {}).values())]

    def unregisterSubscriber(self, caller: str, topic: str, uri: str) -> list[Any]:  # noqa: N802
        self.subscribers.get(topic, {}).pop(caller, None)
        return [1, "", 1]

    def registerService(self, caller: str, name: str, service: str, uri: str) -> list[Any]:  # noqa: N802
        self.nodes[caller] = uri
        self.services[name] = service
        return [1, "", 1]

    def unregisterService(self, caller: str, name: str, service: str) -> list[Any]:  # noqa: N802
        self.services.pop(name, None)
        return [1, "", 1]

    def lookupService(self, caller: str, name: str) -> list[Any]:  # noqa: N802
        return [1, "", self.services[name]] if name in self.services else [-1, "no service", ""]

    def lookupNode(self, caller: str, name: str) -> list[Any]:  # noqa: N802
        return [1, "", self.nodes[name]] if name in self.nodes else [-1, "unknown node", ""]

    def getSystemState(self, caller: str) -> list[Any]:  # noqa: N802
        def rows(registered: Registered) -> list[Any]:
            return [[topic, list(nodes)] for topic, nodes in registered.items() if nodes]

        return [1, "", [rows(self.publishers), rows(self.subscribers), []]]

    def getParam(self, caller: str, name: str) -> list[Any]:  # noqa: N802
        if name not in self.parameters:
            return [-1, f"Parameter [{name}] is not set", 0]
        return [1, "", self.parameters[name]]

    def setParam(self, caller: str, name: str, value: Any) -> list[Any]:  # noqa: N802
        self.parameters[name] = value
        return [1, "", 0]

    def _tell(self, topic: str) -> None:
        for uri in list(self.subscribers.get(topic, {}).values()):
            with ServerProxy(uri) as node:
                node.publisherUpdate("/master", topic, list(self.publishers[topic].values()))


class _Server(ThreadingMixIn, SimpleXMLRPCServer):
    """Serves each connection in a thread, and ends them all when it ends, as `rosmaster` does."""

    daemon_threads = True
    block_on_close = False

    def __init__(self, port: int) -> None:
        self._open: set[Any] = set()
        super().__init__((LOCAL, port), logRequests=False, allow_none=True)

    def process_request(self, request: Any, client_address: Any) -> None:
        self._open.add(request)
        super().process_request(request, client_address)

    def shutdown_request(self, request: Any) -> None:
        self._open.discard(request)
        super().shutdown_request(request)

    def _dispatch(self, method: str, params: Any) -> Any:
        assert isinstance(self.instance, LittleMaster)
        with self.instance.turn:
            return super()._dispatch(method, params)

    def server_close(self) -> None:
        super().server_close()
        for request in list(self._open):
            with suppress(OSError):
                request.shutdown(SHUT_RDWR)


@contextmanager
def little_master(port: int = 0) -> Iterator[LittleMaster]:
    """Run a master while the block lasts."""
    with _Server(port) as server:
        master = LittleMaster(f"http://{LOCAL}:{server.server_address[1]}")
        server.register_instance(master)
        thread = threading.Thread(target=server.serve_forever, args=(0.02,), daemon=True)
        thread.start()
        try:
            yield master
        finally:
            server.shutdown()
            thread.join()
