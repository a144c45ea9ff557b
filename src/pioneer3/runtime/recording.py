"""The log of a robot: its snapshots and scans, the commands to it, and the decisions."""

from asyncio import CancelledError
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import astuple, dataclass, replace
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, TypeVar

import msgspec

from pioneer3.arcos.reports import Config
from pioneer3.behaviors.engine import Decision
from pioneer3.behaviors.explanations import explain
from pioneer3.clock import Clock
from pioneer3.errors import ConfigError
from pioneer3.geometry import STILL, Pose2, Twist2
from pioneer3.limits import Limits
from pioneer3.links import Opener
from pioneer3.links.tap import ROBOT, WireRecording, tapped
from pioneer3.log.command_line import without_secrets
from pioneer3.log.output import refuse_taken
from pioneer3.log.topics import SNAPSHOT, LogEvent, LogTopic
from pioneer3.log.writer import LogWriter, named_log, user_log
from pioneer3.models import GivenModel, RobotModel
from pioneer3.robot.explain import Reason
from pioneer3.robot.limits import limits_for
from pioneer3.robot.session import model_of
from pioneer3.robot.supervisor import (
    Connection,
    ConnectionStatus,
    RobotInfo,
    Supervisor,
    kind,
)
from pioneer3.state import Identity, Scan, Snapshot

if TYPE_CHECKING:
    from pioneer3.robot.lasers.driver import LaserDriver

T = TypeVar("T")

MODEL: Final = "model"
"""Topic of the model of a robot: another robot may answer later at the same port."""
RENEWED: Final = 1.0
"""Period at which a command or decision is told that only goes on, as of a held key [s]."""
EMERGENCY_STOP: Final = "emergency stop"
"""The command of an emergency stop."""
RESET: Final = "reset the emergency stop"
"""The command that ends it."""
AT_ORIGIN: Final = ("odometry", "this place is 0, 0, 0 from now on")
"""Kind and text of the event that somebody restarted odometry."""
GIVES_MOTION: Final = {"drive", "start"}
"""Commands that nobody obeys while the emergency stop is latched."""
TRUTH_PERIOD: Final = 0.095
"""Shortest time between two true poses [s]: ten a second, at the time of snapshots."""
READING_SIZE: Final = 40
"""Memory of one reading of a scan [bytes], about."""


@dataclass(frozen=True, slots=True)
class CommandGiven:
    """A command, who gave it, and the refusal if it was not carried out.

    `by` is the name of an input, such as `keyboard`, `program` or `cmd_vel`. The speeds [m/s,
    rad/s] are wanted for `seconds`, where it is about them.
    """

    by: str
    command: str
    twist: Twist2 = STILL
    seconds: float = 0.0
    refused: str = ""

    @property
    def latches(self) -> bool | None:
        """Whether the emergency stop is latched after it; `None` leaves that open."""
        if self.command == EMERGENCY_STOP:
            return True
        free = self.command == RESET or (self.command in GIVES_MOTION and not self.refused)
        return False if free else None


@dataclass(frozen=True, slots=True)
class DecisionMade:
    """A decision of the arbiter, the mode that drives, and the reasons as people are told them."""

    mode: str
    decision: Decision
    told: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class StandsBecause:
    """The reason that the robot stands still from now on; `None` while it moves."""

    reason: Reason | None


@dataclass(frozen=True, slots=True)
class TruePoseTold:
    """The true pose of a simulated robot [m, rad]."""

    robot_in_world: Pose2


def _told(made: tuple[str, Decision]) -> DecisionMade:
    mode, decision = made
    return DecisionMade(mode, decision, explain(decision))


def described(texts: Mapping[str, str], url: str = "", given: GivenModel = None) -> RobotInfo:
    """Return the description of a robot by the texts of its log, as far as they can be read.

    Its own file of today counts in older logs alone, and where it is right, and of that robot.

    Raises:
        ConfigError: There is no such model as is given.
    """
    config, told = _read(texts, "configuration", Config), _read(texts, "parameters", RobotModel)
    identity = Identity(name=texts.get("name", ""), family="", model=texts.get("model", ""))
    try:
        model = model_of(identity, config, given)
    except ConfigError:
        if given is not None:
            raise
        model = model_of(replace(identity, name=""), None)
    if given is None and told is not None and astuple(told) != astuple(model):
        model = told  # its file was another one then
    return RobotInfo(
        identity=identity,
        model=model,
        limits=_read(texts, "limits", Limits) or limits_for(model, config),
        config=config,
        url=url or texts.get("url", ""),
        speed=None,
    )


def _read(texts: Mapping[str, str], name: str, kind: type[T]) -> T | None:
    with suppress(msgspec.MsgspecError, ConfigError):
        return msgspec.json.decode(texts.get(name, ""), type=kind)
    return None


