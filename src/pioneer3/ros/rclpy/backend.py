"""The backend over rclpy, for computers where ROS 2 is installed.

Written by the documentation and source of rclpy, Humble to Lyrical. The middleware of this package
serves parameters, logs and the life cycle itself, so rclpy's own are off.
"""

import logging
import os
import sys
import threading
import time
from collections.abc import Callable, Mapping
from importlib.util import find_spec
from inspect import signature
from math import isinf
from typing import Any, Final

from pioneer3.errors import ConfigError
from pioneer3.ros.rclpy.definitions import Definitions
from pioneer3.ros.rclpy.endpoints import Closing, RclpyReader, RclpyWriter
from pioneer3.ros.rclpy.graph import graph_of, publishers
from pioneer3.ros.ros2.backend import (
    Failed,
    Graph,
    Left,
    MessageType,
    NodeName,
    Qos,
    Received,
    Respond,
    ServiceType,
    Unread,
)
from pioneer3.ros.ros2.types import MessageTypes

RANGE: Final = "ROS_AUTOMATIC_DISCOVERY_RANGE"
"""The variable of ROS 2, since Iron, that says who finds a node."""
HERE: Final = "LOCALHOST"
"""Its value for this computer only; it is ours unless somebody sets one."""
THREADS: Final = 64
"""More than a node has services, so that waiting ones hold up nothing else."""
POLL: Final = 0.2
"""Between two looks at the publishers [s]."""
LONGEST_END: Final = 2.0
"""Wait for each thread when the node ends [s]."""
log = logging.getLogger(__name__)


def installed_distro() -> str | None:
    """Return the name of the ROS 2 that this Python can import; `None` for none."""
    distro = os.environ.get("ROS_DISTRO", "")
    return distro if distro and find_spec("rclpy") is not None else None


