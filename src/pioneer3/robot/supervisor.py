"""Keeps one robot connected: opens the link, reconnects with back-off, publishes the status."""

import asyncio
import logging
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Generic, Literal, TypeVar

from pioneer3.arcos.commands import Command, moves
from pioneer3.arcos.host_events import Timing
from pioneer3.arcos.reports import Config, Report
from pioneer3.errors import (
    CommandError,
    ConfigError,
    LinkError,
    NoRobotError,
    RecordingOverError,
    Refusal,
)
from pioneer3.limits import Limits
from pioneer3.links import Opener
from pioneer3.models import GivenModel, RobotModel, loaded_model
from pioneer3.models.model import OwnFile
from pioneer3.robot.assemble import Assembler
from pioneer3.robot.explain import Reason, ReasonKind, why_not_moving
from pioneer3.robot.limits import limits_for
from pioneer3.robot.pilot import STOPPED, Pilot, VelocityCommand
from pioneer3.robot.poses import Poses
from pioneer3.robot.report_requests import ReportRequest, ReportRequests
from pioneer3.robot.reports import Reports
from pioneer3.robot.session import SIMULATOR_SERIALS, Session
from pioneer3.state import Identity, Snapshot

T = TypeVar("T")


class Feed(Generic[T]):
    """A value that changes; readers always get the newest."""

    def __init__(self) -> None:
        self.latest: T | None = None
        self._count = 0
        self._changed = asyncio.Event()
        self._closed = False

    def publish(self, value: T) -> None:
        """Make `value` the latest and wake every reader."""
        self.latest = value
        self._count += 1
        self._wake()

    def close(self) -> None:
        """End every iteration."""
        self._closed = True
        self._wake()

    async def values(self, *, latest_first: bool = False) -> AsyncIterator[T]:
        """Yield each value published from now on, but only the newest to a slow reader.

        The last one before :meth:`close` is not skipped. With `latest_first` it begins with the
        latest value, if there is one.
        """
        seen = self._count - (latest_first and self._count > 0)
        while True:
            if self._count != seen:
                seen = self._count
                if self.latest is not None:
                    yield self.latest
            elif self._closed:
                return
            else:
                await self._changed.wait()

    def _wake(self) -> None:
        self._changed.set()
        self._changed = asyncio.Event()


log = logging.getLogger(__name__)

TAKEN = "another program drives this robot, and this one watches: only a stop counts"
WATCHES = Reason(ReasonKind.NORMAL, f"{TAKEN[0].upper()}{TAKEN[1:]}.")
"""The reason that a robot stands which another program drives."""
BACK_OFF = (0.2, 0.5, 1.0, 2.0, 3.0)
"""Pauses before the attempts to reconnect [s]; the last one repeats."""


class Connection(StrEnum):
    """State of the connection to the robot."""

    CONNECTING = "connecting"
    CONNECTED = "connected"
    LOST = "lost"
    CLOSED = "closed"


@dataclass(frozen=True, slots=True)
class ConnectionStatus:
    """A change of :class:`Connection`, with a sentence for a person."""

    connection: Connection
    message: str


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotInfo:
    """Description of a connected robot.

    Attributes:
        config: Its CONFIG report, or `None` if it sent none.
        speed: Line speed [baud], or `None` on links without one.
        own: Its own file, if it has one.
    """

    identity: Identity
    model: RobotModel
    limits: Limits
    config: Config | None
    url: str
    speed: int | None
    own: OwnFile | None = None