def link_status(event: LogEvent, name: str) -> ConnectionStatus | None:
    """Return the state of the link of a robot or laser that an event tells; `None` if none."""
    connection, _, message = event.text.removeprefix(f"{name}: ").partition(": ")
    told = event.kind == "link" and event.text.startswith(f"{name}: ")
    known = told and connection in {*Connection}
    return ConnectionStatus(Connection(connection), message) if known else None


class RobotLog:
    """The part of a log that is about one robot; names of several are in its topics."""

    def __init__(self, log: LogWriter, robot: str = "") -> None:
        self.log = log
        self._prefix = f"{robot}/" if robot else ""
        self._snapshots = self.topic(SNAPSHOT, Snapshot)
        self._models = self.topic(MODEL, RobotModel, repeated=True)
        commands = self.topic("command", CommandGiven)
        self._commands = replace(commands, is_news=self._is_new_command)
        decisions = self.topic("decision", DecisionMade, _told)
        self._decisions = replace(decisions, is_news=self._is_new)
        self._limits = self.topic("limits", Limits, repeated=True)
        self._truths = self.topic("truth", TruePoseTold, rows=True)
        self._reasons = self.topic("standing", StandsBecause, repeated=True)
        self._scans: dict[str, LogTopic[Scan]] = {}
        self._newest: dict[str, Scan] = {}
        self._decided: tuple[str, Decision] = ("", Decision())
        self._decided_at = self._asked_at = -inf
        self._asked: CommandGiven | None = None
        self._stands: StandsBecause | None = None
        self._repeated: dict[str, object] = {}
        self._true: Pose2 | None = None
        self._true_at = -inf

    def of(self, robot: str) -> "RobotLog":
        """Return the part about another robot of the same program."""
        return RobotLog(self.log, robot)

    def topic(
        self,
        name: str,
        kind: type,
        make: Callable[[Any], Any] | None = None,
        *,
        repeated: bool = False,
        rows: bool = False,
    ) -> LogTopic[Any]:
        """Return a topic of this robot; arguments as of :class:`LogTopic`."""
        return LogTopic(self._prefix + name, kind, make=make, repeated=repeated, rows=rows)

    def put(self, topic: LogTopic[Any], message: Any) -> None:
        """Take a message of now; one that is repeated is the same object until it changes."""
        if topic.repeated:
            if self._repeated.get(topic.name) is message:
                return
            self._repeated[topic.name] = message
        self.log.put(topic, message)

    def stands(self, reason: Reason | None) -> None:
        """Take the reason that the robot stands, `None` while it moves, if it is new."""
        if self._stands is None or reason != self._stands.reason:
            self._stands = StandsBecause(reason)
            self.log.put(self._reasons, self._stands)

    def event(self, kind: str, text: str) -> None:
        """Take an event, in words."""
        self.log.event(kind, self._prefix + text)

    def opener(self, opener: Opener, link: str = ROBOT) -> Opener:
        """Return an opener of the same links, which are recorded."""
        return tapped(opener, WireRecording(self.log, self._prefix + link))

    def snapshot(self, snapshot: Snapshot, model: RobotModel, scans: Iterable[Scan] = ()) -> None:
        """Take a snapshot of a robot, its model, and scans before it, unless they are known."""
        self.put(self._models, model)
        for scan in scans:
            self.scan(scan)
        if snapshot.motors.moving or not snapshot.odometry.twist.is_zero:
            self.log.moved_at = snapshot.stamp
        self.log.put(self._snapshots, snapshot)

    def scan(self, scan: Scan) -> None:
        """Take a scan."""
        if self._newest.get(scan.laser) is scan:
            return
        self._newest[scan.laser] = scan
        topic = self._scans.get(scan.laser)
        if topic is None:
            name = f"{self._prefix}scan/{scan.laser}"
            size = READING_SIZE * len(scan.ranges)
            topic = LogTopic(name, Scan, steady="angles", size=size)
            self._scans[scan.laser] = topic
        self.log.put(topic, scan)

    def decided(self, mode: str, decision: Decision, limits: Limits, now: float) -> None:
        """Take a decision; one that only goes on is written once a second."""
        self.put(self._limits, limits)
        self.log.put(self._decisions, (mode, decision), now)

    def _is_new(self, made: tuple[str, Decision], now: float) -> bool:
        mode, decision = made
        before, last = self._decided
        if (
            mode == before
            and decision.twist == last.twist
            and decision.contributions == last.contributions
            and (decision.until == last.until or now - self._decided_at < RENEWED)
        ):
            return False
        self._decided, self._decided_at = made, now
        return True

    def asked(self, command: CommandGiven, now: float) -> None:
        """Take a command of `now` [s]; one that only goes on is written once a second."""
        self.log.put(self._commands, command, now)

    def _is_new_command(self, command: CommandGiven, now: float) -> bool:
        if command == self._asked and now - self._asked_at < min(RENEWED, command.seconds):
            return False
        self._asked, self._asked_at = command, now
        return True

    def truth(self, robot_in_world: Pose2) -> None:
        """Take the true pose of a simulated robot; one that stays is taken once a second."""
        now = self.log.clock()
        apart = RENEWED if robot_in_world == self._true else TRUTH_PERIOD
        if now - self._true_at >= apart:
            self._true, self._true_at = robot_in_world, now
            self.log.put(self._truths, TruePoseTold(robot_in_world))

    async def follow(self, supervisor: Supervisor) -> None:
        """Log changes of the connection, and descriptions of the robot."""
        described = None
        async for status in supervisor.status.values(latest_first=True):
            self.event("link", f"robot: {status.connection}: {status.message}")
            if supervisor.info is not None and supervisor.info is not described:
                described = supervisor.info
                self.describe(described)

    async def follow_laser(self, laser: "LaserDriver") -> None:
        """Log changes of the connection of a laser, and how its bytes become scans."""
        async for status in laser.status.values(latest_first=True):
            self.describe_laser(laser)
            self.event("link", f"{laser.name}: {status.connection}: {status.message}")

    def describe_laser(self, laser: "LaserDriver") -> None:
        """Describe a laser that is connected in the log."""
        if laser.connected:
            told = {
                "protocol": laser.protocol,
                "speeds": laser.speeds,
                "settings": laser.config.settings,
                "mounting": laser.mounting(),
                "time_offset": laser.config.time_offset,
            }
            texts = {name: msgspec.json.encode(part).decode() for name, part in told.items()}
            self.log.describe(f"{self._prefix}{laser.name}", texts)

    def describe(self, info: RobotInfo) -> None:
        """Describe the robot in the log."""
        self.log.describe(
            f"{self._prefix}{ROBOT}",
            {
                "name": info.identity.name,
                "kind": kind(info).lower(),
                "url": without_secrets(info.url),
                "model": info.model.name,
                "parameters": msgspec.json.encode(info.model).decode(),
                "limits": msgspec.json.encode(info.limits).decode(),
                "configuration": msgspec.json.encode(info.config).decode(),
            },
        )


