"""The students of a class and their robots. No I/O, no clock.

Rules:

1. Each robot has one student at most. A student who joins gets the first free robot, and keeps it
   until the teacher frees it.
2. No two students have the same name; the second Anna is `Anna 2`.
3. A session joins once: when it joins again, it only changes the name.
4. A network address has one student at most, until the teacher lets several join from one. The
   cookie of the session cannot tell clients apart here: who throws it away is new. Behind one
   router or proxy all students have its address; that the teacher knows, and no program can tell.
5. The teacher pauses all robots, or some. To let all go on ends every pause; to let one go on while
   all are paused leaves the others paused.
"""

from collections.abc import Iterable
from dataclasses import dataclass

from pioneer3.errors import CommandError
from pioneer3.names import clean_name, free_name

ALL_PAUSED = "the teacher has paused all robots"
ONE_PAUSED = "the teacher has paused this robot"


@dataclass(frozen=True, slots=True)
class Student:
    """A student of a class, by the id of a session, who joined from a network address."""

    session: str
    name: str
    address: str = ""


class Roster:
    """The seats of a class: one for each robot, by number.

    Nobody else can join one that is `locked`, and several a `shared` one from one network address.
    """

    def __init__(self, robots: Iterable[int]) -> None:
        self.locked = self.shared = False
        self.all_paused = False
        self._students: dict[int, Student | None] = dict.fromkeys(robots)
        self._paused: set[int] = set()

    @property
    def robots(self) -> list[int]:
        """The numbers of the robots, in order."""
        return list(self._students)

    def join(self, session: str, name: str, address: str) -> int:
        """Give a session a robot, and return its number.

        Raises:
            CommandError: The name is empty, nobody else can join, from this address or at all, or
                no robot is free.
        """
        wanted = clean_name(name)
        if not wanted:
            raise CommandError("type your name: it is shown to your teacher")
        robot = self.robot_of(session)
        if robot is None:
            robot = self.free_robot(address)
        others = (who for number, who in self._students.items() if number != robot)
        taken = {who.name for who in others if who is not None}
        self._students[robot] = Student(session, free_name(wanted, taken), address)
        return robot

    def free(self, robot: int) -> Student | None:
        """Take the robot from its student; return the student, `None` if it had none."""
        student = self.student(robot)
        self._students[robot] = None
        return student

    def student(self, robot: int) -> Student | None:
        """Return the student of a robot, `None` if nobody has it.

        Raises:
            CommandError: The class has no such robot.
        """
        if robot not in self._students:
            raise CommandError(f"the class has no robot {robot}")
        return self._students[robot]

    def robot_of(self, session: str) -> int | None:
        """Return the robot of a session, or `None`."""
        students = self._students.items()
        return next((robot for robot, who in students if who and who.session == session), None)

    def pause(self, robot: int | None = None, *, paused: bool) -> None:
        """Pause a robot, or all without a number; or let them go on.

        Raises:
            CommandError: The class has no such robot.
        """
        if robot is None:
            self.all_paused = paused
            self._paused.clear()
            return
        self.student(robot)
        if paused:
            self._paused.add(robot)
            return
        if self.all_paused:
            self._paused.update(self._students)
            self.all_paused = False
        self._paused.discard(robot)

    def pause_of(self, robot: int) -> str:
        """Return the reason why a robot is paused; empty if it is not."""
        if self.all_paused:
            return ALL_PAUSED
        return ONE_PAUSED if robot in self._paused else ""

    def free_robot(self, address: str) -> int:
        """Return the first robot for one more student; raises as :meth:`join` does."""
        if self.locked:
            raise CommandError("nobody else can join now: ask your teacher to open the class")
        here = (student.address for student in self._students.values() if student is not None)
        if not self.shared and address in here:
            raise CommandError(
                f"somebody has joined from your address, {address}: go on in that browser, or ask "
                "your teacher to let several join from one address"
            )
        robot = next((number for number, who in self._students.items() if who is None), None)
        if robot is None:
            raise CommandError(
                f"the class is full: each of its {len(self._students)} robots has a student; "
                "ask your teacher to free one"
            )
        return robot
