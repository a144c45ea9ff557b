"""A class: students join and get a robot each; the teacher pauses, puts back and takes over.

Rules, besides those of :mod:`pioneer3.classroom.roster`:

1. A student's own program comes before the page: while it has the robot, the page only watches.
2. The teacher comes before both: a take-over ends the program's connection, and programs only watch
   while the teacher has control. A student does not take over from the teacher.
3. While a robot is paused nobody drives it, neither a page nor a program. Stops always count.
4. A robot whose seat is freed stops, and the program of its student is disconnected.
"""

import asyncio
import time
from collections.abc import Callable, Mapping
from hmac import compare_digest
from secrets import choice
from typing import Protocol

from pioneer3.classroom.downloads import Downloads
from pioneer3.classroom.roster import Roster
from pioneer3.classroom.runs import Run, RunFolder
from pioneer3.errors import CommandError, ConfigError, Refusal
from pioneer3.tasks import next_tick
from pioneer3.web import messages, requests
from pioneer3.web.access.access import Access, Rate, RateLimiter
from pioneer3.web.access.sessions import LoginSession, Role, SessionKind, fingerprint
from pioneer3.web.audience import Audience, Audiences
from pioneer3.web.classroom.robot import PAGE, ClassRobot, small_snapshot
from pioneer3.web.clients import Clients
from pioneer3.web.control import Operator
from pioneer3.web.robot_view import RobotView

PERIOD = 0.2
"""Time between two looks at all robots [s]."""
JOINS = Rate(60, 2.0)
"""Attempts to join from one address, which a class may share."""
JOINS_IN_ALL = Rate(120, 1.0)
"""Attempts to join from everywhere."""
CODE_LETTERS = "abcdefghjkmnpqrstuvwxyz"
"""Letters of the token, none of which is taken for another or for a digit."""
CODE_LENGTH = 8
"""Length of the token, which people type from a projector; with one attempt a second a guess finds
one of 8e10 in a thousand years."""
PROGRAM = "your program drives your robot: end it to drive from here"
TEACHER = "your teacher drives your robot"


def new_code() -> str:
    """Return a token for a class that people can type."""
    return "".join(choice(CODE_LETTERS) for _ in range(CODE_LENGTH))


class ClassPage(Protocol):
    """The page of the robots of a class."""

    robots: dict[int, RobotView]
    clients: Clients
    access: Access
    audiences: Audiences

    def relabel(self, number: int, label: str) -> None:
        """Show a robot under another name from now on."""


