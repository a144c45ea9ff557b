"""Order of commands from several publishers, and from one after a silence. Pure."""

from collections import deque
from math import inf, isfinite
from statistics import median
from typing import Final, NamedTuple

from pioneer3.behaviors.actions import Hold
from pioneer3.errors import Refusal
from pioneer3.geometry import STILL, Twist2
from pioneer3.stops import Stop, leads_away

WAIT: Final = 0.01
"""A zero to all robots waits this long [s] for the command to this one that goes with it."""
LATE: Final = 0.05
"""A zero to all robots that comes this soon [s] after such a command went before it."""
FEWEST: Final = 3
"""As many commands in a row make a stream."""
SLOWEST: Final = 0.2
"""A stream with a longer period [s] looks like a person who presses a key again."""
ROOM: Final = 1.5
"""How much longer than its period the pause within a stream may be."""
STEADY: Final = 0.3
"""A stream that fell silent goes on after it has come steadily for this long [s]."""


class Unpaired(NamedTuple):
    """A command without its partner: its sender, and when it arrived [s]."""

    sender: str
    at: float


class NewestCommand:
    """Lets the last command to arrive decide, whatever topic it came on.

    The lab's keys for several robots send a zero to all robots and at once the command to one of
    them. Connections swap such pairs: 16 % of them with rospy, and then the robot stands. So:

    1. A zero to all waits for :data:`WAIT`. A command that arrives in this time takes its place.
    2. A zero to all that arrives less than :data:`LATE` after a command to this robot, from the
       same sender, belongs to it and is dropped, unless another zero does already.
    3. Any other command decides at once. A later zero of anybody else is never dropped.

    Attributes:
        deadline: When :meth:`due` must be called [s, as every `now`].
    """

    def __init__(self) -> None:
        self.deadline = inf
        self._zero: Unpaired | None = None
        self._alone: Unpaired | None = None

    def take(self, twist: Twist2, now: float, *, sender: str, shared: bool) -> Twist2 | None:
        """Return the motion to begin now, or `None` for none yet; :meth:`due` comes first.

        Commands are given in the order of their arrival; one that is `shared` is to all robots.
        """
        command = Unpaired(sender, now)
        if shared and twist.is_zero:
            alone = self._alone
            if alone and alone.sender == sender and now - alone.at < LATE:
                self._alone = None
            else:
                self._zero, self.deadline = command, min(self.deadline, now + WAIT)
            return None
        paired = self._zero is not None and self._zero.sender == sender
        self.deadline, self._zero = inf, None
        self._alone = None if shared or twist.is_zero or paired else command
        return twist

    def due(self, now: float) -> Twist2 | None:
        """Return the zero that has waited long enough, or `None`."""
        if now < self.deadline:
            return None
        self.deadline, self._zero, self._alone = inf, None, None
        return STILL


class CommandStream:
    """The commands of one publisher, over one connection.

    A publisher that was frozen, or cut off, goes on with its old stream. A person who presses a key
    again looks the same for one command. So the first command after a silence waits for the next
    one, a little longer than the stream's period: if one comes in this time, it is the old stream,
    which is ignored until it has a zero or leads away.

    If streams resume, one also goes on when it has come steadily for :data:`STEADY`: nobody else
    drove, no pause was long, and no more came in this time than the stream's period allows, as when
    a queue of old commands is delivered at once. A stop for any other reason still counts.

    A command lasts for `timeout` [s], `inf` until the next one.

    Attributes:
        deadline: When :meth:`due` must be called [s, as every `now`].
        resumed: Whether the stream goes on with the last command.
    """

    def __init__(self, name: str, timeout: float, *, resumes: bool) -> None:
        self.deadline = inf
        self.resumed = False
        self._timeout = timeout
        self._resumes = resumes
        self._settles = False
        self._hold = Hold(name, streams=isfinite(timeout))
        self._pauses: deque[float] = deque(maxlen=5)
        self._period = 0.0
        self._steady_since = -inf
        self._recent: deque[float] = deque()
        self._twist = STILL
        self._at = -inf

    @property
    def waits(self) -> bool:
        """Whether the last command waits until it is clear that it is not an old one."""
        return isfinite(self.deadline) or self._settles

    def take(self, twist: Twist2, now: float, last: Stop, *, contested: bool) -> Refusal | None:
        """Take a command, unless it is ignored after the stop `last`.

        `contested` tells whether another publisher drives.
        """
        came_back, pause = self._hold.fell_silent(now), now - self._at
        leaves = twist.is_zero or leads_away(twist, self._twist)
        self._twist, self._at, self.resumed = twist, now, False
        steady = self._is_steady(pause, now, contested=contested)
        if came_back and not self.waits and not leaves:
            if self._is_stream():
                self._period = median(self._pauses)
                self.deadline = now + ROOM * self._period
                return None
            self._hold.release()
        self.deadline = inf
        if pause < self._timeout and not twist.is_zero:
            self._pauses.append(pause)
        else:
            self._pauses.clear()
        self._hold.set(twist, now, self._timeout, last)
        self._settles = self._resumes and bool(self._hold.freshness.silent) and not contested
        if self._settles and steady:
            self._hold.freshness.silent = None
            self._settles, self.resumed = False, True
        return None if self._settles else self._hold.ignored(last)

    def due(self, now: float, last: Stop) -> Twist2 | None:
        """Return the command that has turned out to be a new one, if any."""
        if now < self.deadline:
            return None
        self.deadline = inf
        self._pauses.clear()
        self._hold.release()
        self._hold.set(self._twist, now, self._timeout, last)
        return self._twist

    def _is_steady(self, pause: float, now: float, *, contested: bool) -> bool:
        """Return whether commands have come for :data:`STEADY` in the stream's own time."""
        if contested or pause >= min(self._timeout, ROOM * SLOWEST):
            self._steady_since = now
        self._recent.append(now)
        while self._recent[0] <= now - STEADY:
            self._recent.popleft()
        is_burst = len(self._recent) * self._period > ROOM * STEADY + self._period
        return now - self._steady_since >= STEADY and not is_burst

    def _is_stream(self) -> bool:
        return len(self._pauses) >= FEWEST - 1 and median(self._pauses) <= SLOWEST
