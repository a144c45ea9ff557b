"""A stand-in for rclpy, as strict about names and types of arguments as its source.

Signatures are those of https://github.com/ros2/rclpy (branches humble, jazzy, rolling) and fields
of generated classes those of rosidl_generator_py. Its network is in this process; entities that
were destroyed raise `InvalidHandle`.
"""

import sys
import threading
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field
from enum import IntEnum
from functools import cached_property
from importlib.machinery import ModuleSpec
from itertools import count
from queue import Empty, Queue
from types import ModuleType, SimpleNamespace
from typing import Any, TypeVar

import pytest

FIELDS: dict[str, dict[str, str]] = {
    "std_msgs/msg/String": {"data": "string"},
    "std_msgs/msg/Header": {"stamp": "builtin_interfaces/Time", "frame_id": "string"},
    "builtin_interfaces/msg/Time": {"sec": "int32", "nanosec": "uint32"},
    "std_srvs/srv/Trigger_Request": {},
    "std_srvs/srv/Trigger_Response": {"success": "boolean", "message": "string"},
}
"""Of classes generated in Jazzy."""


class InvalidHandle(Exception):  # noqa: N818
    """What uses of destroyed entities raise."""


class ExternalShutdownException(Exception):  # noqa: N818
    """Raised by `spin` of a context that was shut down."""


class NodeNameNonExistentError(RuntimeError):
    """The node has left."""


class ReliabilityPolicy(IntEnum):
    RELIABLE = 1
    BEST_EFFORT = 2


class DurabilityPolicy(IntEnum):
    TRANSIENT_LOCAL = 1
    VOLATILE = 2


class HistoryPolicy(IntEnum):
    KEEP_LAST = 1


class Duration:
    def __init__(self, *, seconds: float = 0, nanoseconds: int = 0) -> None:
        self.nanoseconds = int(seconds * 1e9) + nanoseconds


class QoSProfile:
    def __init__(self, **kwargs: Any) -> None:
        kinds = {"history": HistoryPolicy, "depth": int}
        kinds |= {"reliability": ReliabilityPolicy, "durability": DurabilityPolicy}
        kinds["lifespan"] = Duration
        for name, value in kwargs.items():
            assert isinstance(value, kinds[name])
        self.depth, self.history = kwargs["depth"], kwargs["history"]
        self.reliability, self.durability = kwargs["reliability"], kwargs["durability"]
        self.lifespan = kwargs.get("lifespan", Duration())


class RCLError(RuntimeError):
    """Raised by functions of rcl."""


class CallbackGroup:
    def __init__(self) -> None:
        self.running = threading.Lock()

    def can_execute(self, entity: object) -> bool:
        return True


class MutuallyExclusiveCallbackGroup(CallbackGroup):
    pass


class ReentrantCallbackGroup(CallbackGroup):
    pass


class Generated:
    """Base of generated messages; the content is the serialized one."""

    cdr = b""
    fields: dict[str, str] = {}  # noqa: RUF012

    @classmethod
    def get_fields_and_field_types(cls) -> dict[str, str]:
        return dict(cls.fields)


@dataclass
class Flavour:
    """The ways in which distributions and middlewares differ."""

    distro: str = "jazzy"
    rmw: str = "rmw_fastrtps_cpp"
    tells_gid: bool = False
    gid_is_that_of_the_graph: bool = True


@dataclass
class World:
    """The network, and all that was made on it."""

    flavour: Flavour
    types: Any
    nodes: list["Node"] = field(default_factory=list)
    contexts: list["Context"] = field(default_factory=list)
    gids: Iterator[int] = field(default_factory=lambda: count(1))
    fields: dict[str, dict[str, str]] = field(default_factory=lambda: dict(FIELDS))
    ready: threading.Condition = field(default_factory=threading.Condition)

    def entities(self, kind: type["Entity"], name: str) -> list[Any]:
        all_ = [each for node in self.nodes for each in node.entities]
        return [each for each in all_ if isinstance(each, kind) and each.name == name]


