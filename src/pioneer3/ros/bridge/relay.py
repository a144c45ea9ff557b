"""The way of one topic's messages from one network to the other."""

import asyncio
import logging
import threading
import time
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from math import isfinite
from typing import Any, Final

from pioneer3.errors import Refusal
from pioneer3.ros.bridge.conversion import Convert
from pioneer3.ros.bridge.guard import ZERO, CommandGuard, is_finite
from pioneer3.ros.bridge.rows import TRANSFORMS, BridgedTopic, Side
from pioneer3.ros.messages.update import NANO, nanoseconds
from pioneer3.ros.ros2.backend import Writer
from pioneer3.ros.ros2.types import MessageTypes
from pioneer3.ros.tcpros.publisher import TopicPublisher
from pioneer3.ros.tcpros.types import Ros1Types

log = logging.getLogger(__name__)
WAITING: Final = 10
"""Messages that wait for the loop; the newest stay."""

OLDEST_GOAL: Final = 5.0
"""An older goal, or pose at the start, is refused [s]: people wait for theirs to begin."""


Types = Ros1Types | MessageTypes
"""The types of one side."""


class Sink:
    """A topic of the side that messages are passed on to; velocity commands have a `guard`."""

    def __init__(
        self,
        name: str,
        type_name: str,
        output: Writer | TopicPublisher,
        types: Types,
        guard: CommandGuard | None,
    ) -> None:
        self.name, self.guard = name, guard
        self._type, self._output, self._types = type_name, output, types
        self._fixed: dict[str, object] = {}
        self._timer: asyncio.TimerHandle | None = None
        self._ended = False
        self._loop = asyncio.get_running_loop()

    @property
    def matched(self) -> bool:
        """Whether anybody subscribes."""
        return self._output.matched

    def write(self, message: Any) -> None:
        """Send a message."""
        self._output.write(self._types.encode(message))

    def write_content(self, content: object) -> None:
        """Send a message of a single field."""
        message = self._types.make(self._type)
        message.data = content
        self.write(message)

    def write_fixed(self, message: Any) -> None:
        """Send fixed transforms, and with them all earlier ones: late subscribers get the last."""
        self._fixed |= {each.child_frame_id: each for each in message.transforms}
        message.transforms = list(self._fixed.values())
        self.write(message)

    def drive(self, message: Any, sender: object, node: str) -> Refusal | None:
        """Send a velocity command of `sender`, and a zero when it has expired."""
        assert self.guard is not None
        if self._ended:  # nothing may come after the zero
            return None
        refusal = self.guard.take(message, sender, node, self._loop.time())
        self._send_due()
        return refusal

    def lose(self, sender: object) -> bool:
        """Stop if `sender`, which is gone, drives; return whether it does."""
        if self.guard is None or self.guard.left(sender) is None:
            return False
        self.stop()
        return True

    def stop(self) -> None:
        """Send a zero."""
        message = self._types.make(self._type)
        if hasattr(message, "header"):
            stamp = message.header.stamp
            stamp.sec, stamp.nanosec = divmod(time.time_ns(), NANO)
        self.write(message)

    def end(self) -> bool:
        """Stop a robot that is driven by messages that were passed on; return whether one was.

        Velocity commands that come later are dropped.
        """
        self._ended = True
        if self._timer is not None:
            self._timer.cancel()
        if self.guard is None or self.guard.end() is None:
            return False
        self.stop()
        return True

    def _send_due(self) -> None:
        assert self.guard is not None
        for message in self.guard.due(self._loop.time()):
            if message is ZERO:
                self.stop()
            else:
                self.write(message)
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        if isfinite(self.guard.deadline):
            self._timer = self._loop.call_at(self.guard.deadline, self._send_due)


