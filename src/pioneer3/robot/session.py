"""One session: makes ARCOS commands of the pilot's motion, and snapshots of reports."""

import asyncio
import logging
from collections import deque
from collections.abc import Callable, Sequence
from contextlib import nullcontext, suppress
from dataclasses import replace
from typing import Protocol

from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command
from pioneer3.arcos.host import Host
from pioneer3.arcos.host_events import (
    Configured,
    Event,
    Lost,
    Opened,
    ReportReceived,
    SessionState,
    SpeedWanted,
    Timing,
)
from pioneer3.arcos.reports import Config, Report, Sip
from pioneer3.errors import (
    CommandError,
    ConfigError,
    LinkError,
    NoRobotError,
    Refusal,
    TurnedAwayError,
)
from pioneer3.limits import Accelerations, Limits
from pioneer3.links import Link
from pioneer3.links.base import HUNG_UP, WRITTEN, HandingLink, TimedLink
from pioneer3.models import (
    Fallback,
    GivenModel,
    RobotModel,
    find_model,
    generic_model,
    loaded_model,
)
from pioneer3.models.model import OwnFile
from pioneer3.models.own import find_own
from pioneer3.robot.assemble import Assembler
from pioneer3.robot.correction import TwistCorrection
from pioneer3.robot.limits import limits_for
from pioneer3.robot.pilot import BRAKING, NOTHING_DUE, MotionRequest, Pilot
from pioneer3.robot.report_requests import ReportRequests
from pioneer3.state import Identity, Snapshot
from pioneer3.text import shown
from pioneer3.units import DEGREE, MM

log = logging.getLogger(__name__)

SIMULATOR_SERIAL = "SIM"
SIMULATOR_SERIALS = {SIMULATOR_SERIAL, "SIMULATED"}
"""The second one is that of our simulator where ARIA shall take it for a robot."""
CLOSE_TIMEOUT = 0.5
LATE = 0.2
"""The program was held up if the session runs this much too late [s]."""
MAX_WAITING = 256
"""Largest number of commands of devices and programs that wait for a blocked link."""
BATCH_SIZE = 8
"""Largest number of waiting commands in one write: a stop never waits for more."""


class SessionListener(Protocol):
    """Receives the events of a session."""

    def on_connected(self, session: "Session") -> None:
        """Identity, configuration and model are known; reports flow."""

    def on_snapshot(self, snapshot: Snapshot) -> None:
        """Take a new snapshot."""

    def on_report(self, report: Report, now: float) -> None:
        """Take any report; a standard report comes after the snapshot made from it."""


