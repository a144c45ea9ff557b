"""Today's driver over the bytes of a log: does it see what was seen then, bit for bit?

Each piece of bytes is read at the very time that the log tells, in virtual time, and each snapshot
is compared with the recorded one, by the model that was in force. Each decision is made again of
what the actions wanted then: a log has their wishes, not their reasons to have them. Each velocity
that was sent has to be that of the decision then, within the limits: a log has not all reasons of
the pilot to stand, which it may at any time. A reason to stand has to be one that the readings
allow. Bytes of lasers become scans again: their times are told to 0.1 ms, so that the recorded
stamp is taken on where it is near enough.
"""

import asyncio
from bisect import bisect_right
from collections.abc import Callable, Coroutine, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import partial
from itertools import chain, repeat
from math import inf, nextafter
from operator import itemgetter
from typing import TYPE_CHECKING, Any, Final, Generic, TypeVar

import msgspec

from pioneer3.arcos.commands import RVel, Vel, from_payload, to_payload
from pioneer3.arcos.host_events import Timing
from pioneer3.arcos.packet import PacketReader
from pioneer3.behaviors.engine import Decision, decided_again
from pioneer3.errors import ConfigError, LinkError, NoRobotError
from pioneer3.geometry import ORIGIN, STILL, Twist2
from pioneer3.lasers.client import Patience, RawScan, ScanSettings
from pioneer3.limits import Limits
from pioneer3.links import Link
from pioneer3.links.tap import ROBOT
from pioneer3.log.reader import RunLog
from pioneer3.log.topics import EVENT, ROUGH, SNAPSHOT, LogEvent, LogTopic, robots_in
from pioneer3.models import Fallback, GivenModel, RobotModel, loaded_model
from pioneer3.models.lasers import LaserProtocol
from pioneer3.names import printable
from pioneer3.robot.correction import TwistCorrection
from pioneer3.robot.explain import DISCONNECTED, FROM_READINGS, Reason, allowed
from pioneer3.robot.lasers.mounting import Mounting, PoseAt
from pioneer3.robot.limits import limit
from pioneer3.robot.poses import Poses
from pioneer3.robot.supervisor import RobotInfo, Supervisor
from pioneer3.runtime.recorded_wire import LONGEST_PAUSE, RecordedWire, opens
from pioneer3.runtime.recording import AT_ORIGIN, MODEL, RENEWED, DecisionMade, StandsBecause
from pioneer3.state import Bumpers, Scan, Snapshot
from pioneer3.tasks import FastTimeLoop
from pioneer3.units import DEGREE

if TYPE_CHECKING:
    from pioneer3.robot.lasers.driver import LaserConfig

T = TypeVar("T")

