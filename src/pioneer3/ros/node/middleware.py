"""The part of a ROS middleware that nodes and clients need; `ros1` and `ros2` have it.

Calls that set something up or take it away talk to others and may take their time: they are made in
a thread, never in the event loop.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Final, Protocol

from pioneer3.ros.node.driving_parameters import DrivingParameters
from pioneer3.ros.node.parameters import NodeParameters

QUEUE: Final = 10
"""Messages that wait for a slow subscriber."""


@dataclass(frozen=True, slots=True)
class Sender:
    """The publisher of a message.

    Its connection is the same object for all messages over that. If it is latched, new subscribers
    get its last message, however old that is.
    """

    node: str
    connection: object
    latched: bool = False


Receive = Callable[[Any, Sender], None]
"""Takes a message, in any thread."""
Lose = Callable[[Sender], None]
"""Told of a sender that is known to be gone, in any thread."""
Unsubscribe = Callable[[], None]
"""Ends a subscription to one topic."""


@dataclass(frozen=True, slots=True)
class Response:
    """Response of a service: whether it did its work, and a sentence for a person."""

    success: bool
    message: str


class Publisher(Protocol):
    """A publisher on one topic; a slow subscriber never holds it up."""

    @property
    def subscribed(self) -> bool:
        """Whether anybody subscribes."""

    def publish(self, message: Any) -> None:
        """Send a message, or the content of one that has a single field.

        A message may be filled again afterwards, unless the topic is latched.
        """


class Advertising(Protocol):
    """Publishing."""

    def make(self, type_name: str) -> Any:
        """Return an empty message of a type such as `nav_msgs/Odometry`."""

    def advertise(
        self, name: str, type_name: str, *, latched: bool = False, queue: int = QUEUE
    ) -> Publisher:
        """Return a publisher; of `queue` messages that wait for a subscriber the newest stay."""


class Topics(Advertising, Protocol):
    """Publishing and subscribing."""

    def resolve(self, name: str) -> str:
        """Return the full name of a topic after remapping."""

    def subscribe(
        self, name: str, type_name: str, receive: Receive, *, queue: int, left: Lose | None = None
    ) -> Unsubscribe:
        """Call `receive` with each message; of `queue` that wait the newest stay."""


class Outlet(Advertising, Protocol):
    """The part of a middleware that publishes for a node."""

    @property
    def name(self) -> str:
        """Full name of the node."""

    def stamp(self, age: float) -> Any:
        """Return the ROS time of the moment `age` seconds ago."""

    def warn(self, sentence: str) -> None:
        """Log a warning."""


class Middleware(Outlet, Topics, Protocol):
    """All that a node needs."""

    @property
    def serves(self) -> bool:
        """Whether others can call services of this node."""

    def age(self, stamp: Any) -> float | None:
        """Return the time since a stamp [s]; `None` for a stamp of 0, which says nothing."""

    def serve(self, name: str, type_name: str, handle: Callable[[Any], Any]) -> None:
        """Offer a service; `handle` is called with requests, in any thread.

        It returns an object that has the fields of the response.
        """

    def describe(self, urdf: str) -> None:
        """Publish the description of the robot."""

    def reconfigure(self, parameters: NodeParameters, driving: DrivingParameters) -> None:
        """Let people see parameters, and set those of driving while the node runs."""

    def forget(self) -> None:
        """Take back the description and the parameters: the node ends."""

    def on_shutdown(self, call: Callable[[], None]) -> None:
        """Call `call`, in any thread, when somebody shuts the node down."""

    @property
    def mismatches(self) -> Callable[[], Sequence[str]] | None:
        """Returns a sentence for each endpoint of others that cannot talk to one of ours.

        `None` where the middleware logs them by itself.
        """
