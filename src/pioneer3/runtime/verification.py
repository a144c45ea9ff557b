"""Today's driver over the bytes of a log: does it see what was seen then, bit for bit?

Each piece of bytes is read at the very time that the log tells, in virtual time, and each snapshot
is compared with the recorded one, by the model that was in force. Each decision is made again of
what the actions wanted then: a log has their wishes, not their reasons to have them. Each velocity
that was sent has to be that of the decision then, within the limits: a log has not all reasons of
the pilot to stand, which it may at any time. A reason to stand was told if, and only if, the
readings say that the robot stood. Bytes of lasers become scans again, with the same readings: their
times are told to 0.1 ms, and so poses and stamps are not the same.
"""

import asyncio
from bisect import bisect_right
from collections.abc import Callable, Coroutine, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from math import inf
from operator import itemgetter
from typing import TYPE_CHECKING, Any, Final, Generic, TypeVar

import msgspec

from pioneer3.arcos.commands import RVel, Vel, from_payload, to_payload
from pioneer3.arcos.host_events import Timing
from pioneer3.arcos.packet import PacketReader
from pioneer3.behaviors.engine import Decision, decided_again
from pioneer3.errors import ConfigError, LinkError, NoRobotError
from pioneer3.geometry import STILL, Twist2
from pioneer3.lasers.client import ScanSettings
from pioneer3.limits import Limits
from pioneer3.links.tap import ROBOT
from pioneer3.log.reader import RunLog
from pioneer3.log.topics import SNAPSHOT, LogTopic, robots_in
from pioneer3.models import GivenModel, RobotModel
from pioneer3.models.lasers import LaserProtocol
from pioneer3.robot.correction import TwistCorrection
from pioneer3.robot.explain import DISCONNECTED
from pioneer3.robot.lasers.mounting import Mounting
from pioneer3.robot.limits import limit
from pioneer3.robot.pilot import stands
from pioneer3.robot.poses import Poses
from pioneer3.robot.supervisor import RobotInfo, Supervisor
from pioneer3.runtime.recorded_wire import RecordedWire
from pioneer3.runtime.recording import RENEWED, DecisionMade, StandsBecause
from pioneer3.state import Bumpers, Scan, Snapshot
from pioneer3.tasks import FastTimeLoop
from pioneer3.units import DEGREE

if TYPE_CHECKING:
    from pioneer3.robot.lasers.driver import LaserConfig

T = TypeVar("T")

