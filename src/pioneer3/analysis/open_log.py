"""A log that is open: its robots, its times, and its messages as objects and arrays."""

from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from datetime import datetime
from functools import cached_property
from pathlib import Path
from typing import Any, Final

from pioneer3.errors import ConfigError
from pioneer3.log.folder import named_log_path
from pioneer3.log.index import LogIndex
from pioneer3.log.moment import Moment, time_of
from pioneer3.log.reader import LogInfo, LogMessage, RunLog, whole_log
from pioneer3.log.topics import LogEvent, LogTopic, robots_in
from pioneer3.names import printable
from pioneer3.navigation.recording import KINDS
from pioneer3.runtime.recording import CommandGiven, DecisionMade
from pioneer3.state import Scan, Snapshot

EVENTS: Final = "event"
"""Topic that all robots of a log share."""
NANOSECONDS: Final = 1e9
"""Nanoseconds in a second."""
FARTHEST: Final = 50_000
"""Messages that are looked at for the last one of another kind: more than an hour of decisions."""
CLOCKS_APART: Final = 60.0
"""Farther from the time of its message, the time that a reading tells is damaged [s]."""


@dataclass(frozen=True)
class OpenLog:
    """A log that is open, or a part of it: the messages of one robot, of some time.

    It begins in the file at `path`, and may go on in others.

    Times are in seconds since the log began. Nothing is kept in memory: each call reads the file.

    Raises:
        PortNotFoundError: There is no such file.
        ConfigError: It is no log, or damaged; so do all methods.
    """

    path: Path
    more: tuple[Path, ...] = ()
    _robot: str | None = None
    _begin: int | None = None
    _end: int | None = None

    def __post_init__(self) -> None:
        RunLog(self.path, *self.more)

    def info(self) -> LogInfo:
        """Return the facts of the whole log: the command, the robots, the number of messages."""
        return self._info

    @property
    def began(self) -> datetime:
        """When the log began, in the time of this computer."""
        return datetime.fromtimestamp(self._info.began / NANOSECONDS).astimezone()

    @property
    def robots(self) -> tuple[str, ...]:
        """Names of the robots."""
        return tuple(self.prefixes)

    def robot(self, name: str) -> "OpenLog":
        """Return the part about the robot of a name.

        Raises:
            ConfigError: There is none.
        """
        if name not in self.prefixes:
            there = ", ".join(self.prefixes) or "none"
            raise self._wrong(f"has no robot {name!r}; there are: {there}")
        return replace(self, _robot=name)

    def between(self, begin: Moment | None = None, end: Moment | None = None) -> "OpenLog":
        """Return the part from `begin` to `end`: seconds, or as text `90s`, `14:02:10`.

        Raises:
            ConfigError: One is no time.
        """
        first, last = (
            known if each is None else time_of(each, self._info.began)
            for each, known in ((begin, self._begin), (end, self._end))
        )
        return replace(self, _begin=first, _end=last)

    def is_gap(self, time: float) -> bool:
        """Whether the file of a time [s] has gone."""
        at = self._info.began + time * NANOSECONDS
        return any(begin < at < end for begin, end in self._info.gaps)

    def topics(self) -> tuple[str, ...]:
        """Return the topics of the robot that :meth:`messages` reads."""
        own = (
            topic.removeprefix(self._prefix)
            for topic in self._topics
            if topic.startswith(self._prefix)
        )
        found = {topic for topic in own if _kind(topic) is not None}
        return tuple(sorted(found | ({EVENTS} & self._topics)))

    def messages(self, topic: str) -> Iterator[tuple[float, Any]]:
        """Yield the messages of a topic such as `decision` or `scan/laser`, each with its time [s].

        Raises:
            ConfigError: There is no such topic.
        """
        name, kind = self._known(topic)
        messages = self._index.walk(name, self._first, self._last)
        return (self._decoded(message, kind) for message in messages)

    def newest(self, topic: str) -> tuple[float, Any] | None:
        """Return the last message of a topic with its time [s]; `None` if there is none.

        Events of the other robots are none of one that is chosen.

        Raises:
            ConfigError: There is no such topic.
        """
        name, kind = self._known(topic)
        others = [
            f'"text":"{prefix}'.encode()
            for robot, prefix in self.prefixes.items()
            if name == EVENTS and self._robot not in {None, robot}
        ]
        message = self._index.newest(
            name, self._last, lambda data: not any(each in data for each in others)
        )
        return self._decoded(message, kind) if message and message.time >= self._first else None

    def since(self, topic: str, alike: Callable[[bytes], bool]) -> float | None:
        """Return when the last messages of a topic began to be alike [s], by their bytes.

        `None` where there are none, or that is too long ago to look for.
        """
        name, _ = self._known(topic)
        other = self._index.newest(name, self._last, lambda data: not alike(data), FARTHEST)
        if other is None and (self._info.counts or {}).get(name, 0) > FARTHEST:
            return None
        begin = other.time + 1 if other else self._first
        first = next(self._index.walk(name, begin, self._last), None)
        return self._seconds(first.time) if first else None

    def snapshots(self) -> Iterator[Snapshot]:
        """Yield the snapshots of the robot."""
        return (snapshot for _, snapshot in self.messages("snapshot"))

    def scans(self, laser: str = "laser") -> Iterator[Scan]:
        """Yield the scans of a laser; the second one is `laser2`."""
        return (scan for _, scan in self.messages(f"scan/{laser}"))

    def commands(self) -> Iterator[tuple[float, CommandGiven]]:
        """Yield what was asked of the robot, each with its time [s]."""
        return self.messages("command")

    def decisions(self) -> Iterator[tuple[float, DecisionMade]]:
        """Yield the decisions, each with its time [s]; one holds until the next."""
        return self.messages("decision")

    def events(self) -> Iterator[tuple[float, LogEvent]]:
        """Yield the events of all robots, each with its time [s]."""
        return self.messages(EVENTS)

    def array(self, name: str) -> Any:
        """Return readings as a structured array of NumPy, such as `odometry`, `sonar`, `scan`.

        Its fields have names, as in ``array["x"]``; the first is always `time` [s]. The reference
        has all with their units. ``pandas.DataFrame(array)`` makes a data frame of it.

        Raises:
            ConfigError: There is no such table.
        """
        from pioneer3.analysis.arrays import array_of, table_of

        table = table_of(name)
        messages = (
            (self.measured(each.stamp, time) if table.stamped else time, each)
            for time, each in self.messages(table.topic)
        )
        try:
            return array_of(table, messages)
        except ValueError as error:
            raise self._wrong(f"is damaged: {error}") from None

    def time_at(self, stamp: float) -> float:
        """Return the time in the log [s] of the `stamp` of a snapshot or scan.

        Raises:
            ConfigError: The log does not tell it.
        """
        if self._stamps_from is None:
            raise self._wrong("does not tell the clock of its program")
        return stamp - self._stamps_from

    @cached_property
    def _info(self) -> LogInfo:
        return self.source.info()

    @property
    def _topics(self) -> set[str]:
        return self._index.topics

    @cached_property
    def prefixes(self) -> dict[str, str]:
        """Beginnings of the topics of robots, by their names."""
        found = {}
        for name, texts in self._info.texts.items():
            prefix, _, last = name.rpartition("/")
            if last == "robot":
                found[prefix or texts.get("name", "") or "robot"] = f"{prefix}/" if prefix else ""
        for prefix in robots_in(self._topics):
            if prefix not in found.values():
                found[prefix.rstrip("/") or "robot"] = prefix
        return found

    @property
    def _prefix(self) -> str:
        prefixes = self.prefixes
        if self._robot is not None:
            return prefixes[self._robot]
        if len(prefixes) > 1:
            names, first = ", ".join(prefixes), next(iter(prefixes))
            raise self._wrong(f"has the robots {names}: choose one, as in .robot({first!r})")
        return next(iter(prefixes.values()), "")

    @cached_property
    def _stamps_from(self) -> float | None:
        """The stamp of the beginning of the log [s]; `None` if it is not told."""
        told = self._info.texts.get("program", {})
        with suppress(KeyError, ValueError, OverflowError):
            began = datetime.fromisoformat(told["began"]).timestamp()
            return float(told["clock"]) + self._info.began / NANOSECONDS - began
        return None

    @cached_property
    def source(self) -> RunLog:
        """All of the log, as it is read from its files."""
        return RunLog(self.path, *self.more)

    @cached_property
    def _index(self) -> LogIndex:
        return LogIndex(self.path, *self.more)

    @property
    def _first(self) -> int:
        return self._info.began if self._begin is None else self._begin

    @property
    def _last(self) -> int:
        return self._index.ended if self._end is None else self._end

    def _known(self, topic: str) -> tuple[str, type]:
        """Return the name of a topic in the file, and the class of its messages."""
        kind = _kind(topic)
        if kind is None:
            known = ", ".join(self.topics()) or "none"
            raise self._wrong(f"has no messages {topic!r}; there are: {known}")
        return (topic if topic == EVENTS else f"{self._prefix}{topic}"), kind

    def _decoded(self, message: LogMessage, kind: type) -> tuple[float, Any]:
        topic: LogTopic[Any] = LogTopic(message.topic, kind)
        return self._seconds(message.time), self.source.decoded(message, topic)

    def _seconds(self, time: int) -> float:
        return (time - self._info.began) / NANOSECONDS

    def measured(self, stamp: float, told: float) -> float:
        """Return the time of a reading [s] by its stamp; `told` is that of its message."""
        begin = self._stamps_from
        if begin is None or not abs(stamp - begin - told) < CLOCKS_APART:
            return told
        return stamp - begin

    def _wrong(self, problem: str) -> ConfigError:
        return ConfigError(f"{printable(str(self.path))} {printable(problem)}")


def open_log(name: str | Path = "") -> OpenLog:
    """Open a log to look at it: a file, or the user's newest log with such a part in its name.

    Files beside it that the log went on in are read, too.

    Raises:
        PortNotFoundError: There is no such file.
        ConfigError: It is no log, or names none.
    """
    first, *more = whole_log(named_log_path(name)).files
    return OpenLog(first, (*more,))


def _kind(topic: str) -> type | None:
    first, _, rest = topic.partition("/")
    return KINDS.get(first) if bool(rest) == (first == "scan") else None