class Classroom:
    """The class that the robots of `page` belong to, by number.

    The token lets students in as long as the class lasts, and other devices can reach the address
    for students in a `lan`. The clock returns the Unix time [s].
    """

    def __init__(
        self,
        page: ClassPage,
        robots: Mapping[int, ClassRobot],
        runs: RunFolder,
        clock: Callable[[], float] = time.time,
    ) -> None:
        self.roster = Roster(robots)
        self.robots = dict(robots)
        self.runs = runs
        self.limiter = RateLimiter(asyncio.get_running_loop().time, JOINS, JOINS_IN_ALL)
        self.token = new_code()
        self.join_url = ""
        self.downloads: Downloads | None = None
        self.lan = False
        self._page = page
        self._clock = clock
        self._small: dict[int, str] = {}
        for number, robot in self.robots.items():
            page.relabel(number, robot.label)

    async def run(self) -> None:
        """Keep pages up to date; ends by cancellation."""
        try:
            while True:
                self.update()
                await next_tick(PERIOD)
        finally:
            for robot in self.robots.values():
                robot.discard_recording()

    # Joining

    def admits(self, token: str) -> bool:
        """Whether `token` is that of the class."""
        return compare_digest(fingerprint(token), fingerprint(self.token))

    def join(
        self, name: str, address: str, session: LoginSession | None = None
    ) -> tuple[LoginSession, str | None]:
        """Let a student in; return the session, and its secret if it is new.

        The caller's session is kept if it is a student's, and only the name changes.

        Raises:
            CommandError: There is no room, or no name.
            OverflowError: There are too many sessions.
        """
        secret = None
        if session is None or self.roster.robot_of(session.id) is None:
            self.roster.free_robot(address)
            session, secret = self._page.access.sessions.open(
                name, Role.STUDENT, SessionKind.BROWSER
            )
        try:
            robot = self.roster.join(session.id, name, address)
        except CommandError:
            if secret is not None:
                self._page.access.sessions.revoke(session.id)
            raise
        student = self.roster.student(robot)
        assert student is not None
        session.name, session.robot = student.name, robot
        self._page.relabel(robot, student.name)
        self.update()
        return session, secret

    def session_ended(self, session: LoginSession) -> None:
        """Free the seat of a student whose session has ended; the robot stops."""
        number = self.roster.robot_of(session.id)
        if number is None:
            return
        self.roster.free(number)
        robot = self.robots[number]
        robot.bridge.disconnect_others(PAGE)
        robot.discard_recording()
        self._stop(number, "the student has left")
        self._page.relabel(number, robot.label)
        self.update()

    # Driving

    def refusal(self, number: int, operator: Operator, *, take_over: bool) -> Refusal | None:
        """Return the refusal of an operator who may not drive, or take over, or `None`.

        A teacher who takes over ends the program's connection.
        """
        if paused := self.roster.pause_of(number):
            return Refusal(paused)
        robot, teaches = self.robots[number], not self._is_student(operator)
        holder = self._page.robots[number].control.holder
        held_by_student = holder is not None and self._is_student(holder)
        if teaches and (take_over or (robot.program is None and not held_by_student)):
            robot.bridge.reserved_for = PAGE
            return None
        if robot.program is not None:
            if not teaches:
                return Refusal(PROGRAM)
            return Refusal(f"the program at {robot.program} drives: take over to drive from here")
        from_teacher = holder is not None and not held_by_student
        return Refusal(TEACHER) if take_over and from_teacher else None

    # Requests

    def carry_out(self, request: requests.ClassRequest) -> Refusal | None:
        """Carry out a request."""
        try:
            match request:
                case requests.PauseRobots(paused, robot):
                    self.pause(robot, paused=paused)
                case requests.PutBack(robot):
                    self.put_back(robot)
                case requests.FreeSeat(robot):
                    self.free(robot)
                case requests.LockJoining(locked):
                    self.roster.locked = locked
                    self.update()
                case requests.ShareAddresses(shared):
                    self.roster.shared = shared
                    self.update()
                case requests.RecordRun(step, robot):
                    self.record(robot, step)
        except (CommandError, ConfigError) as error:
            return Refusal(str(error))
        return None

    def pause(self, robot: int | None = None, *, paused: bool) -> None:
        """Pause a robot, or all without a number: it stops, and nobody drives; or end that.

        Raises:
            CommandError: The class has no such robot.
        """
        self.roster.pause(robot, paused=paused)
        for number, each in self.robots.items():
            why = self.roster.pause_of(number)
            if bool(why) == each.bridge.paused:
                continue
            each.bridge.paused = bool(why)
            if why:
                self._stop(number, why)
        self.update()

    def put_back(self, robot: int | None = None) -> None:
        """Stop a simulated robot, or all without a number, and put it where it began.

        Raises:
            CommandError: Something stands there, or the robot is a real one.
        """
        chosen = list(self.robots.values()) if robot is None else [self._robot(robot)]
        starts = {each.number: each.start for each in chosen if each.start is not None}
        if not starts:
            raise CommandError("only simulated robots can be put back: carry this one yourself")
        for number in starts:
            self._stop(number, "the teacher put the robot back")
        simulation = next(iter(starts.values())).simulation
        stay = simulation.move_robots({start.robot: start.pose for start in starts.values()})
        names = [self.name_of(number) for number, start in starts.items() if start.robot in stay]
        if names:
            raise CommandError(
                f"not put back: {', '.join(names)}; something stands there. Move that first"
            )

    def free(self, robot: int) -> None:
        """Show the student of a robot out.

        Raises:
            CommandError: The class has no such robot, or nobody has it.
        """
        student = self.roster.student(robot)
        if student is None:
            raise CommandError(f"{self.name_of(robot)}: nobody has this robot")
        self._page.access.sessions.revoke(student.session)

    def record(self, robot: int | None, step: str) -> Run | None:
        """Take a step of the recording of a robot's run; return what was handed in.

        Raises:
            CommandError: It is not possible now, or the number is missing.
            ConfigError: The folder cannot be written to.
        """
        if robot is None:
            raise CommandError("a number is missing: which robot's run?")
        each, handed_in = self._robot(robot), None
        match step:
            case "begin":
                each.begin_recording(self.runs)
            case "end":
                each.end_recording()
            case "discard":
                each.discard_recording()
            case _:
                handed_in = self._hand_in(each)
        self.update()
        return handed_in

    def name_of(self, robot: int) -> str:
        """Return the name of the student of a robot, or the robot's own."""
        student = self.roster.student(robot)
        return student.name if student else self.robots[robot].label

    # Messages

    def update(self) -> None:
        """Tell pages the changes, and let programs have robots that no teacher drives any more."""
        for robot in self.robots.values():
            self._follow(robot)
        seats = {number: self.seat(number) for number in self.robots}
        for audience in self._page.audiences:
            audience.put("class", messages.encode(self.message(audience, seats)))
            if audience.small and audience.clients:
                self._tell_small(audience)

    def message(
        self, audience: Audience, seats: Mapping[int, messages.Seat] | None = None
    ) -> messages.Class:
        """Return the message about the class for an audience."""
        if seats is None:
            seats = {number: self.seat(number) for number in self.robots}
        own = audience.robot if audience.student else None
        return messages.Class(
            paused=self.roster.all_paused,
            locked=self.roster.locked,
            shared=self.roster.shared,
            lan=self.lan,
            join_url=self.join_url if audience.small else None,
            seats=tuple(seat for number, seat in seats.items() if own in {None, number}),
            handed_in=self.handed_in(own),
        )

    def handed_in(self, robot: int | None = None) -> tuple[messages.HandedIn, ...]:
        """Return the runs of the student of a robot, or all without a number."""
        student = None if robot is None else self.roster.student(robot)
        return tuple(
            describe(run)
            for run in self.runs.runs.values()
            if robot is None or (student is not None and run.session == student.session)
        )

    def seat(self, number: int) -> messages.Seat:
        """Return the part of a message for a robot; CommandError if there is none of the number."""
        robot, student = self._robot(number), self.roster.student(number)
        program, paused = robot.program, self.roster.pause_of(number)
        taken = PROGRAM if program is not None else TEACHER if robot.bridge.reserved_for else ""
        return messages.Seat(
            robot=number,
            name=student.name if student else None,
            online=self._page.clients.of_session(student.session) if student else 0,
            program=program,
            paused=bool(paused),
            refusal=paused or taken,
            recording=robot.recording.message() if robot.recording else None,
            url=robot.url,
        )

    def _stop(self, number: int, why: str) -> None:
        """Stop a robot, and end what drives it from the page; a program may drive it on."""
        bridge = self.robots[number].bridge
        if self.robots[number].program is not None:
            bridge.stop(why)
        elif number in self._page.robots:
            self._page.robots[number].robot.arbiter.stop(why=why)

    def _hand_in(self, robot: ClassRobot) -> Run:
        recording = robot.end_recording()
        assert recording.seconds is not None
        student = self.roster.student(robot.number)
        run = self.runs.hand_in(
            recording.draft,
            student=self.name_of(robot.number),
            session=student.session if student else "",
            robot=robot.number,
            at=self._clock(),
            seconds=recording.seconds,
        )
        robot.recording = None
        return run

    def _follow(self, robot: ClassRobot) -> None:
        """Note what has changed by itself: readings, the teacher's control, a recording's end."""
        view = self._page.robots.get(robot.number)
        if view is not None:
            robot.tell_recording(view)
        holder = view.control.holder if view is not None else None
        if robot.bridge.reserved_for and (holder is None or self._is_student(holder)):
            robot.bridge.reserved_for = ""
        if failure := robot.check_recording():
            self._tell_student(robot.number, f"the recording has ended: {failure}; hand it in")

    def _tell_small(self, audience: Audience) -> None:
        for number, view in self._page.robots.items():
            part = small_snapshot(view, self.robots[number].program, self._is_student)
            text = messages.encode(part)
            if self._small.get(number) != text:
                self._small[number] = text
                audience.snapshots.put(number, text)

    def _tell_student(self, robot: int, news: str) -> None:
        student = self.roster.student(robot)
        for client in self._page.clients.connected.values():
            if student is not None and client.session.id == student.session:
                client.tell(news)

    def _is_student(self, operator: Operator) -> bool:
        if isinstance(operator, LoginSession):
            return operator.role is Role.STUDENT
        client = self._page.clients.find(operator)
        return client is not None and client.role is Role.STUDENT

    def _robot(self, number: int) -> ClassRobot:
        if number not in self.robots:
            raise CommandError(f"the class has no robot {number}")
        return self.robots[number]


def describe(run: Run) -> messages.HandedIn:
    """Return the part of a message for a run."""
    return messages.HandedIn(run.file, run.student, run.robot, run.at, run.seconds, run.size)