class RclpyBackend:
    """A node by rclpy, in a domain, `None` for `ROS_DOMAIN_ID`; ConfigError without rclpy."""

    def __init__(self, node: NodeName, types: MessageTypes, domain: int | None) -> None:
        distro = installed_distro() or types.distro.name
        if reason := obstacle(distro):
            raise ConfigError(f"{reason}; or take another backend")
        from rclpy.context import Context
        from rclpy.executors import MultiThreadedExecutor
        from rclpy.node import Node
        from rclpy.utilities import get_rmw_implementation_identifier

        from pioneer3.ros.rclpy.taking import Taking

        self._types, self._definitions = types, Definitions(types)
        self._unread = Unread("names of other nodes or topics")
        self._context = Context()
        os.environ.setdefault(RANGE, HERE)
        self._context.init(args=[], domain_id=domain)  # unlike rclpy.init: no signal handlers
        self._node = Node(
            node.name,
            namespace=node.namespace,
            context=self._context,
            cli_args=[],
            use_global_arguments=False,
            enable_rosout=False,
            start_parameter_services=False,
        )
        for own in tuple(self._node.publishers):  # of parameters, which this package serves itself
            self._node.destroy_publisher(own)
        rmw = get_rmw_implementation_identifier()
        number = self._context.get_domain_id() if domain is None else domain
        self.title = f"rclpy of {distro} ({rmw}), domain {number}, {reach(os.environ, rmw)}"
        self.serves, self.strict, self.lacks = True, rmw != "rmw_zenoh_cpp", ""
        self._lock = threading.RLock()
        self._open: list[Closing] = []
        self._clients: dict[tuple[str, str], Any] = {}
        self._closed = threading.Event()
        self._taking = Taking(self._context)
        self._executor = MultiThreadedExecutor(THREADS, context=self._context)
        self._executor.add_node(self._node)
        self._threads = [
            threading.Thread(target=each, name=f"rclpy {each.__name__}", daemon=True)
            for each in (self._spin, self._watch)
        ]
        for thread in self._threads:
            thread.start()

    def advertise(self, name: str, type_: MessageType, qos: Qos) -> RclpyWriter:
        """Publish on a topic."""
        kind = self._definitions.message(type_.name)
        with self._lock:
            publisher = self._node.create_publisher(kind, name, _profile(qos))
            writer = RclpyWriter(
                publisher, lambda: self._destroy(writer, self._node.destroy_publisher, publisher)
            )
            self._open.append(writer)
        return writer

    def subscribe(
        self, name: str, type_: MessageType, qos: Qos, received: Received, left: Left
    ) -> RclpyReader:
        """Subscribe to a topic; its messages come one after the other."""
        from pioneer3.ros.rclpy.taking import apart

        kind = self._definitions.message(type_.name)
        reader = RclpyReader(
            received,
            left,
            lambda: publishers(self._node, name, self._unread),
            lambda: self._destroy(reader, self._unsubscribe, subscription),
        )
        with self._lock:
            # its callback does nothing: messages are taken apart from executors
            subscription = self._node.create_subscription(
                kind, name, lambda _: None, _profile(qos), callback_group=apart(), raw=True
            )
            self._open.append(reader)
        self._taking.add(subscription, reader.take)
        return reader

    def _unsubscribe(self, subscription: Any) -> bool:
        self._taking.remove(subscription)
        return bool(self._node.destroy_subscription(subscription))

    def serve(self, name: str, type_: ServiceType, respond: Respond) -> Closing:
        """Offer a service; requests come one after the other, apart from those of others."""
        from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
        from rclpy.serialization import deserialize_message, serialize_message

        kind = self._definitions.service(type_)
        unread = Unread(f"requests of {name}")

        def handle(request: Any, response: Any) -> Any:
            try:
                asked = self._types.trimmed(serialize_message(request), type_.request.name)
                return deserialize_message(respond(asked), kind.Response)
            except ValueError as error:
                unread.add(error)
                return response
            except Exception:  # it would end the executor, and rclpy has no response that says so
                log.exception("the service %s fails", name)
                return response

        group = MutuallyExclusiveCallbackGroup()
        with self._lock:
            service = self._node.create_service(kind, name, handle, callback_group=group)
            offer = Closing(lambda: self._destroy(offer, self._node.destroy_service, service))
            self._open.append(offer)
        return offer

    def call(self, name: str, type_: ServiceType, request: bytes, timeout: float) -> bytes:
        """Call a service; return the serialized response; TimeoutError after `timeout` [s]."""
        from rclpy.serialization import deserialize_message, serialize_message

        kind = self._definitions.service(type_)
        end, done = time.monotonic() + timeout, threading.Event()
        client = self._client(name, type_.name, kind)
        if not client.wait_for_service(timeout_sec=timeout):
            raise TimeoutError(f"no node offers {name}")
        future = client.call_async(deserialize_message(request, kind.Request))
        future.add_done_callback(lambda _: done.set())
        if not done.wait(max(0.0, end - time.monotonic())):
            client.remove_pending_request(future)
            raise TimeoutError(f"{name} does not respond within {timeout} s")
        return self._types.trimmed(serialize_message(future.result()), type_.response.name)

    def graph(self) -> Graph:
        """Return the nodes and endpoints that are known now."""
        return Graph() if self._closed.is_set() else graph_of(self._node, self._unread)

    def on_failure(self, call: Failed) -> None:
        """Do nothing: an executor that fails begins again."""

    def close(self) -> None:
        """Leave the network; nothing is received afterwards."""
        with self._lock:
            if self._closed.is_set():
                return
            self._closed.set()
            still_open = tuple(self._open)
        self._taking.close(LONGEST_END)
        self._context.try_shutdown()  # the executor returns before anything is destroyed
        for thread in self._threads:
            thread.join(LONGEST_END)
        for each in still_open:
            each.close()
        self._end_executor()
        self._node.destroy_node()
        self._unread.close()

    def _end_executor(self) -> None:
        """End it without waiting for requests that wait."""
        if "wait_for_threads" in signature(self._executor.shutdown).parameters:
            self._executor.shutdown(timeout_sec=0, wait_for_threads=False)
        else:
            self._executor.shutdown(timeout_sec=0)  # Jazzy before 2026, Humble

    def _client(self, name: str, type_name: str, kind: Any) -> Any:
        """Return the client for a service; the same one each time."""
        from rclpy.callback_groups import ReentrantCallbackGroup

        with self._lock:
            if (name, type_name) not in self._clients:
                self._clients[name, type_name] = self._node.create_client(
                    kind, name, callback_group=ReentrantCallbackGroup()
                )
            return self._clients[name, type_name]

    def _destroy(self, each: Closing, destroy: Callable[[Any], bool], entity: Any) -> None:
        with self._lock:
            self._open.remove(each)
            destroy(entity)

    def _spin(self) -> None:
        from rclpy.executors import ExternalShutdownException

        while not self._closed.is_set():
            try:
                self._executor.spin()
            except ExternalShutdownException:
                return
            except Exception:  # the node goes on receiving
                if not self._closed.is_set():
                    log.exception("rclpy's executor fails")
            self._closed.wait(POLL)

    def _watch(self) -> None:
        """Look for publishers that left."""
        while not self._closed.wait(POLL):
            with self._lock:
                readers = [each for each in self._open if isinstance(each, RclpyReader)]
            for reader in readers:
                try:
                    reader.look()
                except Exception:  # the next look may succeed
                    if not self._closed.is_set():
                        log.exception("the publishers of a topic are not known")


def reach(environment: Mapping[str, str], rmw: str) -> str:
    """Return the computers that reach a node, in words, by the variables of ROS 2."""
    peers = environment.get("ROS_STATIC_PEERS", "").strip("; ")
    if rmw == "rmw_zenoh_cpp":
        return "whoever reaches its Zenoh router"
    match environment.get(RANGE, "").upper():
        case "OFF":
            return "nobody"
        case "LOCALHOST" if peers:
            return f"this computer and {peers}"
        case "LOCALHOST":
            return f"this computer only ({RANGE}=SUBNET for all around)"
        case "SYSTEM_DEFAULT":
            return f"as the settings of {rmw} say"
        case _:
            return "all computers around"


def obstacle(distro: str) -> str:
    """Return the reason why this Python cannot import the rclpy of `distro`; empty if it can."""
    try:
        import rclpy.node  # noqa: F401
    except ImportError as error:
        here = f"Python {sys.version_info.major}.{sys.version_info.minor}"
        return (
            f"{here} cannot import rclpy ({error}): source /opt/ros/{distro}/setup.bash, and use"
            " the Python that this ROS is made for"
        )
    return ""


def _profile(qos: Qos) -> Any:
    from rclpy.duration import Duration
    from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

    durability, reliability = DurabilityPolicy, ReliabilityPolicy
    limits = {} if isinf(qos.lifespan) else {"lifespan": Duration(seconds=qos.lifespan)}
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=qos.depth,
        reliability=reliability.RELIABLE if qos.reliable else reliability.BEST_EFFORT,
        durability=durability.TRANSIENT_LOCAL if qos.transient_local else durability.VOLATILE,
        **limits,
    )
