"""One robot of a log: what is known of it at any time."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from typing import Any, Final, TypeVar

import msgspec

from pioneer3.errors import ConfigError
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.links.tap import ROBOT
from pioneer3.log.chunks import DAMAGED
from pioneer3.log.index import LogIndex
from pioneer3.log.reader import LogMessage
from pioneer3.log.topics import SNAPSHOT, LogEvent, robots_in
from pioneer3.models import RobotModel
from pioneer3.navigation.recording import EstimateMade, MapUsed, WayPlanned
from pioneer3.robot.supervisor import ConnectionStatus, RobotInfo
from pioneer3.runtime.recording import (
    EMERGENCY_STOP,
    GIVES_MOTION,
    MODEL,
    RESET,
    CommandGiven,
    DecisionMade,
    StandsBecause,
    TruePoseTold,
    described,
    link_status,
)
from pioneer3.state import Scan, Snapshot

T = TypeVar("T")

SECOND: Final = 1_000_000_000
"""Second [ns]."""
TELL_OF_LATCH: Final = tuple(
    f'"command":"{each}"'.encode() for each in (EMERGENCY_STOP, RESET, *GIVES_MOTION)
)
"""Commands after which it is known whether the emergency stop is latched."""
FRESH: Final = SECOND + SECOND // 2
"""A true pose, which is told once a second at least, or a scan holds for so long [ns]."""


class RecordedRobot:
    """A robot of a log at one time, which :meth:`seek` sets; the topics have the prefix.

    Attributes:
        number: On the page.
        began: Time of its first snapshot [ns since 1970].
        time: [ns since 1970].
    """

    def __init__(self, number: int, name: str, index: LogIndex, prefix: str) -> None:
        self.number, self.name, self.index, self.prefix = number, name, index, prefix
        self._described = described(index.info().texts.get(f"{prefix}{ROBOT}", {}), str(index.path))
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
            MODEL: RobotModel,
            **dict.fromkeys(self.lasers, Scan),
        }
        self._topics = {prefix + kind for kind in self._kinds} | {"event"}
        self._newest: dict[str, LogMessage | None] = {}
        self._decoded: dict[str, tuple[LogMessage, Any]] = {}
        self._latch: LogMessage | None = None

    @property
    def info(self) -> RobotInfo:
        """Its description, with the model at the time."""
        model = self.told(RobotModel)
        return replace(self._described, model=model) if model else self._described

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
        self._latch = self.index.newest(
            f"{self.prefix}command", time, lambda data: _latches(data) is not None
        )

    def advance(self, time: int) -> None:
        """Go on to a later time."""
        for message in self.index.between(self.time, time, self._topics):
            kind = message.topic.removeprefix(self.prefix)
            if kind in self._kinds:
                self._newest[kind] = message
            if kind == "command" and _latches(message.data) is not None:
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

    def told(self, kind: type[T]) -> T | None:
        """Return the newest message of a class: a decision, a reason to stand, a way, a map."""
        return self._get(next(name for name, each in self._kinds.items() if each is kind), kind)

    def scan(self, laser: str) -> Scan | None:
        """Return the newest scan of a laser, by its topic, while it is fresh."""
        newest = self._newest.get(laser)
        return self._get(laser, Scan) if newest and self.time - newest.time < FRESH else None

    @property
    def emergency(self) -> bool:
        """Whether the emergency stop was latched."""
        return self._latch is not None and bool(_latches(self._latch.data))

    @property
    def link(self) -> ConnectionStatus | None:
        """The state of its link as the log tells it; `None` where it does not."""
        event = self._get("link", LogEvent)
        return link_status(event, f"{self.prefix}{ROBOT}") if event else None

    @property
    def robot_in_map(self) -> Pose2:
        """The pose to draw [m, rad]: the true one, that on its map, or that of odometry."""
        snapshot = self.snapshot
        truth, newest = self._get("truth", TruePoseTold), self._newest.get("truth")
        if truth is not None and newest is not None and self.sequence - newest.time < FRESH:
            return truth.robot_in_world
        odom = snapshot.odometry.robot_in_odom if snapshot else ORIGIN
        estimate = self.told(EstimateMade)
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
    prefixes = robots_in(index.topics)
    if not prefixes:
        raise ConfigError(f"{index.path}: no robot was connected: there is nothing to replay")
    return [
        RecordedRobot(numbers(), prefix.removesuffix("/") or label, index, prefix)
        for prefix in prefixes
    ]


def _latches(data: bytes) -> bool | None:
    """Return whether a command latches the emergency stop; `None` leaves that open."""
    if any(each in data for each in TELL_OF_LATCH):
        with suppress(*DAMAGED):
            return msgspec.json.decode(data, type=CommandGiven, strict=False).latches
    return None
