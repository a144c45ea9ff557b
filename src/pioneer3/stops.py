"""Stops of the robot, and the rule for commands after one. Pure.

Rules:

1. Each of these is a :class:`Stop` with a number of its own: a stop by a user or program, the
   emergency stop and its reset, a stall, the robot's stop button, motors that went off or do not
   come on, a lost link and its return, a program that was suspended.
2. A command moves the robot only if it *began* after the last stop. A command that is held all the
   time must be released first. :class:`~pioneer3.behaviors.actions.Hold` knows its beginning.
3. After a stall, a command also begins when it :func:`leads_away` from the one before: no release
   is needed to leave a wall. A command back into the wall then begins anew, too.
"""

from dataclasses import dataclass

from pioneer3.errors import Refusal
from pioneer3.geometry import Twist2

LET_GO = "let go, then ask again"
LEAVE = "drive the other way or turn on the spot, or let go and ask again"


@dataclass(frozen=True, slots=True)
class Stop:
    """A stop of the robot.

    Attributes:
        number: Counts up with each stop.
        why: The reason in a few words, for people.
        stalled: The command during which the wheels stalled, or `None` if this is no stall.
    """

    number: int = 0
    why: str = "nothing has been asked since the start"
    stalled: Twist2 | None = None

    @property
    def told(self) -> Refusal:
        """The refusal of a command that began before, with advice for the next one."""
        return Refusal(f"{self.why}; {LET_GO if self.stalled is None else LEAVE}")


NO_STOP = Stop()


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
