"""One robot of a log: what is known of it at any time."""

from collections.abc import Callable, Mapping
from typing import Any, Final, TypeVar

import msgspec

from pioneer3.arcos.reports import Config
from pioneer3.errors import ConfigError
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.limits import Limits
from pioneer3.log.chunks import DAMAGED
from pioneer3.log.index import LogIndex
from pioneer3.log.reader import LogMessage
from pioneer3.log.topics import LogEvent
from pioneer3.models import RobotModel, load_model
from pioneer3.navigation.recording import EstimateMade, MapUsed, WayPlanned
from pioneer3.robot.limits import limits_for
from pioneer3.robot.supervisor import Connection, ConnectionStatus, RobotInfo
from pioneer3.runtime.recording import CommandGiven, DecisionMade, StandsBecause, TruePoseTold
from pioneer3.state import Identity, Scan, Snapshot

T = TypeVar("T")

SECOND: Final = 1_000_000_000
"""Second [ns]."""
FRESH: Final = SECOND + SECOND // 2
"""A true pose, which is told once a second at least, or a scan holds for so long [ns]."""
SNAPSHOT: Final = "snapshot"
"""Topic of a robot; the others likewise."""
EMERGENCY_STOP: Final = "emergency stop"
"""Command in the log."""
RESET: Final = "reset"
"""Begin of the command that ends the emergency stop."""
GIVES_MOTION: Final = (b'"command":"drive"', b'"command":"start"')
"""Commands that nobody obeys while the emergency stop is latched."""
USUAL_MODEL: Final = "p3dx-sh"
"""Robot that is drawn where the model of the log is not known here."""


class RecordedRobot:
    """A robot of a log at one time, which :meth:`seek` sets; the topics have the prefix.

    Attributes:
        number: On the page.
        info: As the log describes it.
        began: Time of its first snapshot [ns since 1970].
        time: [ns since 1970].
    """

    def __init__(self, number: int, name: str, index: LogIndex, prefix: str) -> None:
        self.number, self.name, self.index, self.prefix = number, name, index, prefix
        self.info = info_of(index.info().texts.get(f"{prefix}robot", {}), str(index.path))
        self.began = index.first(prefix + SNAPSHOT)
        self.time = 0
        self.lasers = sorted(
            topic.removeprefix(prefix)
            for topic in index.topics
            if topic.startswith(f"{prefix}scan/")
        )
        self._kinds: dict[str, type] = {
            SNAPSHOT: Snapshot,
            "decision": DecisionMade,
            "standing": StandsBecause,
            "command": CommandGiven,
            "estimate": EstimateMade,
            "way": WayPlanned,
            "truth": TruePoseTold,
            "map": MapUsed,
            **dict.fromkeys(self.lasers, Scan),
        }
        self._topics = {prefix + kind for kind in self._kinds} | {"event"}
        self._newest: dict[str, LogMessage | None] = {}
        self._decoded: dict[str, tuple[LogMessage, Any]] = {}
        self._latch: LogMessage | None = None

    @property
    def knows_places(self) -> bool:
        """Whether it was on a map."""
        return f"{self.prefix}estimate" in self.index.topics

    def seek(self, time: int) -> None:
        """Go to a time: what was told last before it is known."""
        self.time = time
        for kind in self._kinds:
            self._newest[kind] = self.index.newest(self.prefix + kind, time)
        self._newest["link"] = self.index.newest("event", time, self._is_link)
        self._latch = self.index.newest(f"{self.prefix}command", time, _tells_of_latch)

    def advance(self, time: int) -> None:
        """Go on to a later time."""
        for message in self.index.between(self.time, time, self._topics):
            kind = message.topic.removeprefix(self.prefix)
            if kind in self._kinds:
                self._newest[kind] = message
            if kind == "command" and _tells_of_latch(message.data):
                self._latch = message
            if message.topic == "event" and self._is_link(message.data):
                self._newest["link"] = message
        self.time = time

    @property
    def snapshot(self) -> Snapshot | None:
        """The newest snapshot."""
        return self._get(SNAPSHOT, Snapshot)

    @property
    def sequence(self) -> int:
        """When the newest snapshot was taken [ns since 1970], 0 for none."""
        newest = self._newest.get(SNAPSHOT)
        return newest.time if newest else 0

    @property
    def is_known(self) -> bool:
        """Whether the log tells of it at the time."""
        return self.began <= self.time <= self.index.ended + FRESH

    @property
    def decision(self) -> DecisionMade | None:
        """The newest decision."""
        return self._get("decision", DecisionMade)

    @property
    def standing(self) -> StandsBecause | None:
        """The reason to stand as it was told; older logs have none."""
        return self._get("standing", StandsBecause)

    @property
    def estimate(self) -> EstimateMade | None:
        """Where it was on its map."""
        return self._get("estimate", EstimateMade)

    @property
    def way(self) -> WayPlanned | None:
        """The way that it took."""
        return self._get("way", WayPlanned)

    @property
    def map(self) -> MapUsed | None:
        """The map that it drove on."""
        return self._get("map", MapUsed)

    def scan(self, laser: str) -> Scan | None:
        """Return the newest scan of a laser, by its topic, while it is fresh."""
        newest = self._newest.get(laser)
        return self._get(laser, Scan) if newest and self.time - newest.time < FRESH else None

    @property
    def emergency(self) -> bool:
        """Whether the emergency stop was latched."""
        return self._latch is not None and _is_stop(self._latch.data)

    @property
    def link(self) -> ConnectionStatus | None:
        """The state of its link as the log tells it; `None` where it does not."""
        event = self._get("link", LogEvent)
        if event is None:
            return None
        told = event.text.removeprefix(f"{self.prefix}robot: ")
        connection, _, message = told.partition(": ")
        try:
            return ConnectionStatus(Connection(connection), message)
        except ValueError:
            return None

    @property
    def robot_in_map(self) -> Pose2:
        """The pose to draw [m, rad]: the true one, that on its map, or that of odometry."""
        snapshot = self.snapshot
        truth, newest = self._get("truth", TruePoseTold), self._newest.get("truth")
        if truth is not None and newest is not None and self.sequence - newest.time < FRESH:
            return truth.robot_in_world
        odom = snapshot.odometry.robot_in_odom if snapshot else ORIGIN
        estimate = self.estimate
        return (estimate.odom_in_map or ORIGIN) @ odom if estimate else odom

    def _get(self, kind: str, of: type[T]) -> T | None:
        """Return the newest message of a kind, decoded once; one that is damaged is none."""
        newest = self._newest.get(kind)
        if newest is None:
            return None
        known = self._decoded.get(kind)
        if known is None or known[0] is not newest:
            try:
                known = newest, newest.decode(of)
            except DAMAGED:
                known = newest, None
            self._decoded[kind] = known
        return known[1]

    def _is_link(self, data: bytes) -> bool:
        return b'"kind":"link"' in data and f'"text":"{self.prefix}robot: '.encode() in data


