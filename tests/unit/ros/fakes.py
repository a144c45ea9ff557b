"""A ROS middleware without ROS: it keeps all that is published, offered and logged."""

import asyncio
from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass, field
from threading import Thread
from types import SimpleNamespace
from typing import Any

from pioneer3.ros.node.driving_parameters import DrivingParameters
from pioneer3.ros.node.middleware import QUEUE, Lose, Receive, Response, Sender
from pioneer3.ros.node.parameters import NodeParameters
from tests.unit.ros.support import Blank


class Moment(float):
    """A time of a middleware [s]."""

    def to_nsec(self) -> int:
        return round(self * 1e9)


SOMEBODY = Sender("/somebody", object())


@dataclass
class FakePublisher:
    """A publisher that keeps its messages."""

    type_name: str
    latched: bool
    subscribed: bool = False
    messages: list[Any] = field(default_factory=list)

    def publish(self, message: Any) -> None:
        self.messages.append(deepcopy(message))  # it is filled again


class FakeMiddleware:
    """A middleware in which a test is everybody else."""

    name = "/RosAria"
    serves = True

    def __init__(self) -> None:
        self.leaving: dict[str, Callable[[Sender], None] | None] = {}
        self.mismatched: list[str] = []
        self.publishers: dict[str, FakePublisher] = {}
        self.receivers: dict[str, Callable[[Any, Sender], None]] = {}
        self.services: dict[str, Callable[[Any], Response]] = {}
        self.description: str | None = None
        self.driving: DrivingParameters | None = None
        self.warnings: list[str] = []
        self.shut_down: Callable[[], None] = lambda: None
        self.forgotten = False

    async def at_once(self, function: Callable[..., Any], *arguments: Any, **more: Any) -> Any:
        """Stand in for `asyncio.to_thread`: virtual time does not wait for other threads."""
        return function(*arguments, **more)

    def drive(self, name: str, speed: float) -> None:
        """Publish a Twist on a command topic."""
        zero = SimpleNamespace(x=0.0, y=0.0, z=0.0)
        linear = SimpleNamespace(x=speed, y=0.0, z=0.0)
        self.receivers[name](SimpleNamespace(linear=linear, angular=zero), SOMEBODY)

    async def call(self, name: str, **request: Any) -> Any:
        """Call a service as a middleware does, in another thread; return the response."""
        responses: list[Any] = []
        handle = self.services[name]
        thread = Thread(target=lambda: responses.append(handle(SimpleNamespace(**request))))
        thread.start()
        while thread.is_alive():
            thread.join(0.001)
            await asyncio.sleep(0.001)
        return responses[0]

    def make(self, type_name: str) -> Any:
        return Blank(kind=type_name)

    def resolve(self, name: str) -> str:
        return name.replace("~", "/RosAria/") if name[0] in "~/" else f"/{name}"

    def stamp(self, age: float) -> Any:
        return Moment(-age)

    def age(self, stamp: Any) -> float | None:
        return -stamp if stamp else None

    def mismatches(self) -> list[str]:
        return self.mismatched

    def advertise(
        self, name: str, type_name: str, *, latched: bool = False, queue: int = QUEUE
    ) -> FakePublisher:
        assert name not in self.publishers
        self.publishers[name] = FakePublisher(type_name, latched)
        return self.publishers[name]

    def subscribe(
        self, name: str, type_name: str, receive: Receive, *, queue: int, left: Lose | None = None
    ) -> Callable[[], None]:
        self.receivers[name], self.leaving[name] = receive, left
        return lambda: None

    def serve(self, name: str, type_name: str, handle: Callable[[Any], Response]) -> None:
        self.services[name] = handle

    def describe(self, urdf: str) -> None:
        self.description = urdf

    def reconfigure(self, parameters: NodeParameters, driving: DrivingParameters) -> None:
        self.driving = driving

    def forget(self) -> None:
        self.forgotten = True

    def on_shutdown(self, call: Callable[[], None]) -> None:
        self.shut_down = call

    def warn(self, sentence: str) -> None:
        self.warnings.append(sentence)