class Context:
    world: World

    def __init__(self) -> None:
        self.is_ok: bool | None = None
        self.callbacks: list[Callable[[], None]] = []
        self.world.contexts.append(self)

    def init(
        self,
        args: list[str] | None = None,
        *,
        initialize_logging: bool = True,
        domain_id: int | None = None,
    ) -> None:
        assert self.is_ok is None, "Context.init() must only be called once"
        assert args == [], "the program's own arguments are no business of ROS"
        assert domain_id is None or (type(domain_id) is int and domain_id >= 0)
        self.is_ok, self.domain = True, 0 if domain_id is None else domain_id

    @property
    def handle(self) -> "Context":
        return self

    def ok(self) -> bool:
        return bool(self.is_ok)

    def get_domain_id(self) -> int:
        return self.domain

    def on_shutdown(self, callback: Callable[[], None]) -> None:
        self.callbacks.append(callback)

    def try_shutdown(self) -> None:
        self.is_ok = False
        for each in self.callbacks:
            each()


@dataclass(eq=False)
class Entity:
    node: "Node"
    kind: Any
    name: str
    gid: bytes = b""
    qos: QoSProfile | None = None
    callback: Callable[..., Any] | None = None
    group: CallbackGroup = field(default_factory=CallbackGroup)
    destroyed: bool = False
    inbox: deque[Callable[[], Any]] = field(default_factory=deque)

    def use(self) -> None:
        if self.destroyed:
            raise InvalidHandle("cannot use Destroyable because destruction was requested")

    @property
    def world(self) -> World:
        return self.node.context.world

    def queue(self, work: Callable[[], Any]) -> None:
        executor = self.node.executor
        if executor is not None and not self.destroyed:
            self.inbox.append(work)
            executor.work.put(self)


E = TypeVar("E", bound=Entity)


class Publisher(Entity):
    def get_subscription_count(self) -> int:
        self.use()
        return len(self.world.entities(Subscription, self.name))

    def publish(self, msg: Any) -> None:
        self.use()
        if type(msg) is not bytes:
            raise TypeError(f"Expected {self.kind}, got {type(msg)}")
        for each in self.world.entities(Subscription, self.name):
            each.take(msg, self)


class Handle:
    """What belongs to rcl of a subscription or guard condition; in use, it stays."""

    def __init__(self, world: World) -> None:
        self.world, self.pointer = world, id(self)
        self.destroyed = False
        self.inbox: deque[tuple[bytes, dict[str, Any]]] = deque()
        self.triggered = False

    def __enter__(self) -> "Handle":
        if self.destroyed:
            raise InvalidHandle("cannot use Destroyable because destruction was requested")
        return self

    def __exit__(self, *_: object) -> None:
        pass

    @property
    def is_ready(self) -> bool:
        return self.triggered or bool(self.inbox)

    def take_message(self, kind: Any, raw: bool) -> tuple[bytes, dict[str, Any]] | None:
        assert raw
        assert issubclass(kind, Generated)
        return self.inbox.popleft() if self.inbox else None

    def put(self, *taken: Any) -> None:
        with self.world.ready:
            if taken:
                self.inbox.append(taken)
            self.triggered = not taken
            self.world.ready.notify_all()


class GuardCondition:
    def __init__(self, callback: Any, callback_group: Any, *, context: Context) -> None:
        assert (callback, callback_group) == (None, None)
        self.handle = Handle(context.world)

    def trigger(self) -> None:
        with self.handle:
            self.handle.put()

    def destroy(self) -> None:
        self.handle.destroyed = True


