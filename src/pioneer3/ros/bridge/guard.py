"""Velocity commands over a bridge: who drives, and when the other side must be told to stand. Pure.

1. A command lasts for the timeout. Where no other follows, a zero does.
2. A publisher that leaves while it drives is followed by a zero at once.
3. A stream that fell silent and goes on is the old one: it waits until it has come steadily, or is
   refused until it has a zero, as the robot's node would do if that zero were not between them.
4. A publisher that left while it drove and is back, as after a broken network, is refused until it
   has a zero. A program that was started again is another publisher.
5. A bridge that ends while somebody drives sends a zero first.
"""

from collections import OrderedDict
from collections.abc import Iterator
from math import inf, isfinite
from typing import Any, Final

from pioneer3.errors import Refusal
from pioneer3.geometry import Twist2
from pioneer3.ros.node.command_order import CommandStream
from pioneer3.stops import LET_GO, NO_STOP

REMEMBERED: Final = 64
"""Publishers that are remembered."""
ZERO: Final = object()
"""In the place of a message: the robot is to stand."""


class CommandGuard:
    """Decides which commands are passed on, and when a zero must be.

    Args:
        timeout: How long a command lasts [s]; `inf` until the next one.
        resumes: Whether a stream that fell silent goes on by itself.
    """

    def __init__(self, timeout: float, *, resumes: bool = True) -> None:
        self._timeout = timeout
        self._resumes = resumes
        self._streams: OrderedDict[object, CommandStream] = OrderedDict()
        self._waiting: dict[object, Any] = {}
        self._moving: set[object] = set()
        self._cut_off: OrderedDict[object, None] = OrderedDict()
        self._driver: object = None
        self._until = inf

    @property
    def deadline(self) -> float:
        """When :meth:`due` must be called [s, as every `now`]."""
        return min(self._until, *(each.deadline for each in self._streams.values()), inf)

    def take(self, message: Any, sender: object, node: str, now: float) -> Refusal | None:
        """Take a command that came at `now`.

        Of :meth:`due` it comes again where it is to be passed on, at once or a little later.
        """
        if sender in self._cut_off:
            if moves(message):
                return Refusal(f"{node} left while it drove; {LET_GO}")
            del self._cut_off[sender]
        if sender not in self._streams:
            self._streams[sender] = CommandStream(node, self._timeout, resumes=self._resumes)
            while len(self._streams) > REMEMBERED:
                gone, _ = self._streams.popitem(last=False)
                self._waiting.pop(gone, None)
                self._moving.discard(gone)
        (self._moving.add if moves(message) else self._moving.discard)(sender)
        self._streams.move_to_end(sender)
        stream = self._streams[sender]
        contested = self._driver is not None and self._driver != sender
        refusal = stream.take(twist_of(message), now, NO_STOP, contested=contested)
        if refusal is None:
            self._waiting[sender] = message
        else:
            self._waiting.pop(sender, None)
        return refusal

    def left(self, sender: object) -> object | None:
        """Return :data:`ZERO` if `sender`, which is gone, drives."""
        self._streams.pop(sender, None)
        self._waiting.pop(sender, None)
        if sender in self._moving:
            self._moving.discard(sender)
            self._cut_off[sender] = None
            while len(self._cut_off) > REMEMBERED:
                self._cut_off.popitem(last=False)
        return self._stop() if self._driver == sender and self._drives else None

    def due(self, now: float) -> Iterator[Any]:
        """Yield each message that is to be passed on now, and :data:`ZERO` when one has expired."""
        for sender, message in list(self._waiting.items()):
            stream = self._streams[sender]
            if stream.waits and stream.due(now, NO_STOP) is None:
                continue
            del self._waiting[sender]
            moving = moves(message)
            self._driver = sender if moving else None
            self._until = now + self._timeout if moving else inf
            yield message
        if now >= self._until:
            yield self._stop()

    def end(self) -> object | None:
        """Return :data:`ZERO` if somebody drives, as the bridge ends."""
        self._waiting.clear()
        return self._stop() if self._drives else None

    @property
    def _drives(self) -> bool:
        return self._driver is not None

    def _stop(self) -> object:
        self._driver, self._until = None, inf
        return ZERO


def twist_of(message: Any) -> Twist2:
    """Return the motion in the plane that a Twist or TwistStamped asks for."""
    twist = getattr(message, "twist", message)
    return Twist2(twist.linear.x, twist.angular.z)


def components(message: Any) -> Iterator[float]:
    """Yield all numbers of a Twist, or of the one in a TwistStamped."""
    twist = getattr(message, "twist", message)
    for part in (twist.linear, twist.angular):
        yield from (part.x, part.y, part.z)


def is_finite(message: Any) -> bool:
    """Return whether a Twist or TwistStamped has finite numbers only."""
    return all(map(isfinite, components(message)))


def moves(message: Any) -> bool:
    """Return whether a Twist or TwistStamped asks for a motion."""
    return any(components(message))
