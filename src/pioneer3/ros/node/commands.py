"""Commands from topics to the robot; threads of the middleware hand them over to the loop."""

import asyncio
import threading
from collections import OrderedDict, deque
from collections.abc import Callable, Iterable
from functools import partial
from math import inf, isfinite
from typing import Any, Final, NamedTuple

from pioneer3.behaviors.actions import Hold
from pioneer3.errors import CommandError, Refusal
from pioneer3.geometry import STILL, Twist2
from pioneer3.ros.node.command_order import CommandStream, NewestCommand
from pioneer3.ros.node.middleware import QUEUE, Middleware, Sender
from pioneer3.ros.node.names import CommandName
from pioneer3.ros.node.topics import COMMANDS, STAMPED_COMMANDS
from pioneer3.runtime.arbiter import PROGRAM
from pioneer3.runtime.robot import Robot
from pioneer3.stops import Stop
from pioneer3.tasks import hand_over

PENDING: Final = 100
"""Commands that wait for the loop."""
WARNINGS = 5
"""Warnings of refused commands at most."""
WARNED_WITHIN = 10.0
"""Time within which there are so many [s]."""
REMEMBERED: Final = 64
"""Publishers that are remembered."""


class ReceivedMessage(NamedTuple):
    """A message: the topic that it came on, its sender, when it came [s]."""

    message: Any
    topic: CommandName
    sender: Sender
    at: float


