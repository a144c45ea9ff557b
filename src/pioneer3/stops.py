"""Stops of the robot, and the rule for commands after one. Pure.

A command counts if it began after the last :class:`Stop`; :class:`Freshness` decides this for all
commands, of inputs, programs and modes:

| after                                  | held on     | let go, again | other way | a mode  |
|----------------------------------------|-------------|---------------|-----------|---------|
| stalled wheels, a bumper held for 2 s  | ignored     | obeyed        | obeyed    | answers |
| somebody else's stop, the motor switch | ignored     | obeyed        | ignored   | ends    |
| emergency stop and reset, stop button  | ignored     | obeyed        | ignored   | ends    |
| a lost link and its return, motors off | ignored     | obeyed        | ignored   | ends    |
| a raw command, a program that slept    | ignored     | obeyed        | ignored   | ends    |
| silence of the page that drove         | ignored     | obeyed        | obeyed    |         |
| silence of the publisher that drove    | once steady | obeyed        | obeyed    |         |
| an input that comes first              | ignored     | obeyed        | ignored   |         |

1. Let go is what was released or set to zero; a single command also by silence, which
   :class:`~pioneer3.behaviors.actions.Hold` knows. A stream that falls silent has failed instead.
2. A turn on the spot is another way, too (:func:`leads_away`). The way back counts as new then.
3. A publisher of ROS is steady after 0.3 s (:mod:`pioneer3.ros.node.command_order`).
4. A mode answers a stall if it frees the wheels; else it ends, as a single motion always does.
"""

from dataclasses import dataclass
from typing import Final

from pioneer3.errors import Refusal
from pioneer3.geometry import Twist2

LET_GO: Final = "let go, then ask again"
LEAVE: Final = "drive the other way or turn on the spot, or let go and ask again"


@dataclass(frozen=True, slots=True)
class Stop:
    """A stop of the robot, its number, and the reason in a few words for people.

    Attributes:
        stalled: The command during which the wheels stalled, or `None` if this is no stall.
    """

    number: int = 0
    why: str = "nothing has been asked since the start"
    stalled: Twist2 | None = None

    @property
    def told(self) -> Refusal:
        """The refusal of a command that began before, with advice for the next one."""
        return Refusal(f"{self.why}; {LET_GO if self.stalled is None else LEAVE}")

    def outdates(self, after: int) -> bool:
        """Return whether this came after what began `after` the stop of that number."""
        return after < self.number


NO_STOP: Final = Stop()


@dataclass(slots=True)
class Freshness:
    """Tells whether a command counts, from when it began and what came between.

    Attributes:
        began_after: Number of the last stop when it began.
        answered_after: The same when it last began, led away, or freed the wheels.
        silent: The reason to ignore it until it is answered or resumes, or `None`.
        overruled: The reason to ignore it for good, or `None`.
    """

    began_after: int = 0
    answered_after: int = 0
    silent: str | None = None
    overruled: str | None = None

    @classmethod
    def new(cls, last: Stop) -> "Freshness":
        """Return that of a command that begins after the stop `last`."""
        return cls(last.number, last.number)

    def answer(self, last: Stop) -> None:
        """Lead away from what was in the way, or free the wheels, after the stop `last`."""
        self.answered_after, self.silent = last.number, None

    def ignored(self, last: Stop) -> Refusal | None:
        """Return the refusal of the command after the stop `last`, or `None`."""
        if why := self.overruled or self.silent:
            return Refusal(f"{why}; {LET_GO}")
        since = self.began_after if last.stalled is None else self.answered_after
        return last.told if last.outdates(since) else None


def leads_away(twist: Twist2, before: Twist2) -> bool:
    """Return whether `twist` leaves the direction of `before`.

    A twist leaves a drive if its speed has the other sign or is zero. It leaves a turn on the spot
    if its turn rate has the other sign or its speed is not zero.
    """
    if twist.is_zero or before.is_zero:
        return False
    if twist.v == 0.0 == before.v:
        return twist.w * before.w < 0
    return twist.v * before.v <= 0