class Session:
    """One session with one robot over one link; the only writer of the link.

    The link is open; :meth:`run` closes it. Pilot, requests and assembler outlive the session.
    `model` is given if somebody names one; `restrict` turns the robot's limits into those to keep.

    Attributes:
        taken: True while the motors have had power in every report since the session began, though
            it switched them off: another program drives, as over a bridge, and this one watches.
    """

    def __init__(
        self,
        link: Link,
        *,
        pilot: Pilot,
        requests: ReportRequests,
        assembler: Assembler,
        listener: SessionListener,
        model: GivenModel = None,
        restrict: Callable[[Limits], Limits] = lambda limits: limits,
        timing: Timing | None = None,
    ) -> None:
        self.link = link
        self.identity: Identity | None = None
        self.config: Config | None = None
        self.model: RobotModel | None = None
        self.own: OwnFile | None = None
        self._given = model
        self.speed: int | None = None
        self._pilot = pilot
        self._requests = requests
        self._assembler = assembler
        self._listener = listener
        self._restrict = restrict
        self._loop = asyncio.get_running_loop()
        self._clock = self._loop.time
        self._timed = link if isinstance(link, TimedLink) else None
        self._due = self._alarm = self._clock()
        self._host = Host(self._due, link.speeds, timing, round_trip=link.round_trip)
        self._ended: asyncio.Future[None] = self._loop.create_future()
        self._next_write: asyncio.Handle | None = None
        self._writes_soon = False
        self._waiting: deque[Command] = deque()
        self._sending: asyncio.Task[None] | None = None
        self._speed_change: asyncio.Task[None] | None = None
        self._held_back = False
        self._lost: Lost | None = None
        self._configured = False
        self._settings: Sequence[Command] = ()
        self._correction: TwistCorrection | None = None
        self.taken: bool | None = None

    def wake(self) -> None:
        """Write soon if there is something to send, or to do before it is due by itself."""
        waits = self._host.is_due or self._pilot.is_due or self._requests.is_due
        due = min(self._host.deadline, self._pilot.deadline)
        if waits or self._waiting or self._lost or due < self._alarm:
            self._write_soon()

    def send(self, command: Command) -> None:
        """Queue one command beside the pilot's, unless the last one of its kind is the same.

        Raises:
            CommandError: no session is open, the command does not fit the protocol, it would move a
                robot that nothing drives, or the link has taken nothing for long.
        """
        if refusal := self._refusal(command):
            raise CommandError(refusal.text)
        if self._host.state is not SessionState.OPEN:
            raise CommandError(f"cannot send {type(command).__name__}: no session is open")
        if len(self._waiting) >= MAX_WAITING:
            raise CommandError(f"{self.link.url}: {MAX_WAITING} commands wait for the link")
        alike = (waits for waits in reversed(self._waiting) if type(waits) is type(command))
        if next(alike, None) != command:
            self._waiting.append(command)
        self.wake()

    async def run(self) -> None:
        """Serve the link until it fails; on every way out the robot is told to stop.

        Raises:
            NoRobotError: the handshake failed.
            LinkError: the session was open, and was lost.
        """
        reader = asyncio.ensure_future(self._read())
        self._write_soon()
        try:
            await asyncio.wait({reader, self._ended}, return_when=asyncio.FIRST_COMPLETED)
            for task in (reader, self._ended):
                if task.done():
                    task.result()
        finally:
            try:
                several = (reader, self._ended, self._sending, self._speed_change)
                tasks = [task for task in several if task is not None]
                for each in (*tasks, self._next_write):
                    if each is not None:
                        each.cancel()
                await asyncio.gather(*tasks, return_exceptions=True)
            finally:  # even if this task is cancelled twice
                await self._close()

    async def _read(self) -> None:
        link = self.link
        with link.handing(self._take) if isinstance(link, HandingLink) else nullcontext():
            while data := await link.read():
                self._take(data)
        closed = f"{self.link.url}: the other end closed the link"
        if self.identity is None:
            raise TurnedAwayError(f"{closed}; {HUNG_UP}")
        raise LinkError(closed)

    def _take(self, data: bytes) -> None:
        """Take bytes of the robot; an error ends the session."""
        if self._ended.done():
            return
        now = self._now(self._timed.read_at if self._timed else None)
        try:
            for event in self._host.receive(data, now):
                self._handle(event, now)
        except Exception as error:
            self._ended.set_exception(error)
        self._due = min(self._host.deadline, self._pilot.deadline)
        self.wake()

    def _write_soon(self) -> None:
        """Write in the next round of the loop, once for all that is asked for until then."""
        if not (self._writes_soon or self._ended.done()):
            self._writes_soon = True
            self._write_next(self._loop.call_soon(self._write))

    def _write_next(self, handle: asyncio.Handle) -> None:
        if self._next_write is not None:
            self._next_write.cancel()
        self._next_write = handle

    def _write(self) -> None:
        """Do what is due, and come back for what will be; an error ends the session."""
        self._writes_soon = False
        if self._ended.done() or self._speed_change is not None:
            return
        try:
            self._do_due(self._now())
        except Exception as error:
            self._ended.set_exception(error)
        else:
            self._write_next(self._loop.call_at(self._alarm, self._write_soon))

    def _do_due(self, now: float) -> None:
        for event in self._host.tick(now):
            self._handle(event, now)
        if self._lost is not None:
            raise self._failure(self._lost.reason)
        if self._speed_change is not None:
            return
        if self._host.config_settled and now >= self._pilot.deadline:
            self._pilot.tick(now)
        self._held_back = not self._link_is_free()
        if not self._held_back:
            self._send_all(now)
        self._due = self._alarm = min(self._host.deadline, self._pilot.deadline)

    def _now(self, read_at: float | None = None) -> float:
        """Return the time; tell the host of a delay, after which reports wait to be read."""
        now = self._clock() if read_at is None else read_at
        if now - self._due > LATE:
            self._host.held_up(now - self._due)
        self._due = now
        return now

    def _link_is_free(self) -> bool:
        """Return whether the link has taken the last bytes; LinkError if it has failed."""
        if self._sending is None:
            return True
        if self._sending.done():
            self._sending.result()
            self._sending = None
        return self._sending is None

    def _send_all(self, now: float) -> None:
        """Write all due commands to the link: the pilot's, then the requests, then the others."""
        if self._host.config_settled:
            due = [*self._motion_commands(now), *self._requests.outgoing()]
            waited = [self._waiting.popleft() for _ in range(min(BATCH_SIZE, len(self._waiting)))]
            for command in (*due, *(each for each in waited if self._is_allowed(each))):
                self._host.send(command, now)
        if data := self._host.outgoing():
            sending = self.link.write(data)
            if sending is not WRITTEN:
                self._sending = asyncio.ensure_future(sending)
                self._sending.add_done_callback(self._sent)

    def _motion_commands(self, now: float) -> list[Command]:
        """Return the commands for the motion that is due; the first come with the settings."""
        request = self._pilot.outgoing()
        if request is NOTHING_DUE and not self._settings:
            return []
        if self.model is None or not self.model.settable_acceleration:
            request = replace(request, accelerations=None)
        if request.twist is not None and self._correction is not None:
            request = replace(request, twist=self._correction.told(request.twist, now))
        settings, self._settings = self._settings, ()
        return commands_for(request, settings)

    def _refusal(self, command: Command) -> Refusal | None:
        """Return the refusal of a command that the present robot must not be sent, or `None`."""
        if commands.moves(command) and self._pilot.refusal:
            return Refusal(f"nothing drives this robot: {self._pilot.refusal}")
        return None

    def _is_allowed(self, command: Command) -> bool:
        """Return whether this robot may be sent a command that has waited for its type."""
        if refusal := self._refusal(command):
            log.warning("%s is not sent: %s", type(command).__name__, refusal)
        return not refusal

    def _sent(self, sending: "asyncio.Task[None]") -> None:
        """Write if the link was waited for, or has failed."""
        if self._held_back or sending.cancelled() or sending.exception() is not None:
            self._write_soon()

    def _speed_changed(self, change: "asyncio.Task[None]") -> None:
        """Go on at another speed, or end the session."""
        self._speed_change = None
        if self._ended.done() or change.cancelled():
            return
        if error := change.exception():
            self._ended.set_exception(error)
        else:
            self._write()

    def _handle(self, event: Event, now: float) -> None:
        match event:
            case ReportReceived(report):
                self._handle_report(report, now)
            case SpeedWanted(baud):
                self.speed = baud
                self._speed_change = asyncio.ensure_future(self.link.set_speed(baud))
                self._speed_change.add_done_callback(self._speed_changed)
            case Opened(identity):
                self.identity = identity
            case Configured(config, trusted):
                self._configure(config, trusted=trusted, now=now)
            case Lost():
                self._lost = event
                self.wake()

    def _configure(self, config: Config | None, *, trusted: bool, now: float) -> None:
        assert self.identity is not None
        self.config = config
        if config is None:
            log.warning("the robot did not send its configuration; the model's values are used")
        elif not trusted:
            log.warning("the configuration came with a wrong checksum, twice the same: accepted")
        self.own = own_of(self.identity, config, self._given)
        self.model = model_of(self.identity, config, self._given)
        if self.model.refusal:
            log.warning("nothing drives this robot: %s", self.model.refusal)
        self._assembler.session_opened(self.model)
        limits = self._restrict(limits_for(self.model, config))
        self._settings = settings_for(self.model, limits, config)
        matrix = self.model.odometry.matrix(self.model.wheel_base)
        self._correction = TwistCorrection(matrix, limits) if matrix else None
        self._pilot.session_opened(limits, now, refusal=self.model.refusal)
        self._requests.session_opened(now)
        self._configured = True
        self._listener.on_connected(self)

    def _handle_report(self, report: Report, now: float) -> None:
        if not self._configured:
            return
        self._requests.received(report, now)
        if isinstance(report, Sip):
            snapshot = self._snapshot(report, now)
            self.taken = snapshot.motors.enabled and self.taken is not False
            self._pilot.observe(snapshot, now)
            self._listener.on_snapshot(snapshot)
            self._requests.tick(now)
        self._listener.on_report(report, now)

    def _snapshot(self, report: Sip, now: float) -> Snapshot:
        assert self.model is not None
        return self._assembler.assemble(
            report,
            now,
            model=self.model,
            config=self.config,
            bad_checksums=self._host.reader.bad_checksums,
            bytes_skipped=self._host.reader.bytes_skipped,
        )

    def _failure(self, reason: str) -> LinkError | NoRobotError:
        kind = NoRobotError if self.identity is None else LinkError
        return kind(f"{self.link.url}: {reason}")

    async def _close(self) -> None:
        """Stop the robot and close the session in every case; close also a link that is blocked."""
        try:
            with suppress(LinkError, TimeoutError):
                await self._stop_robot()
        finally:
            now = self._clock()
            if self._configured and self._host.state is SessionState.OPEN:
                end_commands = self._requests.end_commands()
                for command in (commands.Stop(), *end_commands) if end_commands else ():
                    self._host.send(command, now)
            self._host.leave(now)
            try:
                with suppress(LinkError, TimeoutError):
                    async with asyncio.timeout(CLOSE_TIMEOUT):
                        await self.link.write(self._host.outgoing())
            finally:
                await self.link.close()

    async def _stop_robot(self) -> None:
        """Stop, and wait until the robot stands: without power it would roll on.

        A robot that this session never moved is another program's, which this one watches: the
        STOP at the end of the session suffices.

        Raises:
            LinkError: the link has failed.
            TimeoutError: it still moves after :data:`~pioneer3.robot.pilot.BRAKING`.
        """
        if (
            not self._configured
            or self._host.state is not SessionState.OPEN
            or not self._pilot.drove
        ):
            return
        async with asyncio.timeout(BRAKING):
            while not self._pilot.stands:
                now = self._clock()
                self._pilot.stop(now)
                for command in self._motion_commands(now):
                    self._host.send(command, now)
                await self.link.write(self._host.outgoing())
                if not (data := await self.link.read()):
                    return
                now = self._clock()
                for event in self._host.receive(data, now):
                    if isinstance(event, ReportReceived) and isinstance(event.report, Sip):
                        self._pilot.observe(self._snapshot(event.report, now), now)