PATIENT: Final = Timing(silence=inf)
"""The log tells when a link was lost."""
PATIENT_LASER: Final = Patience(silence=LONGEST_PAUSE, give_up=LONGEST_PAUSE)
"""Likewise: a busy computer may have been late, and bytes came meanwhile."""
LONGER: Final = 0.002
"""A driver whose time was up may have read bytes so shortly after [s]."""
PATIENT_SCIP: Final = Patience(
    answer=Patience().answer + LONGER, silence=Patience().silence + LONGER, give_up=LONGEST_PAUSE
)
"""A SCIP laser is started again, and asked for its clock, when it was."""
LATE: Final = 0.05
"""A velocity may be on its way to the wire for so long [s], and limits to the log."""
TICK: Final = 1.1 * ROUGH / 1e9
"""Times of lasers' bytes are told to that [s], and a little for rounding."""
ASKED: Final = 0.1
"""Stamps by a clock that was asked for its time differ by less [s]: as long as an answer takes."""
OF_PLACE: Final = ("stamp", "robot_in_odom", "last_in_odom")
"""Fields of a scan that depend on the time of its bytes."""
Reasons = frozenset[Reason | None]
"""Reasons to stand that readings allow."""
MOVES: Final[Reasons] = frozenset({None})
"""The robot moves."""
NONE: Final = "none"
"""In place of a value that is not there."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Difference:
    """The first difference: when [ns since 1970], in which field, and both values."""

    time: int
    field: str
    recorded: str
    now: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Verification:
    """The result for one robot of a log: how much is equal, and the first that is not.

    Attributes:
        compared: Snapshots that are equal.
        scans: That are equal; none of lasers in the robot's own bytes.
        velocities: That were sent as the decisions tell; of a robot whose own odometry is
            corrected, with what that makes of them, to a degree per second.
        reasons: To stand or to move, as the readings allow; none of older logs.

    `robot` is its name in the log, empty for the only one.
    """

    robot: str
    compared: int
    decisions: int
    velocities: int
    reasons: int
    scans: int
    difference: Difference | None


def verify(log: RunLog, model: GivenModel = None) -> list[Verification]:
    """Run the driver over the bytes of each robot of a log, and compare what it sees.

    `model` is given if somebody named one at the recording, and an older version wrote the log.

    Raises:
        ConfigError: The log is damaged, lacks a file or messages, or has nothing to compare; or
            there is no such model.
    """
    log = log.as_of_now()
    topics = log.topics()
    prefixes = [each for each in robots_in(topics) if f"wire/{each}{ROBOT}/in" in topics]
    if not prefixes:
        raise ConfigError(f"{log.path}: it has no robot's snapshots and bytes to compare")
    if log.info().gaps:
        raise ConfigError(f"{log.path}: a file of this log has gone, and with it bytes to compare")
    for _, event in log.of(EVENT):
        if event.kind == "dropped":
            raise ConfigError(f"{log.path}: it lacks {printable(event.text)}")
    return [_verify(log, prefix, model) for prefix in prefixes]


def _verify(log: RunLog, prefix: str, model: GivenModel) -> Verification:
    wire = RecordedWire(log, prefix + ROBOT)
    known = log.info().texts.get(prefix + ROBOT, {})
    models: Iterator[RobotModel | Fallback | None]
    models = repeat(loaded_model(model)) if model is not None else _models(log, prefix, known)
    lasers = [*_lasers(log, prefix)]
    with asyncio.Runner(loop_factory=partial(FastTimeLoop, wire.begin)) as runner:
        comparison = _Comparison(log, LogTopic(prefix + SNAPSHOT, Snapshot), wire.seconds)
        kind, text = AT_ORIGIN
        told = LogEvent(kind, prefix + text)
        restarts = [wire.seconds(time) for time, event in log.of(EVENT) if event == told]
        infos = runner.run(_drive(wire, comparison, models, lasers, restarts))
    decisions, velocities, reasons = _Decisions(log, prefix, wire, known), 0, 0
    difference = comparison.missing() or decisions.difference
    if not difference and infos:
        velocities, difference = decisions.sent(comparison.bumpers, infos)
    if not difference:
        reasons, difference = _reasons(log, prefix, wire, comparison.read)
    return Verification(
        robot=prefix.rstrip("/"),
        compared=comparison.compared,
        decisions=len(decisions.made),
        velocities=velocities,
        reasons=reasons,
        scans=sum(each.scans.compared for each in lasers),
        difference=difference
        or next(filter(None, (each.scans.missing() for each in lasers)), None),
    )


def _models(log: RunLog, prefix: str, known: Mapping[str, str]) -> Iterator[RobotModel | None]:
    """Return the model at each connection of a robot: the last that was told before the next one.

    An older log has the last one alone.
    """
    model: RobotModel | None = None
    if "parameters" in known:
        with log.damage_told():
            model = msgspec.json.decode(known["parameters"], type=RobotModel)
    topic, at_each = LogTopic(prefix + MODEL, RobotModel), list[RobotModel | None]()
    for message in log.messages({topic.name, EVENT.name}.__contains__):
        if message.topic == topic.name:
            model = log.decoded(message, topic)
            if at_each:
                at_each[-1] = model
        elif opens(prefix + ROBOT, log.decoded(message, EVENT)):
            at_each.append(model)
    return chain(at_each, repeat(model))


@dataclass(frozen=True, slots=True)
class _Laser:
    """A laser of a log at a port of its own, with its place and the comparison of its scans."""

    config: "LaserConfig"
    mounting: Mounting
    scans: "_Comparison[Scan]"

    async def scan(self, poses: Poses, before: Poses) -> None:
        """Run its driver on a robot with these poses, and those of a tick before."""
        from pioneer3.robot.lasers.driver import LaserDriver  # loads slowly

        told = {each.name: getattr(self.mounting, each.name) for each in fields(self.mounting)}
        near = ASKED if self.config.protocol is LaserProtocol.SCIP else TICK
        mounting = _Placed(**told, near=near, before=before, scans=self.scans)
        driver = LaserDriver(self.config, poses.at, lambda: mounting)
        driver.scan_taken = self.scans.take
        await _play(driver.run(), self.scans)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Placed(Mounting):
    """The place of a laser whose scans get the recorded stamp, where that is near enough [s].

    So they get the place on the robot, which is no result: the robot may be known later. The poses
    are those at that stamp, by the reports until then or a tick `before`.
    """

    near: float
    before: Poses
    scans: "_Comparison[Scan]"

    def scan(self, raw: RawScan, sequence: int, name: str, pose_at: PoseAt) -> Scan:
        """Return the scan of the robot for the readings of its laser."""
        recorded = self.scans.next
        place = replace(self, sensor_in_robot=recorded.sensor_in_robot) if recorded else self
        made = Mounting.scan(place, raw, sequence, name, pose_at)
        if recorded is None or abs(recorded.stamp - made.stamp) > self.near:
            return made
        begin = raw.stamp + recorded.stamp - made.stamp
        for stamp in (begin, nextafter(begin, inf), nextafter(begin, -inf)):
            for at in (pose_at, self.before.at):
                again = Mounting.scan(place, replace(raw, stamp=stamp), sequence, name, at)
                if all(getattr(again, part) == getattr(recorded, part) for part in OF_PLACE):
                    return again
        return made


def _lasers(log: RunLog, prefix: str) -> Iterator[_Laser]:
    """Yield the lasers of a robot at ports of their own."""
    from pioneer3.robot.lasers.driver import LaserConfig

    for described, texts in log.info().texts.items():
        before, slash, name = described.rpartition("/")
        if before + slash != prefix or "protocol" not in texts:
            continue
        with log.damage_told():
            protocol = msgspec.json.decode(texts["protocol"], type=LaserProtocol)
        is_scip = protocol is LaserProtocol.SCIP
        wire = RecordedWire(log, described, late=TICK, longer=LONGER if is_scip else None)
        with log.damage_told():
            topic = LogTopic(f"{prefix}scan/{name}", Scan)
            scans = _Comparison(log, topic, wire.seconds)
            wire.speeds = msgspec.json.decode(texts["speeds"], type=tuple[int, ...])
            config = LaserConfig(
                url=wire.url,
                open=wire.open,
                name=name,
                protocol=protocol,
                settings=msgspec.json.decode(texts["settings"], type=ScanSettings),
                patience=PATIENT_SCIP if is_scip else PATIENT_LASER,
                open_patience=None,  # the log tells when it was opened
                time_offset=msgspec.json.decode(texts.get("time_offset", "0"), type=float),
            )
            yield _Laser(config, msgspec.json.decode(texts["mounting"], type=Mounting), scans)


def _reasons(
    log: RunLog, prefix: str, wire: RecordedWire, read: Sequence[tuple[float, Reasons]]
) -> tuple[int, Difference | None]:
    """Return how many reasons fit the readings, and the first one that does not."""
    count = 0
    for time, told in log.of(LogTopic(f"{prefix}standing", StandsBecause)):
        lately, reason = _lately(read, wire.seconds(time) + LATE), told.reason
        fits = reason in frozenset().union(*lately) or (
            reason is not None and reason not in FROM_READINGS and lately != [MOVES]
        )
        is_lost = reason is not None and reason.symptom is DISCONNECTED.symptom
        if lately and not is_lost and not fits:
            may_be = " or ".join(sorted(str(each).removesuffix(".") for each in lately[-1] if each))
            recorded, now = (each or NONE for each in (str(reason or ""), may_be))
            return count, Difference(time=time, field="standing", recorded=recorded, now=now)
        count += 1
    return count, None


class _Decisions:
    """The decisions of a log that are the same today, up to the first difference."""

    def __init__(
        self, log: RunLog, prefix: str, wire: RecordedWire, known: Mapping[str, str]
    ) -> None:
        self.made: list[tuple[float, Decision]] = []
        self.difference: Difference | None = None
        self._log, self._wire = log, wire
        self._last = wire.seconds(log.info().ended)
        topic = LogTopic(f"{prefix}limits", Limits)
        self._limits = [(wire.seconds(time), limits) for time, limits in log.of(topic)]
        if not self._limits and "limits" in known:  # an older log
            with log.damage_told():
                self._limits = [(-inf, msgspec.json.decode(known["limits"], type=Limits))]
        for time, made in log.of(LogTopic(f"{prefix}decision", DecisionMade)):
            at = wire.seconds(time)
            if not (limits := _lately(self._limits, at + LATE)):
                continue
            with log.damage_told():
                again = decided_again(made.decision, limits[-1])
            self.difference = _difference(time, made.decision, again)
            if self.difference is not None:
                return
            self.made.append((at, made.decision))

    def sent(
        self, bumpers: Sequence[tuple[float, Bumpers]], infos: Sequence[tuple[float, RobotInfo]]
    ) -> tuple[int, Difference | None]:
        """Return how many velocities were sent as the decisions tell, and the first that was not.

        Their ends are told once a second where they only go on.
        """
        reader, count, speed = PacketReader(), 0, b""
        for message in self._log.messages(f"wire/{self._wire.link}/out".__eq__):
            at = self._wire.seconds(message.time)
            if at > self._last - LATE:
                break  # a log that was cut off may lack the decision, which it is told later
            for payload in reader.feed(message.data, at):
                if payload[:1] == bytes([Vel.ID]):
                    speed = payload
                elif payload[:1] == bytes([RVel.ID]) and self._limits:
                    may_be = [STILL] + [
                        limit(decision.twist, limits, pressed)
                        for decision in _lately(self.made, at)
                        for limits in _lately(self._limits, at + LATE)
                        for pressed in _lately(bumpers, at) or [Bumpers()]
                        if at <= decision.until + RENEWED + LATE
                    ]
                    known = _lately(infos, at) or [infos[0][1]]
                    told = [
                        each
                        for info in known
                        for twist in may_be
                        for each in _corrected(twist, info)
                    ]
                    if (speed, payload) not in map(_payloads, told):
                        sent = f"{from_payload(speed)}, {from_payload(payload)}"
                        return count, Difference(
                            time=message.time, field="sent", recorded=sent, now=str(may_be[-1])
                        )
                    count += 1
        return count, None


def _corrected(twist: Twist2, info: RobotInfo) -> list[Twist2]:
    """Return the velocities for a motion: rounding moves its rest into the next one."""
    matrix = info.model.odometry.matrix(info.model.wheel_base)
    if matrix is None or twist.is_zero:
        return [twist]
    told, top = TwistCorrection(matrix, info.limits).told(twist, 0.0), info.limits.max_turn_rate
    turns = (told.w + more for more in (0.0, DEGREE, -DEGREE))
    return [Twist2(told.v, max(-top, min(top, turn))) for turn in turns]


def _payloads(twist: Twist2) -> tuple[bytes, bytes]:
    return to_payload(Vel(speed=twist.v)), to_payload(RVel(rate=twist.w))


def _lately(told: Sequence[tuple[float, T]], at: float) -> list[T]:
    """Return the last values at a time [s], and those that were so until shortly before."""
    first = bisect_right(told, at - LATE, key=itemgetter(0))
    last = bisect_right(told, at, key=itemgetter(0))
    return [each for _, each in told[max(0, first - 1) : last]]


async def _drive(
    wire: RecordedWire,
    comparison: "_Comparison[Snapshot]",
    models: Iterator[RobotModel | Fallback | None],
    lasers: Sequence[_Laser],
    restarts: Sequence[float],
) -> list[tuple[float, RobotInfo]]:
    """Run the driver; return the descriptions of the robot, each with its time [s]."""

    async def opened() -> Link:
        link = await wire.open()
        supervisor.model = next(models)
        return link

    supervisor = Supervisor(opened, auto_enable=False, timing=PATIENT)
    before, loop = Poses(), asyncio.get_running_loop()
    infos: list[tuple[float, RobotInfo]] = []
    for at in restarts:
        loop.call_at(at, supervisor.assembler.odometer.restart, ORIGIN)

    def take(snapshot: Snapshot) -> None:
        loop.call_later(TICK, before.add, snapshot)
        assert supervisor.info is not None
        _note(infos, loop.time(), supervisor.info)
        comparison.take(snapshot)

    supervisor.snapshot_taken = take
    scanning = (laser.scan(supervisor.poses, before) for laser in lasers)
    await asyncio.gather(_play(supervisor.run(), comparison), *scanning)
    return infos


async def _play(driver: Coroutine[Any, Any, None], comparison: "_Comparison[Any]") -> None:
    driving = asyncio.ensure_future(driver)
    differs = asyncio.ensure_future(comparison.differs.wait())
    await asyncio.wait({driving, differs}, return_when=asyncio.FIRST_COMPLETED)
    for task in (driving, differs):
        task.cancel()
    for ended in await asyncio.gather(driving, differs, return_exceptions=True):
        if isinstance(ended, Exception) and not isinstance(ended, LinkError | NoRobotError):
            raise ended


class _Comparison(Generic[T]):
    """Compares a part of messages with the recorded ones, up to the first difference."""

    def __init__(self, log: RunLog, topic: LogTopic[T], seconds: Callable[[int], float]) -> None:
        self.compared = 0
        self._seconds = seconds
        self.difference: Difference | None = None
        self.differs = asyncio.Event()
        self.bumpers: list[tuple[float, Bumpers]] = []
        self.read: list[tuple[float, Reasons]] = []
        self._recorded = log.of(topic)
        self._next = next(self._recorded, None)

    def take(self, found: T) -> None:
        """Take the next message of today's driver."""
        if self._next is None or self.difference is not None:
            return  # read while the connection was closed: nobody was told
        time, recorded = self._next
        if isinstance(found, Snapshot) and isinstance(recorded, Snapshot):
            if found.link.sessions < recorded.link.sessions:
                return  # likewise
            told_at = self._seconds(time)  # by which the driver had it: it may have been held up
            _note(self.bumpers, told_at, found.bumpers)
            _note(self.read, told_at, allowed(found))
        self.difference = _difference(time, recorded, found)
        if self.difference is not None:
            self.differs.set()
            return
        self.compared += 1
        self._next = next(self._recorded, None)

    @property
    def next(self) -> T | None:
        """The message that comes next."""
        return self._next[1] if self._next else None

    def missing(self) -> Difference | None:
        """Return the first difference, or that of a message today's driver did not come to."""
        if self.difference is not None or self._next is None:
            return self.difference
        number = str(getattr(self._next[1], "sequence", NONE))
        return Difference(time=self._next[0], field="sequence", recorded=number, now=NONE)


def _note(changes: list[tuple[float, T]], now: float, value: T) -> None:
    """Note a value of `now` [s] if it is new."""
    if not changes or value != changes[-1][1]:
        changes.append((now, value))


def _difference(time: int, recorded: object, found: object) -> Difference | None:
    """Return the first field in which two objects differ, by texts that tell each value exactly."""
    if msgspec.msgpack.encode(recorded) == msgspec.msgpack.encode(found):
        return None
    was, now = (dict(_fields("", msgspec.to_builtins(each))) for each in (recorded, found))
    field = next((each for each in was | now if was.get(each) != now.get(each)), None)
    if field is None:
        return None
    return Difference(
        time=time, field=field, recorded=was.get(field, NONE), now=now.get(field, NONE)
    )


def _fields(name: str, value: Any) -> Iterator[tuple[str, str]]:
    if isinstance(value, dict):
        for key, each in value.items():
            yield from _fields(f"{name}.{key}" if name else key, each)
    elif isinstance(value, list | tuple):
        yield f"{name}.length", str(len(value))
        for number, each in enumerate(value):
            yield from _fields(f"{name}[{number}]", each)
    else:
        yield name, repr(value)
