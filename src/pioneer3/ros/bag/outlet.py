"""Stands in for a middleware: what a node publishes goes to a bag."""

import logging
from typing import Any, Final

from pioneer3.ros.bag.bags import OpenBag, Write
from pioneer3.ros.messages.update import NANO
from pioneer3.ros.node.middleware import QUEUE
from pioneer3.ros.node.names import NODE

log = logging.getLogger(__name__)

OF_TF: Final = {"tf", "tf_static"}
"""Topics of ROS 2 that robots share whose frames have different names."""


class BagPublisher:
    """A topic of a bag, which is in it from the first message on."""

    subscribed = True

    def __init__(self, outlet: "BagOutlet", name: str, type_name: str, *, latched: bool) -> None:
        self._outlet, self._name, self._type, self._latched = outlet, name, type_name, latched
        self._write: Write | None = None

    def publish(self, message: Any) -> None:
        """Write a message, or the content of one with a single field, at the outlet's time."""
        outlet = self._outlet
        if not hasattr(message, "__msgtype__"):
            content, message = message, outlet.make(self._type)
            message.data = content
        if self._write is None:
            self._write = outlet.bag.connect(
                self._name, self._type, outlet.name, latched=self._latched
            )
        self._write(outlet.now, outlet.bag.types.encode(message))


class BagOutlet:
    """The part of a middleware that publishes, for the node of a robot in a namespace.

    Attributes:
        now: Time of the messages that come now [ns since 1970].
    """

    def __init__(self, bag: OpenBag, namespace: str) -> None:
        self.bag, self.now = bag, 0
        self._namespace = namespace

    @property
    def name(self) -> str:
        """Full name of the node."""
        return f"{self._namespace}/{NODE}"

    def make(self, type_name: str) -> Any:
        """Return an empty message."""
        return self.bag.types.make(type_name)

    def stamp(self, age: float) -> Any:
        """Return the ROS time of the moment `age` seconds ago."""
        return self.stamp_of(self.now - round(age * NANO))

    def stamp_of(self, time: int) -> Any:
        """Return a time [ns since 1970] as ROS time."""
        stamp = self.make("builtin_interfaces/Time")
        stamp.sec, stamp.nanosec = divmod(time, NANO)
        return stamp

    def advertise(
        self, name: str, type_name: str, *, latched: bool = False, queue: int = QUEUE
    ) -> BagPublisher:
        """Return the publisher of a topic; nobody waits in a queue."""
        return BagPublisher(self, self._full(name), type_name, latched=latched)

    def warn(self, sentence: str) -> None:
        """Log a warning."""
        log.warning("%s", sentence)

    def _full(self, name: str) -> str:
        if name.startswith("~"):
            return f"{self.name}/{name[1:]}"
        if name.startswith("/") or name in OF_TF:
            return f"/{name.lstrip('/')}"
        return f"{self._namespace}/{name}"