def commands_for(request: MotionRequest, settings: Sequence[Command] = ()) -> list[Command]:
    """Return the commands that ask a robot for a motion: stops, then `settings`, then the rest."""
    due: list[Command] = []
    if request.stop:
        due.append(commands.Stop())
    if request.hard_stop:
        due.append(commands.EStop())
    due += settings
    if request.accelerations is not None:
        due += _acceleration_commands(request.accelerations)
    if request.motors is not None:
        due.append(commands.Enable(on=request.motors))
    if request.twist is not None:
        due += (commands.Vel(speed=request.twist.v), commands.RVel(rate=request.twist.w))
    return due


def settings_for(model: RobotModel, limits: Limits, config: Config | None = None) -> list[Command]:
    """Return the commands that set `limits` as far as the firmware allows, and switch sonars on.

    The numbers of its encoders go to a controller that tells such numbers: it forgets them when it
    is switched off, and another host may have set others.
    """
    settings: list[Command] = []
    if model.settable_speed:
        settings += (commands.SetV(limits.max_speed), commands.SetRV(limits.max_turn_rate))
    if model.settable_acceleration:
        settings += _acceleration_commands(limits.accelerations)
    if (own := model.encoders) is not None and config is not None and config.ticks_per_mm:
        settings += (commands.TicksMM(own.ticks_mm), commands.RevCount(own.rev_count))
        settings.append(commands.DriftFactor(own.drift_factor))
    elif own is not None:
        log.warning("the robot tells no TicksMM: it is not sent that of its own file")
    return [*settings, commands.Sonar(on=True)]