class WaitSet:
    def __init__(self, subscriptions: int, guards: int, *others: int | Context) -> None:
        *none, context = others
        assert none == [0, 0, 0, 0]
        assert isinstance(context, Context)
        if not context.ok():
            raise RCLError("the given context is not valid")
        self.most, self.world = (subscriptions, guards), context.world
        self.is_clear = False

    def __enter__(self) -> "WaitSet":
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def clear_entities(self) -> None:
        self.subscriptions: list[Handle] = []
        self.guards: list[Handle] = []
        self.is_clear = True

    def add_subscription(self, handle: Handle) -> None:
        self.subscriptions.append(handle)
        assert len(self.subscriptions) <= self.most[0]

    def add_guard_condition(self, handle: Handle) -> None:
        self.guards.append(handle)
        assert len(self.guards) <= self.most[1]

    def wait(self, timeout_nsec: int) -> None:
        assert self.is_clear, "entities of the last wait are null"
        assert timeout_nsec == -1
        every = (*self.subscriptions, *self.guards)
        with self.world.ready:
            assert self.world.ready.wait_for(lambda: any(e.is_ready for e in every), 30)
        self.ready = {each.pointer for each in self.subscriptions if each.is_ready}
        for each in self.guards:
            each.triggered = False
        self.is_clear = False

    def get_ready_entities(self, kind: str) -> list[int]:
        assert kind == "subscription"
        return list(self.ready)


class Subscription(Entity):
    @property
    def msg_type(self) -> Any:
        return self.kind

    @cached_property
    def handle(self) -> Handle:
        return Handle(self.world)

    def take(self, msg: bytes, publisher: Publisher) -> None:
        flavour = self.world.flavour
        gid = publisher.gid if flavour.gid_is_that_of_the_graph else publisher.gid[::-1]
        info: dict[str, Any] = {"source_timestamp": 1, "received_timestamp": 2}
        info |= {"publication_sequence_number": None, "reception_sequence_number": None}
        if flavour.tells_gid:
            info["publisher_gid"] = {"implementation_identifier": flavour.rmw, "data": gid}
        assert not self.group.can_execute(self), "an executor takes it"
        self.handle.put(msg, info)


class Service(Entity):
    def take(self, request: Generated, respond: Callable[[Any], None]) -> None:
        callback = self.callback
        assert callback is not None
        assert isinstance(request, self.kind.Request)

        def work() -> None:
            response = callback(request, self.kind.Response())
            assert isinstance(response, self.kind.Response)
            respond(response)

        self.queue(work)


class Client(Entity):
    def wait_for_service(self, timeout_sec: float | None = None) -> bool:
        return bool(self.world.entities(Service, self.name))

    def call_async(self, request: Any) -> "Future[Any]":
        if not isinstance(request, self.kind.Request):
            raise TypeError
        future: Future[Any] = Future()
        (server,) = self.world.entities(Service, self.name)
        server.take(request, lambda response: self.queue(lambda: future.set_result(response)))
        return future

    def remove_pending_request(self, future: "Future[Any]") -> None:
        pass


