"""Clients that are sent the same texts: about all robots, or about one."""

from collections.abc import Iterable

from pioneer3.web import messages
from pioneer3.web.broadcast import Channel, FrameChannel, RetainedChannel, ScanChannel, Subscriber

SMALL_PERIOD = 0.18
"""Least time between two frames of small snapshots [s]."""


class Audience:
    """Clients that see the same robots, each text made once for all of them.

    Args:
        robot: The only robot they see; `None` for all.
        student: Whether they belong to the student of that robot.
        small: Whether they get small snapshots, as the teacher's page of a class does.

    Attributes:
        clients: The connected ones.
        retained: The robots, their connections, and the map.
        snapshots: The newest snapshots.
        scans: The newest sweeps of lasers.
        world: The changes of the world; `None` without one.
    """

    def __init__(
        self, robot: int | None = None, *, student: bool = False, small: bool = False
    ) -> None:
        self.robot = robot
        self.student = student
        self.small = small
        self.clients: set[Subscriber] = set()
        self.retained = RetainedChannel()
        self.snapshots = (
            FrameChannel(self.wake, messages.ClassRobots(()), SMALL_PERIOD)
            if small
            else FrameChannel(self.wake)
        )
        self.scans = ScanChannel(self.wake)
        self.world: Channel | None = None

    @property
    def is_limited(self) -> bool:
        """Whether others' robots are of little interest here."""
        return self.student or self.small

    def sees(self, robot: int) -> bool:
        """Whether it is told about a robot."""
        return self.robot in {None, robot}

    def wants(self, robot: int) -> bool:
        """Whether a client wants whole snapshots of a robot now."""
        return bool(self.clients) and not self.small and self.sees(robot)

    def put(self, key: str, text: str) -> None:
        """Send a text, and keep it for later clients until there is a newer one of this key."""
        if self.retained.put(key, text):
            self.wake()

    def forget(self, robot: int) -> None:
        """Drop the texts about a robot that is gone."""
        self.snapshots.forget(robot)
        self.scans.forget(robot)
        self.retained.forget(f"status {robot}")

    def wake(self) -> None:
        """Let all clients look for new texts."""
        for client in self.clients:
            client.wake()


def find_audience(
    audiences: Iterable[Audience],
    *,
    robot: int | None = None,
    student: bool = False,
    small: bool = False,
) -> Audience | None:
    """Return the audience of this kind, or `None`."""
    kind = (robot, student, small)
    return next(
        (each for each in audiences if (each.robot, each.student, each.small) == kind), None
    )
