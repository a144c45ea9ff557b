"""What has stopped the robot, and which command may move it again. Pure.

Rules:

1. Whatever stops the robot is a :class:`Stop` with a number of its own: a stop by somebody, the
   emergency stop and its reset, a stall, the robot's stop button, motors that went off or do not
   come on, a lost link and its return, a program that slept.
2. A command moves the robot only if it *began* after the last stop. One that was held all the time
   has to be let go of first. :class:`~pioneer3.behaviors.actions.Hold` knows when a command began.
3. After a stall, a command also begins when it :func:`leads_away` from the one before: nobody has
   to let go to leave a wall. The way back into it then begins anew, too.
"""

from dataclasses import dataclass

from pioneer3.geometry import Twist2

LET_GO = "let go, then ask again"
LEAVE = "drive the other way or turn on the spot, or let go and ask again"


@dataclass(frozen=True, slots=True)
class Stop:
    """The last thing that stopped the robot.

    Attributes:
        number: Counts up with each stop.
        why: In a few words, for people.
        stalled: The command that the wheels stalled under, or `None` if this is no stall.
    """

    number: int = 0
    why: str = "nothing has been asked since the start"
    stalled: Twist2 | None = None

    @property
    def told(self) -> str:
        """Why a command is ignored, and how to be obeyed again."""
        return f"{self.why}; {LET_GO if self.stalled is None else LEAVE}"


NO_STOP = Stop()


def leads_away(twist: Twist2, before: Twist2) -> bool:
    """Return whether `twist` leaves the direction of `before`.

    It does with the other sign of speed, and as a turn on the spot; from a turn on the spot with
    the other sign of turn rate, and as a drive.
    """
    if twist.is_zero or before.is_zero:
        return False
    if twist.v == 0.0 == before.v:
        return twist.w * before.w < 0
    return twist.v * before.v <= 0