class Node:
    def __init__(
        self,
        node_name: str,
        *,
        context: Context | None = None,
        cli_args: list[str] | None = None,
        namespace: str | None = None,
        use_global_arguments: bool = True,
        enable_rosout: bool = True,
        start_parameter_services: bool = True,
    ) -> None:
        assert context is not None
        assert context.ok()
        assert (cli_args, use_global_arguments) == ([], False)
        assert not enable_rosout
        assert not start_parameter_services
        self.context, self.name, self.namespace = context, node_name, namespace or "/"
        self.entities: list[Any] = []
        self.executor: MultiThreadedExecutor | None = None
        context.world.nodes.append(self)

    @property
    def publishers(self) -> Iterator[Publisher]:
        yield from (each for each in self.entities if isinstance(each, Publisher))

    def create_publisher(
        self, msg_type: Any, topic: str, qos_profile: Any, *, callback_group: Any = None
    ) -> Publisher:
        return self._add(Publisher(self, self._checked(msg_type), topic, qos=qos_profile))

    def create_subscription(
        self,
        msg_type: Any,
        topic: str,
        callback: Callable[..., Any],
        qos_profile: Any,
        *,
        callback_group: Any = None,
        raw: bool = False,
    ) -> Subscription:
        assert raw
        kind = self._checked(msg_type)
        made = Subscription(self, kind, topic, qos=qos_profile, callback=callback)
        return self._add(made, callback_group)

    def create_service(
        self,
        srv_type: Any,
        srv_name: str,
        callback: Callable[..., Any],
        *,
        qos_profile: Any = None,
        callback_group: Any = None,
    ) -> Service:
        return self._add(Service(self, srv_type, srv_name, callback=callback), callback_group)

    def create_client(
        self, srv_type: Any, srv_name: str, *, qos_profile: Any = None, callback_group: Any = None
    ) -> Client:
        return self._add(Client(self, srv_type, srv_name), callback_group)

    def destroy_publisher(self, publisher: Any) -> bool:
        return self._remove(publisher, Publisher)

    def destroy_subscription(self, subscription: Any) -> bool:
        return self._remove(subscription, Subscription)

    def destroy_service(self, service: Any) -> bool:
        return self._remove(service, Service)

    def destroy_node(self) -> None:
        for each in list(self.entities):
            self._remove(each, Entity)
        self.context.world.nodes.remove(self)

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        return [(each.name, each.namespace) for each in self.context.world.nodes]

    def get_topic_names_and_types(self, no_demangle: bool = False) -> list[tuple[str, list[str]]]:
        all_ = [each for node in self.context.world.nodes for each in node.entities]
        topics = [each for each in all_ if isinstance(each, Publisher | Subscription)]
        return sorted({each.name: (each.name, [each.kind.type_name]) for each in topics}.values())

    def get_publishers_info_by_topic(self, topic_name: str, no_mangle: bool = False) -> list[Any]:
        return [self._info(e) for e in self.context.world.entities(Publisher, topic_name)]

    def get_subscriptions_info_by_topic(
        self, topic_name: str, no_mangle: bool = False
    ) -> list[Any]:
        return [self._info(e) for e in self.context.world.entities(Subscription, topic_name)]

    def get_service_names_and_types_by_node(
        self, node_name: str, node_namespace: str
    ) -> list[tuple[str, list[str]]]:
        if node_name == "leaving":
            raise NodeNameNonExistentError
        nodes = [n for n in self.context.world.nodes if n.name == node_name]
        services = [e for n in nodes for e in n.entities if isinstance(e, Service)]
        return [(each.name, [each.kind.type_name]) for each in services]

    def get_client_names_and_types_by_node(
        self, node_name: str, node_namespace: str
    ) -> list[tuple[str, list[str]]]:
        return []

    def _info(self, entity: Entity) -> Any:
        hash_ = {} if self.context.world.flavour.distro == "humble" else {"topic_type_hash": Hash()}
        return SimpleNamespace(
            node_name=entity.node.name,
            node_namespace=entity.node.namespace,
            topic_type=entity.kind.type_name,
            endpoint_gid=list(entity.gid),
            qos_profile=entity.qos,
            **hash_,
        )

    def _checked(self, msg_type: Any) -> Any:
        assert issubclass(msg_type, Generated)
        return msg_type

    def _add(self, entity: E, group: Any = None) -> E:
        assert entity.name.startswith("/")
        entity.gid = next(self.context.world.gids).to_bytes(4, "little") * 4
        if group is not None:
            assert isinstance(group, CallbackGroup)
            entity.group = group
        self.entities.append(entity)
        return entity

    def _remove(self, entity: Any, kind: type[Entity]) -> bool:
        assert isinstance(entity, kind)
        if entity not in self.entities:
            return False
        self.entities.remove(entity)
        entity.destroyed = True
        if isinstance(entity, Subscription):
            entity.handle.destroyed = True
        return True


class Hash:
    """As TypeHash of rclpy since Iron."""

    def __str__(self) -> str:
        return "RIHS01_" + 64 * "0"


