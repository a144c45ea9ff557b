"""Clients that are sent the same texts: about all robots, or about one."""

from collections.abc import Iterator

from pioneer3.web import messages
from pioneer3.web.access.sessions import LoginSession, Role
from pioneer3.web.broadcast import Channel, FrameChannel, RetainedChannel, ScanChannel, Subscriber

SMALL_PERIOD = 0.18
"""Least time between two frames of small snapshots [s]."""


class Audience:
    """Clients that see the same robots, or one robot alone, each text made once for all of them.

    They may belong to the student of that robot, or get small snapshots, as the teacher's page of a
    class does. `retained` has the robots, their connections, and the map.
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


class Audiences:
    """The audiences of a page, of which the first sees all robots."""

    def __init__(self) -> None:
        self.first = Audience()
        self._all = [self.first]

    def __iter__(self) -> Iterator[Audience]:
        return iter(self._all)

    def add(self, audience: Audience) -> None:
        """Let clients belong to `audience`."""
        self._all.append(audience)

    def find(
        self, session: LoginSession, *, robot: int | None = None, small: bool = False
    ) -> Audience:
        """Return the audience of a client that asks for one robot, or for small snapshots.

        A student's is always that of the own robot.
        """
        student = session.role is Role.STUDENT
        kind = (session.robot, True, False) if student else (robot, False, small)
        found = (each for each in self._all if (each.robot, each.student, each.small) == kind)
        chosen = next(found, None if student else self.first)
        assert chosen is not None
        return chosen

    def publish(self, robot: int, kind: str, message: messages.Message | None) -> None:
        """Tell a state of a robot to all that see it whole; `None` drops the last one."""
        key = f"{kind} {robot}"
        text = "" if message is None else messages.encode(message)
        for audience in self._all:
            if message is None:
                audience.retained.forget(key)
            elif audience.sees(robot) and not audience.small:
                audience.put(key, text)