class Supervisor:
    """One robot, connected again and again; `open_link` opens the link for every attempt.

    See :class:`Session` and :class:`Pilot` for the other arguments.

    Raises:
        ConfigError: There is no such model.

    Attributes:
        model: That somebody gives, from the next connection on.
        snapshot: The latest one of the session that is open, or `None`.
        snapshot_taken: Called with every snapshot, before the feed `snapshots` has it.
        poses: Of the last seconds, in odometry's frame.
    """

    def __init__(
        self,
        open_link: Opener,
        *,
        model: GivenModel = None,
        restrict: Callable[[Limits], Limits] = lambda limits: limits,
        auto_enable: bool = True,
        timing: Timing | None = None,
    ) -> None:
        self.pilot = Pilot(auto_enable=auto_enable)
        self.assembler = Assembler()
        self.reports = Reports()
        self._requests = ReportRequests()
        self.poses = Poses()
        self.snapshots: Feed[Snapshot] = Feed()
        self.status: Feed[ConnectionStatus] = Feed()
        self.info: RobotInfo | None = None
        self.snapshot_taken: Callable[[Snapshot], None] = lambda snapshot: None
        self._open_link = open_link
        self.model = loaded_model(model)
        self._restrict = restrict
        self._change: Callable[[Limits], Limits] = lambda limits: limits
        self._timing = timing
        self._session: Session | None = None
        self._clock = asyncio.get_running_loop().time
        self.snapshot: Snapshot | None = None

    @property
    def without_power(self) -> bool:
        """Whether the robot reports that its motors have no power, as after an emergency stop."""
        return self.snapshot is not None and not self.snapshot.motors.enabled

    @property
    def taken(self) -> bool:
        """Whether another program drives the robot, and this one watches."""
        return self._session is not None and bool(self._session.taken)

    async def run(self) -> None:
        """Connect, and reconnect after every loss; ends by cancellation, or with a recording.

        Raises:
            LinkError, NoRobotError, ConfigError: the *first* connection failed.
        """
        end = "closed"
        try:
            attempt = 0
            while True:
                attempt = await self._serve_once(attempt)
                await asyncio.sleep(BACK_OFF[min(attempt, len(BACK_OFF)) - 1])
        except RecordingOverError as over:
            if self.snapshots.latest is None:
                raise
            end = str(over)
        finally:
            self._publish_status(Connection.CLOSED, end)
            for feed in (self.snapshots, self.status):
                feed.close()
            self.reports.close()

    def drive(self, command: VelocityCommand) -> Refusal | None:
        """See :meth:`Pilot.drive`; a robot that is :attr:`taken` is not driven."""
        if self.taken:
            return Refusal(TAKEN)
        return self._wake_writer(self.pilot.drive(command, self._clock()))

    def stop(self, why: str = STOPPED) -> None:
        """Stand still; commands from before end by this reason."""
        self.pilot.stop(self._clock(), why)
        self._wake_writer()

    def emergency_stop(self) -> None:
        """Stop hard, motors off, latched."""
        self.pilot.emergency_stop(self._clock())
        self._wake_writer()

    def reset_emergency_stop(self) -> None:
        """Release the latch; the motors stay off."""
        self.pilot.reset_emergency_stop()

    def set_motors(self, *, on: bool) -> Refusal | None:
        """Switch the motors' power."""
        return self._wake_writer(self.pilot.set_motors(on=on, now=self._clock()))

    def change_limits(self, change: Callable[[Limits], Limits]) -> None:
        """Apply `change` to the robot's limits from now on, in place of the last change."""
        self._change = change
        if self.info is not None:
            limits = self._restricted(limits_for(self.info.model, self.info.config))
            self.info = replace(self.info, limits=limits)
            self.pilot.limits = limits
            self.pilot.tick(self._clock())
            self._wake_writer()

    def send(self, command: Command) -> None:
        """Send any command that is not about motion.

        Raises:
            CommandError: no session is open, the command does not fit the protocol, or it moves
                the robot.
        """
        if moves(command):
            raise CommandError(
                f"{type(command).__name__} moves the robot past its limits: drive it, or send it"
                " as an unsafe command"
            )
        self._send(command)

    def send_unsafe(self, command: Command) -> None:
        """Send any command at all, past limits, expiry, bumpers and emergency stop.

        After a command that moves the robot, the pilot sends nothing of its own until a stop or a
        fresh request. The robot is stopped on every way out all the same.

        Raises:
            CommandError: no session is open, the command does not fit the protocol, or it moves a
                robot whose units are not known.
        """
        self._send(command)
        if moves(command):
            self.pilot.leave_to_raw_commands(self._clock())

    @contextmanager
    def requested(self, name: str, request: ReportRequest) -> Iterator[None]:
        """Keep `request` active during the block, over all sessions.

        Blocks with the same `name` share one request; the last one ends it.
        """
        self._requests.want(name, request, self._clock())
        self._wake_writer()
        try:
            yield
        finally:
            self._requests.release(name)
            self._wake_writer()

    def change_request(self, name: str, request: ReportRequest) -> None:
        """Replace the request of this `name` if it is :meth:`requested`."""
        self._requests.change(name, request, self._clock())
        self._wake_writer()

    def _restricted(self, limits: Limits) -> Limits:
        return self._change(self._restrict(limits))

    def _send(self, command: Command) -> None:
        if self._session is None:
            raise CommandError(f"cannot send {type(command).__name__}: no robot is connected")
        self._session.send(command)

    def why_not_moving(self, decided: str | None = None) -> Reason | None:
        """Return the reason that the robot stands still, or `None` while it moves.

        `decided` is the reason for a command to stand still, if there was one.
        """
        why = why_not_moving(self.pilot, self.snapshot, self._clock(), decided)
        return WATCHES if why is not None and self.taken else why

    def on_connected(self, session: Session) -> None:
        """Store the description of the robot, and publish the connection."""
        assert session.identity is not None
        assert session.model is not None
        assert self.pilot.limits is not None
        self.info = RobotInfo(
            identity=session.identity,
            model=session.model,
            limits=self.pilot.limits,
            config=session.config,
            url=session.link.url,
            speed=session.speed,
            own=session.own,
        )
        _remember_speed(session)
        self._publish_status(
            Connection.CONNECTED,
            f"{session.identity.name} ({session.model.title}) on {self.info.url}",
        )

    def on_snapshot(self, snapshot: Snapshot) -> None:
        """Pass a snapshot on: first to `snapshot_taken`, which misses none, then to the readers."""
        self.snapshot = snapshot
        self.poses.add(snapshot)
        self.snapshot_taken(snapshot)
        self.snapshots.publish(snapshot)

    def on_report(self, report: Report, now: float) -> None:
        """Pass a report on, and keep the newest configuration."""
        if isinstance(report, Config) and self.info is not None:
            self.info = replace(self.info, config=report)
        self.reports.publish(report, now)

    async def _serve_once(self, attempt: int) -> int:
        """Serve one connection; return the number of failed attempts in a row, with this one."""
        began_with = self.assembler.sessions
        try:
            self._publish_status(Connection.CONNECTING, "connecting")
            self._session = Session(
                await self._open_link(),
                pilot=self.pilot,
                requests=self._requests,
                assembler=self.assembler,
                listener=self,
                model=self.model,
                restrict=self._restricted,
                timing=self._timing,
            )
            await self._session.run()
        except (LinkError, NoRobotError, ConfigError) as error:
            if self.snapshots.latest is None or isinstance(error, RecordingOverError):
                self.pilot.session_lost(str(error), self._clock())
                raise
            self._publish_status(Connection.LOST, str(error))
            if self.assembler.sessions == began_with:
                return attempt + 1
            self.pilot.session_lost(str(error), self._clock())
        finally:
            self._session = self.snapshot = None
            self._requests.session_lost()
        return 1

    def _wake_writer(self, answer: Refusal | None = None) -> Refusal | None:
        """Wake the writer, and return `answer`."""
        if self._session is not None:
            self._session.wake()
        return answer

    def _publish_status(self, connection: Connection, message: str) -> None:
        latest = self.status.latest
        if latest is None or (latest.connection, latest.message) != (connection, message):
            log.info("%s: %s", connection, message)
        self.status.publish(ConnectionStatus(connection, message))


def _remember_speed(session: Session) -> None:
    scheme, _, path = session.link.url.partition(":")
    if session.speed is not None and scheme == "serial":
        from pioneer3.links.serial import remember_speed

        remember_speed(path, session.speed)


SIMULATOR_NAMES = {"mobilesim", "amrisim", "arsim"}


def is_simulator(info: RobotInfo | None) -> bool:
    """Return whether the robot says that it is simulated (protocol.md 2.6; facts.md 13, row 12)."""
    if info is None:
        return False
    serial = info.config.serial_number if info.config else ""
    return info.identity.name.lower() in SIMULATOR_NAMES or serial in SIMULATOR_SERIALS


def kind(info: RobotInfo) -> Literal["SIMULATOR", "ROBOT"]:
    """Return `SIMULATOR` or `ROBOT`, in capitals."""
    return "SIMULATOR" if is_simulator(info) else "ROBOT"