def _acceleration_commands(accelerations: Accelerations) -> list[Command]:
    return [
        commands.SetA(acceleration=accelerations.acceleration),
        commands.SetA(acceleration=-accelerations.deceleration),
        commands.SetRA(acceleration=accelerations.turn_acceleration),
        commands.SetRA(acceleration=-accelerations.turn_deceleration),
    ]


def own_of(identity: Identity, config: Config | None, given: GivenModel = None) -> OwnFile | None:
    """Return the robot's own file, if it has one, on top of its type's or else the given model.

    Raises:
        ConfigError: The file is wrong.
    """
    serial = config.serial_number if config else ""
    named = loaded_model(given)
    kin = named.model if isinstance(named, Fallback) else named
    assert kin is None or isinstance(kin, RobotModel)
    own = find_own((identity.name, serial), find_model(identity.model) or kin)
    any_of = {"", *SIMULATOR_SERIALS}
    if own and own.serial_number and serial not in {own.serial_number, *any_of}:
        raise ConfigError(
            f"{own.path}: of the robot with the serial number {shown(own.serial_number)}, not of "
            f"this one, {shown(serial)}: give this one a name of its own, or its file its number"
        )
    return own


def model_of(identity: Identity, config: Config | None, given: GivenModel = None) -> RobotModel:
    """Return the model that is given, that of its own file, its type's, or else a guess.

    Raises:
        ConfigError: There is no such model as is given, or the own file is wrong.
    """
    given = loaded_model(given)
    if isinstance(given, RobotModel):
        return given
    if own := own_of(identity, config, given):
        return own.model
    if found := find_model(identity.model):
        return found
    if given is not None:
        assert isinstance(given.model, RobotModel)
        return given.model
    return generic_model(
        identity.model,
        max_speed=(config.speed_top_mm_s or 0) * MM if config else 0.0,
        max_turn_rate=(config.rotation_top_deg_s or 0) * DEGREE if config else 0.0,
    )
