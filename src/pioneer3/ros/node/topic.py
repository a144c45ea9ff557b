"""A row of the table of topics."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from pioneer3.models.description.tree import Frames
from pioneer3.ros.messages.diagnostics import DiagnosticsUpdate
from pioneer3.ros.messages.goals import FeedbackUpdate, GoalsUpdate, ResultUpdate
from pioneer3.ros.messages.navigation import MapUpdate, NavigationUpdate
from pioneer3.ros.messages.update import (
    DescriptionUpdate,
    MessageOptions,
    PictureUpdate,
    ScanUpdate,
    SensorUpdate,
    StateUpdate,
)
from pioneer3.ros.node.names import AS_STANDARD, Profile

Update = (
    StateUpdate
    | ScanUpdate
    | SensorUpdate
    | PictureUpdate
    | DescriptionUpdate
    | DiagnosticsUpdate
    | MapUpdate
    | NavigationUpdate
    | GoalsUpdate
    | FeedbackUpdate
    | ResultUpdate
)
"""Anything that topics are published from."""


class Direction(StrEnum):
    """Whether the node sends the messages of a topic or receives them."""

    PUBLISHED = "published"
    SUBSCRIBED = "subscribed"


def always(update: Any) -> bool:
    """Return True: most topics have data in each update."""
    return True


@dataclass(frozen=True, slots=True, kw_only=True)
class Topic:
    """One row of the table: a topic that a node publishes or subscribes to.

    A topic that is not latched is published only while it has subscribers.

    Attributes:
        compatibility: Name in RosAria, `~` for below the node's own; `None` if it has none.
        standard: Name after the conventions of ROS packages, relative; `None` if it has none.
        ros2: Name in ROS 2; empty where it is the same, `None` if it has none; so is `p2os` that in
            p2os.
        source: Kind of update that it is published from.
        sensor: Name of the sensor or laser that is published; empty for all other topics.
        fill: Puts such an update into a message that is empty, or that it filled before; `None` for
            a topic that is subscribed to.
        parse: See :meth:`content`; `None` for a topic that is published.
        changes: Returns the content that matters, where a message is sent only when that is new;
            `None` for a topic that is sent with every update. Updates then have a `moment`.
        latched: Whether a late subscriber gets the last message.
        period: Longest pause between two messages while somebody subscribes [s]; 0 for none, `None`
            where only changes are sent.
        when_lost: Content of a latched topic while there is no robot; `None` if it stays true.
        rate: Messages that come in a second [Hz]; `None` where they come with a device's readings,
            with events or with changes.
        optional: Part of a robot that it takes, where robots may be without; empty for all others.
        note: For the docs.
    """

    compatibility: str | None = None
    standard: str | None = None
    ros2: str | None = AS_STANDARD
    p2os: str | None = AS_STANDARD
    type_name: str
    source: type[Update] = StateUpdate
    sensor: str = ""
    fill: Callable[[Any, Any], None] | None = None
    parse: Callable[[Any], Any] | None = None
    changes: Callable[[Any], object] | None = None
    latched: bool = False
    period: float | None = None
    when_lost: object = None
    has_data: Callable[[Any], bool] = always
    enabled: Callable[[MessageOptions], bool] = lambda options: True
    rate: float | None = None
    optional: str = ""
    frame: Callable[[Frames], str] | None = None
    note: str = ""

    @property
    def direction(self) -> Direction:
        """Whether the node publishes it or subscribes to it."""
        return Direction.PUBLISHED if self.fill else Direction.SUBSCRIBED

    @property
    def is_repeated(self) -> bool:
        """Whether it is sent without a change, too."""
        return self.changes is None or self.period is not None

    def names(self, profile: Profile) -> tuple[str, ...]:
        """Return its names in `profile`."""
        return profile.choose(self.compatibility, self.standard, self.ros2, self.p2os)

    def content(self, message: Any) -> Any:
        """Return the content of a message that is received; CommandError if none of it counts."""
        assert self.parse is not None
        return self.parse(message)