@dataclass(frozen=True, slots=True)
class WithTables:
    """A log in a new file, or else the user's, and a new folder for its tables when it has ended.

    Attributes:
        tell: Called with what is done then.
    """

    folder: Path
    log: Path | bool = True
    tell: Callable[[str], None] = lambda text: None

    def write(self, files: Sequence[Path]) -> None:
        """Write the tables of a log that has ended; the folder is there whole, or not at all.

        Of a long log the first files may have gone for want of room.

        Raises:
            ConfigError: They cannot be written; the log stays.
        """
        from pioneer3.log.reader import RunLog
        from pioneer3.log.tables import TableKind, write_tables

        left = [path for path in files if path.exists()]
        if not left:
            raise ConfigError("no file of the log is left")
        gone = len(files) - len(left)
        lacks = f": without the log's first {gone} files, which went for want of room"
        self.tell(f"writing tables to {self.folder}{lacks if gone else ''}")
        write_tables(RunLog(*left), self.folder, TableKind.CSV)


Record = Path | bool | RobotLog | WithTables | None
"""Where a robot is recorded: a new file, part of a log, nowhere if false, else the user's logs."""


@contextmanager
def recorded(record: Record, clock: Clock) -> Iterator[RobotLog | None]:
    """Record a robot during the block; the log tells why it ended.

    Raises:
        ConfigError: The file cannot be written; one that exists is left alone.
    """
    if isinstance(record, RobotLog) or record is False:
        yield record or None
        return
    if isinstance(record, WithTables):
        refuse_taken(record.folder)
        files: list[Path] = []
        try:
            with recorded(record.log, clock) as robot_log:
                assert robot_log is not None
                files = robot_log.log.files
                yield robot_log
        except BaseException:
            try:
                record.write(files)
            except ConfigError as error:  # what ended the run is told, too
                record.tell(f"no tables: {error}")
            raise
        record.write(files)
        return
    if isinstance(record, Path):
        log: LogWriter | None = named_log(record, clock)
    else:
        log = user_log(clock, always=record is True)
    if log is None:
        yield None
        return
    why = "left as usual"
    try:
        yield RobotLog(log)
    except BaseException as error:
        why = _why(error)
        raise
    finally:
        log.close(why)


def _why(error: BaseException) -> str:
    """Return the reason for the end of a block, in words."""
    if isinstance(error, CancelledError | KeyboardInterrupt | GeneratorExit | SystemExit):
        return "told to leave"
    return f"{type(error).__name__}: {error}"
