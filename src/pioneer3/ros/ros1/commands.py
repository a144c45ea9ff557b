"""Commands from ROS 1 topics to the robot. rospy's threads end at one hand-over to the loop."""

import asyncio
import threading
from collections import OrderedDict, deque
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from math import inf, isfinite
from operator import attrgetter
from typing import Any, Final, NamedTuple

from pioneer3.behaviors.actions import Hold
from pioneer3.errors import CommandError
from pioneer3.geometry import Twist2
from pioneer3.ros.interface.lab import CommandTopic
from pioneer3.ros.interface.newest_command import NewestCommand
from pioneer3.ros.interface.sender import Sender
from pioneer3.ros.messages import convert
from pioneer3.ros.ros1.messages import message_class
from pioneer3.runtime.priorities import PROGRAM
from pioneer3.runtime.robot import Robot
from pioneer3.stops import Stop

QUEUE: Final = 10
"""Messages that wait in a connection; dropping one would tear a zero from its command."""
PENDING: Final = 100
"""Commands that wait for the loop."""
REMEMBERED: Final = 64
"""Publishers, the last ones."""


class Order(NamedTuple):
    """A message as it arrived: on which topic, over which connection, when [s]."""

    message: Any
    shared: bool
    connection: Mapping[str, str]
    at: float

    @property
    def sender(self) -> str:
        """The node that sent it."""
        return self.connection.get("callerid", "")


class Commands:
    """Drives `robot` as the messages on its command topics say.

    Args:
        robot: Connected.
        topics: To listen to.
        timeout: How long a message lasts [s]; `inf` until the next one.
        warn: Given a sentence when a message is refused.
    """

    def __init__(
        self,
        robot: Robot,
        topics: Iterable[CommandTopic],
        timeout: float,
        warn: Callable[[str], None],
    ) -> None:
        self._robot = robot
        self._topics = tuple(topics)
        self._timeout = timeout
        self._warn = warn
        self._hold = Hold("cmd_vel")
        self._newest = NewestCommand()
        self._senders: OrderedDict[int, tuple[object, Sender]] = OrderedDict()
        self._refusal: str | None = None
        self._told: str | None = None
        self._pending: deque[Order] = deque(maxlen=PENDING)
        self._lock = threading.Lock()
        self._loop = asyncio.get_running_loop()
        self._timer: asyncio.TimerHandle | None = None
        self._expiry: asyncio.TimerHandle | None = None
        self._expired_of: deque[str] = deque(maxlen=REMEMBERED)

    def subscribe(self) -> None:
        """Listen; called in a thread: it talks to the master."""
        import rospy  # noqa: PLC0415

        kind, known = message_class("geometry_msgs/Twist"), set()
        for topic in self._topics:
            name = rospy.resolve_name(topic.name)
            if name not in known:
                known.add(name)
                rospy.Subscriber(
                    name,
                    kind,
                    self._receive,
                    callback_args=topic.shared,
                    queue_size=QUEUE,
                    tcp_nodelay=True,
                )

    def begin(self) -> None:
        """Take part in driving."""
        self._robot.arbiter.add(self._hold, PROGRAM)

    def end(self) -> None:
        """Drive no more."""
        for timer in (self._timer, self._expiry):
            if timer is not None:
                timer.cancel()
        self._robot.arbiter.remove(self._hold)

    def _receive(self, message: Any, shared: bool) -> None:
        """Take a Twist in rospy's thread; those that come together wake the loop once."""
        at = self._loop.time()
        with self._lock:
            waiting = bool(self._pending)
            self._pending.append(Order(message, shared, message._connection_header, at))
        if not waiting:
            with suppress(RuntimeError):  # the loop has ended, and with it the robot's motion
                self._loop.call_soon_threadsafe(self._drive)

    def _drive(self) -> None:
        with self._lock:
            orders = sorted(self._pending, key=attrgetter("at"))
            self._pending.clear()
        self._refusal, now = None, self._loop.time()
        decided: list[tuple[str, Twist2 | None]] = []
        for order in orders:
            decided.append(("", self._newest.due(order.at)))
            decided.append((order.sender, self._understand(order)))
        decided.append(("", self._newest.due(now)))
        for _, sender in self._senders.values():
            decided.append((sender.name, sender.due(now, self._last_stop)))
        wanted = [(name, twist) for name, twist in decided if twist is not None][-1:]
        for name, twist in wanted:
            self._hold.release()  # the sender knows whether this counts
            self._refusal = self._robot.arbiter.hold(self._hold, twist, self._timeout)
            self._expect_more(name, twist)
        if orders:
            self._tell()
        self._wait()

    @property
    def _last_stop(self) -> Stop:
        return self._robot.arbiter.last_stop

    def _understand(self, order: Order) -> Twist2 | None:
        """Return what to do because of one message, if anything."""
        try:
            twist = convert.wanted_twist(order.message)
        except CommandError as error:
            self._refusal = str(error)
            return None
        sender = self._sender(order)
        self._refusal = sender.take(twist, order.at, self._last_stop)
        if self._refusal is not None or sender.waits:
            return None
        return self._newest.take(twist, order.at, sender=order.sender, shared=order.shared)

    def _sender(self, order: Order) -> Sender:
        """Return the record of the publisher at the other end of the connection."""
        key = id(order.connection)
        if key not in self._senders:
            self._senders[key] = (order.connection, Sender(order.sender, self._timeout))
        self._senders.move_to_end(key)
        while len(self._senders) > REMEMBERED:
            self._senders.popitem(last=False)
        return self._senders[key][1]

    def _wait(self) -> None:
        """Look again when a command that waits is due."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        deadlines = (sender.deadline for _, sender in self._senders.values())
        deadline = min(self._newest.deadline, *deadlines, inf)
        if isfinite(deadline):
            self._timer = self._loop.call_at(deadline, self._drive)

    def _expect_more(self, sender: str, twist: Twist2) -> None:
        """Look whether `sender` has fallen silent when its command expires."""
        if self._expiry is not None:
            self._expiry.cancel()
            self._expiry = None
        if isfinite(self._timeout) and not twist.is_zero:
            self._expiry = self._loop.call_later(self._timeout, self._expired, sender)

    def _expired(self, sender: str) -> None:
        """Say why the robot stops, once for each sender; another stop has its own reason."""
        stopped = self._hold.ignored(self._last_stop) is not None
        if stopped or self._robot.snapshot is None or sender in self._expired_of:
            return
        self._expired_of.append(sender)
        self._warn(
            f"cmd_vel of {sender} has expired: nothing came for {self._timeout:g} s, so the robot"
            " stops. A program that sends more rarely needs a longer ~cmd_vel_timeout, such as"
            " _cmd_vel_timeout:=1.5; with 0, which is unsafe, its last command lasts for ever"
        )

    def _tell(self) -> None:
        """Say why commands are ignored, once."""
        if self._refusal is not None and self._refusal != self._told:
            self._warn(f"cmd_vel is ignored: {self._refusal} (a zero lets go)")
        self._told = self._refusal