class MultiThreadedExecutor:
    def __init__(self, num_threads: int | None = None, *, context: Context | None = None) -> None:
        assert context is not None
        self.context = context
        self.work: Queue[Entity] = Queue()
        self.pool = ThreadPoolExecutor(num_threads)
        self.errors: list[Exception] = []
        self.wake = threading.Event()
        context.on_shutdown(self.wake.set)

    def add_node(self, node: Node) -> bool:
        node.executor = self
        return True

    def spin(self) -> None:
        while self.context.ok():
            try:
                entity = self.work.get(timeout=0.01)
            except Empty:
                continue
            exclusive = isinstance(entity.group, MutuallyExclusiveCallbackGroup)
            running = entity.group.running if exclusive else None
            if running is not None and not running.acquire(blocking=False):
                self.work.put(entity)
                self.wake.wait(0.001)
                continue
            self.pool.submit(self._run, entity.inbox.popleft(), running)
        raise ExternalShutdownException

    def shutdown(self, timeout_sec: float | None = None, *, wait_for_threads: bool = True) -> bool:
        assert not self.context.ok(), "spin() may still submit to the pool (rclpy #1724)"
        self.pool.shutdown(wait=wait_for_threads)
        return True

    def _run(self, work: Callable[[], Any], running: Any) -> None:
        try:
            work()
        except Exception as error:  # rclpy raises it from spin
            self.errors.append(error)
        finally:
            if running is not None:
                running.release()


def serialize_message(message: Any) -> bytes:
    assert isinstance(message, Generated)
    return message.cdr + b"rubbish!"  # as rmw_fastrtps does


def deserialize_message(serialized_message: bytes, message_type: Any) -> Any:
    assert type(serialized_message) is bytes
    assert issubclass(message_type, Generated)
    message = message_type()
    message.cdr = serialized_message
    return message


@contextmanager
def installed(types: Any, flavour: Flavour) -> Iterator[World]:
    """Install the stand-in during the block."""
    world = World(flavour, types)
    modules: dict[str, dict[str, Any]] = {
        "rclpy": {},
        "rclpy.context": {"Context": type("Context", (Context,), {"world": world})},
        "rclpy.executors": {
            "MultiThreadedExecutor": MultiThreadedExecutor,
            "ExternalShutdownException": ExternalShutdownException,
        },
        "rclpy.node": {"Node": Node, "NodeNameNonExistentError": NodeNameNonExistentError},
        "rclpy.utilities": {"get_rmw_implementation_identifier": lambda: flavour.rmw},
        "rclpy.callback_groups": {
            "MutuallyExclusiveCallbackGroup": MutuallyExclusiveCallbackGroup,
            "ReentrantCallbackGroup": ReentrantCallbackGroup,
        },
        "rclpy.serialization": {
            "serialize_message": serialize_message,
            "deserialize_message": deserialize_message,
        },
        "rclpy.guard_condition": {"GuardCondition": GuardCondition},
        "rclpy.impl": {},
        "rclpy.impl.implementation_singleton": {
            "rclpy_implementation": SimpleNamespace(
                WaitSet=WaitSet, InvalidHandle=InvalidHandle, RCLError=RCLError
            )
        },
        "rclpy.duration": {"Duration": Duration},
        "rclpy.qos": {
            "QoSProfile": QoSProfile,
            "HistoryPolicy": HistoryPolicy,
            "ReliabilityPolicy": ReliabilityPolicy,
            "DurabilityPolicy": DurabilityPolicy,
        },
    }
    for name, fields in world.fields.items():
        package, kind, last = name.split("/")
        made = modules.setdefault(f"{package}.{kind}", {})
        modules.setdefault(package, {})
        contents = {"fields": fields, "type_name": name}
        if kind == "srv":
            last, part = last.split("_")
            service = made.setdefault(last, type(last, (), {"type_name": f"{package}/srv/{last}"}))
            contents["cdr"] = types.encode(types.make(name))
            setattr(service, part, type(f"{last}_{part}", (Generated,), contents))
        else:
            made[last] = type(last, (Generated,), contents)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_DISTRO", flavour.distro)
        patch.delenv("ROS_AUTOMATIC_DISCOVERY_RANGE", raising=False)
        for name, contents in modules.items():
            module = ModuleType(name)
            module.__spec__ = ModuleSpec(name, None)
            module.__path__ = []
            vars(module).update(contents)
            patch.setitem(sys.modules, name, module)
        yield world