PATIENT: Final = Timing(silence=inf)
"""The log tells when a link was lost."""
LATE: Final = 0.05
"""A velocity may be on its way to the wire for so long [s], and limits to the log."""
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
        scans: Scans whose readings are equal; none of lasers in the robot's own bytes.
        velocities: That were sent as the decisions tell; of a robot whose own odometry is
            corrected, with what that makes of them, to a degree per second.
        reasons: To stand or to move, as the readings tell; none of older logs.

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
        ConfigError: The log is damaged, or has nothing to compare; or there is no such model.
    """
    topics = log.topics()
    prefixes = [each for each in robots_in(topics) if f"wire/{each}{ROBOT}/in" in topics]
    if not prefixes:
        raise ConfigError(f"{log.path}: it has no robot's snapshots and bytes to compare")
    return [_verify(log, prefix, model) for prefix in prefixes]


def _verify(log: RunLog, prefix: str, model: GivenModel) -> Verification:
    wire = RecordedWire(log, prefix + ROBOT)
    known = log.info().texts.get(prefix + ROBOT, {})
    if model is None and "parameters" in known:
        with log.damage_told():
            model = msgspec.json.decode(known["parameters"], type=RobotModel)
    lasers = [*_lasers(log, prefix)]
    with asyncio.Runner(loop_factory=partial(FastTimeLoop, wire.begin)) as runner:
        comparison = _Comparison(log, LogTopic(prefix + SNAPSHOT, Snapshot))
        info = runner.run(_drive(wire, comparison, model, lasers))
    decisions, velocities, reasons = _Decisions(log, prefix, wire, known), 0, 0
    difference = comparison.missing() or decisions.difference
    if not difference and info:
        velocities, difference = decisions.sent(comparison.bumpers, info)
    if not difference:
        reasons, difference = _reasons(log, prefix, wire, comparison.stood)
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


@dataclass(frozen=True, slots=True)
class _Laser:
    """A laser of a log at a port of its own, with its place and the comparison of its scans."""

    config: "LaserConfig"
    mounting: Mounting
    scans: "_Comparison[Scan]"

    async def scan(self, poses: Poses) -> None:
        """Run its driver on a robot with these poses."""
        from pioneer3.robot.lasers.driver import LaserDriver  # loads slowly

        driver = LaserDriver(self.config, poses.at, lambda: self.mounting)
        driver.scan_taken = self.scans.take
        await _play(driver.run(), self.scans)


def _lasers(log: RunLog, prefix: str) -> Iterator[_Laser]:
    """Yield the lasers of a robot at ports of their own."""
    from pioneer3.robot.lasers.driver import LaserConfig

    for described, texts in log.info().texts.items():
        before, slash, name = described.rpartition("/")
        if before + slash != prefix or "protocol" not in texts:
            continue
        wire = RecordedWire(log, described)
        with log.damage_told():
            protocol = msgspec.json.decode(texts["protocol"], type=LaserProtocol)
            topic = LogTopic(f"{prefix}scan/{name}", Scan)
            scans = _Comparison(log, topic, _readings)
            wire.speeds = msgspec.json.decode(texts["speeds"], type=tuple[int, ...])
            config = LaserConfig(
                url=wire.url,
                open=wire.open,
                name=name,
                protocol=protocol,
                settings=msgspec.json.decode(texts["settings"], type=ScanSettings),
                time_offset=msgspec.json.decode(texts.get("time_offset", "0"), type=float),
            )
            yield _Laser(config, msgspec.json.decode(texts["mounting"], type=Mounting), scans)


def _readings(scan: Scan) -> object:
    """Return the number of a scan, and what its laser measured."""
    return [scan.sequence, scan.angles, scan.ranges, scan.reflectances, scan.echoes]


def _reasons(
    log: RunLog, prefix: str, wire: RecordedWire, stood: Sequence[tuple[float, bool]]
) -> tuple[int, Difference | None]:
    """Return how many reasons fit the readings, and the first one that does not."""
    count = 0
    for time, told in log.of(LogTopic(f"{prefix}standing", StandsBecause)):
        lately, reason = _lately(stood, wire.seconds(time) + LATE), told.reason
        is_lost = reason is not None and reason.symptom is DISCONNECTED.symptom
        if lately and not is_lost and (reason is not None) not in lately:
            now = "the robot stands" if lately[-1] else "the robot moves"
            recorded = NONE if reason is None else reason.text
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
        self, bumpers: Sequence[tuple[float, Bumpers]], info: RobotInfo
    ) -> tuple[int, Difference | None]:
        """Return how many velocities were sent as the decisions tell, and the first that was not.

        Their ends are told once a second where they only go on.
        """
        reader, count, speed = PacketReader(), 0, b""
        for message in self._log.messages(f"wire/{self._wire.link}/out".__eq__):
            at = self._wire.seconds(message.time)
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
                    told = [each for twist in may_be for each in _corrected(twist, info)]
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
    model: GivenModel,
    lasers: Sequence[_Laser],
) -> RobotInfo | None:
    supervisor = Supervisor(wire.open, model=model, auto_enable=False, timing=PATIENT)
    supervisor.snapshot_taken = comparison.take
    scanning = (laser.scan(supervisor.poses) for laser in lasers)
    await asyncio.gather(_play(supervisor.run(), comparison), *scanning)
    return supervisor.info


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

    def __init__(
        self, log: RunLog, topic: LogTopic[T], part: Callable[[T], object] = lambda message: message
    ) -> None:
        self.compared = 0
        self.difference: Difference | None = None
        self.differs = asyncio.Event()
        self.bumpers: list[tuple[float, Bumpers]] = []
        self.stood: list[tuple[float, bool]] = []
        self._part, self._recorded = part, log.of(topic)
        self._next = next(self._recorded, None)

    def take(self, found: T) -> None:
        """Take the next message of today's driver."""
        if self._next is None or self.difference is not None:
            return  # read while the connection was closed: nobody was told
        time, recorded = self._next
        if isinstance(found, Snapshot) and isinstance(recorded, Snapshot):
            if found.link.sessions < recorded.link.sessions:
                return  # likewise
            now = asyncio.get_running_loop().time()
            _note(self.bumpers, now, found.bumpers)
            _note(self.stood, now, stands(found))
        self.difference = _difference(time, self._part(recorded), self._part(found))
        if self.difference is not None:
            self.differs.set()
            return
        self.compared += 1
        self._next = next(self._recorded, None)

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