class TopicRelay:
    """Passes on the messages of a topic from `source`, whose types are `types`, to a sink.

    `timeout` is the age at which a stamped command is refused [s]; `tell` is given a sentence when
    messages are refused.
    """

    def __init__(
        self,
        row: BridgedTopic,
        source: Side,
        types: Types,
        convert: Convert,
        sink: Sink,
        *,
        timeout: float,
        tell: Callable[[str], None],
    ) -> None:
        self.row, self.source, self.sink = row, source, sink
        self._types, self._convert, self._timeout = types, convert, timeout
        self._type = row.ros1_type if source is Side.ROS1 else row.ros2_type
        self._told: set[str] = set()
        self._tell = tell

    @property
    def name(self) -> str:
        """Name of the topic with its side, for people."""
        return f"{self.source.words} {self.row.name(self.source)}"

    def warm_up(self) -> None:
        """Have the codecs made, which takes long: the first command must not wait for them."""
        message = self._types.make(self._type)
        self._convert(self._types.decode(self._types.encode(message), self._type))

    def take(self, data: bytes, sender: object, node: str, *, old: bool = False) -> None:
        """Pass on a serialized message of `sender`, the identity of a publisher on `node`.

        `old` says that it may be older than its arrival says.
        """
        commands = self.row.commands
        if not (commands or self.row.latched or self.sink.matched):
            return
        try:
            message = self._types.decode(data, self._type)
        except ValueError as error:
            self._refuse(node, f"its bytes are no {self._type}: {error}")
            return
        to_robot = commands or self.row.to_robot
        if to_robot and (reason := self._objection(message, old=old)):
            self._refuse(node, reason)
            return
        made = self._convert(message)
        if commands:
            if (refusal := self.sink.drive(made, sender, node)) is not None:
                self._refuse(node, refusal.text)
        elif self.row.latched and self.row.ros1_type == TRANSFORMS:
            self.sink.write_fixed(made)
        else:
            self.sink.write(made)

    def left(self, sender: object, node: str, *, last: bool) -> None:
        """Take note that a publisher is gone; `last` says whether there is no other."""
        if self.sink.lose(sender):
            self._tell(f"{node or 'a publisher'}, which drove by {self.name}, is gone: stops")
        if last and self.row.when_lost is not None:
            self.sink.write_content(self.row.when_lost)

    def _objection(self, message: Any, *, old: bool) -> str:
        """Return the reason not to pass on a command or a goal; empty for none."""
        if old:
            return "a latched command from before this bridge, or before a broken connection"
        commands = self.row.commands
        if commands and not is_finite(message):
            return "numbers that are not finite"
        if hasattr(message, "header"):
            stamp = message.header.stamp
            moment = nanoseconds(stamp)
            age = (time.time_ns() - moment) / NANO
            if moment and age > (self._timeout if commands else OLDEST_GOAL):
                return (
                    f"its stamp is {age:.1f} s old: the network is slow, or the clocks of the"
                    " computers differ (set both by NTP)"
                )
        return ""

    def _refuse(self, node: str, reason: str) -> None:
        if reason.partition(":")[0] not in self._told and len(self._told) < WAITING:
            self._told.add(reason.partition(":")[0])
            self._tell(f"{self.name} of {node or 'an unknown node'} is not passed on: {reason}")


class Inbox:
    """Hands things over from any thread to `take` in the loop; of many the newest `length` stay."""

    def __init__(
        self, take: Callable[..., None], loop: asyncio.AbstractEventLoop, length: int = WAITING
    ) -> None:
        self._take = take
        self._items: deque[tuple[object, ...]] = deque(maxlen=length)
        self._lock = threading.Lock()
        self._loop = loop

    def put(self, *item: object) -> None:
        """Hand something over."""
        with self._lock:
            waiting = bool(self._items)
            self._items.append(item)
        if not waiting:
            with suppress(RuntimeError):  # the loop has ended
                self._loop.call_soon_threadsafe(self._drain)

    def _drain(self) -> None:
        with self._lock:
            items = list(self._items)
            self._items.clear()
        for item in items:
            try:
                self._take(*item)
            except Exception:  # the next one may be a zero
                log.exception("a message over the bridge is lost")
