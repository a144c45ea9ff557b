"""In which order commands count that come to one robot on several topics. Pure."""

from math import inf
from typing import NamedTuple

from pioneer3.geometry import STILL, Twist2

WAIT = 0.005
"""A zero to all robots waits this long [s] for the command to this one that goes with it."""
LATE = 0.02
"""A zero to all robots that comes this soon [s] after such a command went before it."""


class Single(NamedTuple):
    """A message that has not found its partner: from whom, when it arrived [s]."""

    sender: str
    at: float


class NewestCommand:
    """Lets the command decide that arrived last, whatever topic it came on.

    The lab's keys for several robots send a zero to all robots and at once the command to one of
    them. Connections swap such pairs: 16 % of them with rospy, and then the robot stands. So:

    1. A zero to all waits for :data:`WAIT`. What arrives in this time takes its place.
    2. A command to this robot and a zero to all of the same sender belong together, in whatever
       order they come, if the zero arrived less than `WAIT` before it or :data:`LATE` after it. The
       zero is none then. Each has one such partner at most.
    3. All else decides at once, unless something newer has. A newer zero of anybody else is never
       dropped.

    Attributes:
        deadline: When :meth:`due` must be called [s, as every `now`].
    """

    def __init__(self) -> None:
        self.deadline = inf
        self._newest = -inf
        self._zero: Single | None = None
        self._alone: Single | None = None

    def take(self, twist: Twist2, now: float, *, sender: str, shared: bool) -> Twist2 | None:
        """Return what to do now, or `None` for nothing, or nothing yet.

        Args:
            twist: What is asked for.
            now: When it arrived; what was slow on its way to us may come after newer ones.
            sender: Who asked.
            shared: Whether all robots were asked.
        """
        single = Single(sender, now)
        if shared and twist.is_zero:
            self._wait(single)
            return None
        partner = not shared and not twist.is_zero and _belong_together(self._zero, single)
        if now < self._newest and not partner:
            return None
        self.deadline, self._newest, self._zero = inf, max(self._newest, now), None
        self._alone = None if shared or twist.is_zero or partner else single
        return twist

    def due(self, now: float) -> Twist2 | None:
        """Return the zero that has waited long enough, or `None`."""
        if now < self.deadline:
            return None
        self.deadline, self._alone = inf, None
        return STILL

    def _wait(self, zero: Single) -> None:
        """Take a zero to all."""
        if _belong_together(zero, self._alone):
            self._alone = None
        elif zero.at >= self._newest:
            self._newest, self._zero = zero.at, zero
            self.deadline = min(self.deadline, zero.at + WAIT)


def _belong_together(zero: Single | None, command: Single | None) -> bool:
    if zero is None or command is None or zero.sender != command.sender:
        return False
    return -WAIT < zero.at - command.at < LATE
