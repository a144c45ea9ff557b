"""Other robots of a group, as one of them knows them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import hypot

from pioneer3.geometry import STILL, Pose2, Twist2, arc

LOST = 1.0
"""Where a robot is that has said nothing for so long is not known any more [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Peer:
    """Another robot.

    Attributes:
        pose: Where it was, in this robot's odometry frame [m, rad].
        length: Twice from its middle to its farther end [m].
    """

    name: str
    pose: Pose2
    stamp: float
    twist: Twist2 = STILL
    length: float = 0.63
    width: float = 0.5

    @property
    def radius(self) -> float:
        """From its middle to its farthest corner [m]."""
        return hypot(self.length, self.width) / 2

    def at(self, now: float) -> Pose2:
        """Return where it is expected at `now`, if it goes on as it did; for `LOST` at most."""
        passed = min(max(now - self.stamp, 0.0), LOST)
        return self.pose @ arc(self.twist.v, self.twist.w, passed)

    def is_lost(self, now: float) -> bool:
        """Return whether it has been silent for too long."""
        return now - self.stamp > LOST


Peers = Callable[[], Sequence[Peer]]
"""Returns the other robots of which it is known where they are, or were."""


def named(peers: Sequence[Peer], name: str) -> Peer | None:
    """Return the peer of this name, or `None`."""
    return next((peer for peer in peers if peer.name == name), None)