def robots_of(index: LogIndex, numbers: Callable[[], int], label: str) -> list[RecordedRobot]:
    """Return the robots of a log; one without a name gets the label.

    Raises:
        ConfigError: No robot was connected.
    """
    prefixes = sorted(t.removesuffix(SNAPSHOT) for t in index.topics if _is_snapshot(t))
    if not prefixes:
        raise ConfigError(f"{index.path}: no robot was connected: there is nothing to replay")
    return [
        RecordedRobot(numbers(), prefix.removesuffix("/") or label, index, prefix)
        for prefix in prefixes
    ]


def info_of(texts: Mapping[str, str], url: str) -> RobotInfo:
    """Return the description of a robot by the texts of its log, as far as they can be read."""
    model, config = _model(texts.get("model", "")), _read(texts.get("configuration", ""), Config)
    return RobotInfo(
        identity=Identity(name=texts.get("name", ""), family=model.family, model=model.name),
        model=model,
        limits=_read(texts.get("limits", ""), Limits) or limits_for(model, config),
        config=config,
        url=url,
        speed=None,
    )


def _model(name: str) -> RobotModel:
    """Return a shipped model; nothing else is read because a log names it."""
    try:
        return load_model(name if "." not in name and "/" not in name else USUAL_MODEL)
    except ConfigError:
        return load_model(USUAL_MODEL)


def _read(text: str, kind: type[T]) -> T | None:
    try:
        return msgspec.json.decode(text, type=kind)
    except (msgspec.MsgspecError, ConfigError):
        return None


def _is_snapshot(topic: str) -> bool:
    return topic == SNAPSHOT or topic.endswith(f"/{SNAPSHOT}")


def _is_stop(command: bytes) -> bool:
    return f'"command":"{EMERGENCY_STOP}"'.encode() in command


def _tells_of_latch(command: bytes) -> bool:
    """Whether a command latches the emergency stop, or shows that it is not latched."""
    if _is_stop(command) or f'"command":"{RESET}'.encode() in command:
        return True
    return b'"refused":""' in command and any(each in command for each in GIVES_MOTION)