class Commands:
    """Drives a connected robot by the messages on its command topics.

    A message lasts for `timeout` [s], `inf` until the next one. With `resumes` a stream that fell
    silent goes on by itself. `warn` is given a sentence when a message is refused.
    """

    def __init__(
        self, robot: Robot, timeout: float, *, resumes: bool, warn: Callable[[str], None]
    ) -> None:
        self._robot = robot
        self._timeout = timeout
        self._resumes = resumes
        self._warn = warn
        self._hold = Hold("cmd_vel")
        self._newest = NewestCommand()
        self._streams: OrderedDict[int, tuple[Sender, CommandStream]] = OrderedDict()
        self._age: Callable[[Any], float | None] = lambda stamp: None
        self._source: object = None  # connection of the publisher that drives
        self._refusal: Refusal | None = None
        self._told: Refusal | None = None
        self._warned_at = deque([-inf] * WARNINGS, maxlen=WARNINGS)
        self._pending: deque[ReceivedMessage] = deque(maxlen=PENDING)
        self._lock = threading.Lock()
        self._loop = asyncio.get_running_loop()
        self._loop_thread = threading.get_ident()
        self._timer: asyncio.TimerHandle | None = None
        self._expiry: asyncio.TimerHandle | None = None
        self._expected: tuple[float, str] | None = None  # the end of the last command, and its node
        self._expired_of: deque[str] = deque(maxlen=REMEMBERED)
        self._resumed_of: deque[str] = deque(maxlen=REMEMBERED)

    def subscribe(self, topics: Iterable[CommandName], middleware: Middleware) -> None:
        """Subscribe to `topics`, in a thread."""
        known = set()
        for topic in topics:
            name = middleware.resolve(topic.name)
            if name not in known:
                known.add(name)
                self._age = middleware.age
                row = STAMPED_COMMANDS if topic.stamped else COMMANDS
                middleware.subscribe(
                    topic.name,
                    row.type_name,
                    partial(self.receive, topic),
                    queue=QUEUE,  # to drop one would part a zero from its command
                    left=self.left,
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

    def receive(self, topic: CommandName, message: Any, sender: Sender) -> None:
        """Take a message, in any thread; those that come together wake the loop once."""
        with self._lock:
            waiting = bool(self._pending)
            self._pending.append(ReceivedMessage(message, topic, sender, self._loop.time()))
        if threading.get_ident() == self._loop_thread:
            self._drive()
        elif not waiting:
            hand_over(self._loop, self._drive)

    def left(self, sender: Sender) -> None:
        """Stop if this publisher, which is gone, drives; in any thread."""
        hand_over(self._loop, self._leave, sender)  # a loop that has ended has stopped the robot

    def _leave(self, sender: Sender) -> None:
        self._drive()  # its last messages come first
        self._streams.pop(id(sender.connection), None)
        if self._source is not sender.connection:
            return
        self._source = None
        self._robot.arbiter.hold(self._hold, STILL, self._timeout)
        self._expect_more(sender.node, STILL)
        self._warn(f"{sender.node}, which drove the robot by cmd_vel, is gone: the robot stops")

    def _drive(self) -> None:
        with self._lock:
            received = list(self._pending)
            self._pending.clear()
        self._refusal, now = None, self._loop.time()
        decided: list[tuple[Sender | None, Twist2 | None]] = []
        for each in received:
            decided.append((None, self._newest.due(each.at)))
            decided.append((each.sender, self._understand(each)))
        decided.append((None, self._newest.due(now)))
        for sender, stream in self._streams.values():
            decided.append((sender, stream.due(now, self._last_stop)))
        wanted = [(sender, twist) for sender, twist in decided if twist is not None][-1:]
        for by, twist in wanted:
            self._hold.release()  # its stream has decided that this counts
            self._refusal = self._robot.arbiter.hold(self._hold, twist, self._timeout)
            self._source = by.connection if by is not None and not twist.is_zero else None
            self._expect_more(by.node if by is not None else "", twist)
        if received:
            self._tell()
        self._wait()

    @property
    def _last_stop(self) -> Stop:
        return self._robot.arbiter.last_stop

    def _understand(self, received: ReceivedMessage) -> Twist2 | None:
        """Return the motion that one message asks for, or `None` for none yet."""
        topic, sender, at = received.topic, received.sender, received.at
        row = STAMPED_COMMANDS if topic.stamped else COMMANDS
        try:
            if topic.stamped:
                self._check_age(self._age(received.message.header.stamp))
            twist: Twist2 = row.content(received.message)
        except CommandError as error:
            self._refusal = Refusal(str(error))
            return None
        stream = self._stream(sender)
        contested = self._source is not None and self._source is not sender.connection
        self._refusal = stream.take(twist, at, self._last_stop, contested=contested)
        if self._refusal is not None or stream.waits:
            return None
        if stream.resumed and sender.node not in self._resumed_of:
            self._resumed_of.append(sender.node)
            self._warn(f"cmd_vel of {sender.node} comes steadily again: the robot goes on")
        return self._newest.take(twist, at, sender=sender.node, shared=topic.shared)

    def _check_age(self, age: float | None) -> None:
        """Refuse, by a CommandError, one that was stamped longer ago [s], or later, than it lasts.

        One from a clock that is ahead may be old, which its stamp cannot tell.
        """
        if age is None or abs(age) <= self._timeout:
            return
        if age > 0:
            raise CommandError(
                f"its stamp is {age:.1f} s old, more than cmd_vel_timeout: the network is slow, or"
                " the clocks of the computers differ (set both by NTP)"
            )
        raise CommandError(
            f"its stamp is {-age:.1f} s in the future: the clocks of the computers differ (set both"
            " by NTP)"
        )

    def _stream(self, sender: Sender) -> CommandStream:
        """Return the stream of the publisher at the other end of a connection."""
        key = id(sender.connection)
        if key not in self._streams:  # with the sender, so that no other object gets this id
            stream = CommandStream(sender.node, self._timeout, resumes=self._resumes)
            self._streams[key] = sender, stream
        self._streams.move_to_end(key)
        while len(self._streams) > REMEMBERED:
            self._streams.popitem(last=False)
        return self._streams[key][1]

    def _wait(self) -> None:
        """Look again when a command that waits is due."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        deadlines = (stream.deadline for _, stream in self._streams.values())
        deadline = min(self._newest.deadline, *deadlines, inf)
        if isfinite(deadline):
            self._timer = self._loop.call_at(deadline, self._drive)

    def _expect_more(self, sender: str, twist: Twist2) -> None:
        """Look whether `sender` has fallen silent when its command expires."""
        self._expected = None
        if isfinite(self._timeout) and not twist.is_zero:
            self._expected = self._loop.time() + self._timeout, sender
            if self._expiry is None:
                self._look_for_more()

    def _look_for_more(self) -> None:
        """Wait for the end of the last command, however many come until then."""
        self._expiry = None
        if self._expected is not None:
            end, sender = self._expected
            if self._loop.time() < end:
                self._expiry = self._loop.call_at(end, self._look_for_more)
            else:
                self._expired(sender)

    def _expired(self, sender: str) -> None:
        """Log the reason of a stop, once for each sender; another stop has its own reason."""
        self._source = self._expected = None
        stopped = self._hold.ignored(self._last_stop) is not None
        if stopped or self._robot.snapshot is None or sender in self._expired_of:
            return
        self._expired_of.append(sender)
        self._warn(
            f"cmd_vel of {sender} has expired: nothing came for {self._timeout:g} s, so the robot"
            " stops. A program that sends more rarely needs a longer cmd_vel_timeout, such as 1.5;"
            " with 0, which is unsafe, its last command lasts for ever"
        )

    def _tell(self) -> None:
        """Log the reason to ignore commands, once, and few of them where they change quickly."""
        now = self._loop.time()
        if self._refusal is not None and self._refusal != self._told:
            if now - self._warned_at[0] < WARNED_WITHIN:
                return
            self._warned_at.append(now)
            self._warn(f"cmd_vel is ignored: {self._refusal} (a zero lets go)")
        self._told = self._refusal
