"""Finds the messages of a log at any time, by the index of its chunks.

The index lies at the end of a file; one without its end is read through once, the heads of its
records only. Chunks that were read last are kept.
"""

from bisect import bisect_left, bisect_right
from collections import OrderedDict
from collections.abc import Callable, Iterator, Set
from functools import cached_property
from operator import attrgetter
from pathlib import Path
from threading import Lock
from typing import Final

from pioneer3.errors import ConfigError
from pioneer3.log.chunks import LogRecord
from pioneer3.log.reader import LogInfo, LogMessage, RunLog, messages_of
from pioneer3.log.topics import is_wire

MOST_KEPT: Final = 64
"""Chunks that are kept after they were read: ours have a second of one robot, at most 1 MiB."""
LATER: Final = 10**9
"""Rows and bytes of a message may be later than the chunk and the message say [ns]: a second."""
FARTHEST: Final = 2000
"""Messages of one topic that are looked at for one that is wanted."""


class LogIndex:
    """A log whose messages are found by their times, in all its files. Several threads may use it.

    Raises:
        PortNotFoundError: There is no such file.
        ConfigError: It is no log, is damaged, or has no messages; so do all methods.

    Attributes:
        topics: That have messages, but those of bytes.
    """

    def __init__(self, path: Path, *more: Path) -> None:
        self._log = RunLog(path, *more)
        self.damage_told = self._log.damage_told
        self._kept: OrderedDict[int, list[LogMessage]] = OrderedDict()
        self._lock = Lock()
        self._chunks = sorted(self._log.chunks(), key=attrgetter("begin"))
        if not self._chunks:
            raise ConfigError(f"{path}: no messages were logged")
        self._begins = [chunk.begin for chunk in self._chunks]
        self._latest_ends: list[int] = []
        self._places: dict[str, list[int]] = {}
        latest = 0
        later = [*self._begins[1:], self._chunks[-1].end]
        for number, (chunk, next_begin) in enumerate(zip(self._chunks, later, strict=True)):
            latest = max(latest, chunk.end, next_begin)
            self._latest_ends.append(latest + LATER)
            for topic in chunk.topics:
                self._places.setdefault(topic, []).append(number)
        self.topics = {topic for topic in self._places if not is_wire(topic)}

    @property
    def path(self) -> Path:
        """The file."""
        return self._log.path

    @property
    def began(self) -> int:
        """Time of the first message [ns since 1970]."""
        return self._begins[0]

    @cached_property
    def ended(self) -> int:
        """Time of the last message [ns since 1970]."""
        last = self._messages(len(self._chunks) - 1)
        return max([each.end for each in self._chunks] + [each.time for each in last[-1:]])

    def info(self) -> LogInfo:
        """Return the facts of the log."""
        return self._log.info()

    def first(self, topic: str) -> int:
        """Return when the first message of a topic was taken [ns since 1970]."""
        return min(message.time for message in self._messages(self._places[topic][0], topic))

    def newest(
        self,
        topic: str,
        time: int,
        wanted: Callable[[bytes], bool] = lambda data: True,
        farthest: int = FARTHEST,
    ) -> LogMessage | None:
        """Return the newest message of a topic at a time [ns since 1970], `None` before the first.

        Not all messages may be wanted, by their bytes; of those that are farther back than a bound
        none is found.
        """
        places, found, seen = self._places.get(topic, []), None, 0
        for at in range(bisect_right(places, self._last_begun(time)) - 1, -1, -1):
            chunk = self._chunks[places[at]]
            if found is not None and self._latest_ends[places[at]] <= found.time:
                break
            for message in reversed(self._messages(places[at], topic)):
                if message.time > time or (found is not None and message.time <= found.time):
                    continue
                seen += 1
                if wanted(message.data):
                    found = message
                    break
            if seen > farthest and chunk.begin < time:
                break
        return found

    def between(self, begin: int, end: int, topics: set[str]) -> list[LogMessage]:
        """Return the messages of topics after `begin` until `end` [ns since 1970], by time."""
        first = bisect_right(self._latest_ends, begin)
        found = [
            message
            for number in range(first, self._last_begun(end) + 1)
            for message in self._messages(number)
            if begin < message.time <= end and message.topic in topics
        ]
        found.sort(key=attrgetter("time"))
        return found

    def walk(self, topic: str, begin: int, end: int) -> Iterator[LogMessage]:
        """Yield the messages of a topic from `begin` to `end` [ns since 1970]; keep nothing."""
        for number in self._places.get(topic, ()):
            if self._latest_ends[number] >= begin and self._chunks[number].begin <= end:
                yield from (m for m in self._read(number, {topic}) if begin <= m.time <= end)

    def records(self, begin: int, end: int) -> Iterator[LogRecord]:
        """Yield the messages from `begin` to `end` [ns since 1970] as they lie in the file.

        Rows and bytes are there by the second.
        """
        first = bisect_left(self._latest_ends, begin)
        for number in range(first, self._last_begun(end) + 1):
            for each in self._records(number):
                if begin <= each.time <= end or self._lasts_until(each, begin):
                    yield each

    def _lasts_until(self, record: LogRecord, begin: int) -> bool:
        """Whether rows or bytes that began before a time [ns] go on then."""
        if not begin - LATER < record.time < begin:
            return False
        with self._log.damage_told():
            return any(message.time >= begin for message in messages_of([record]))

    def chunks(self, topics: set[str]) -> Iterator[tuple[float, list[LogMessage]]]:
        """Yield the messages of topics chunk by chunk, with the share of all that was read, 0 to 1.

        Nothing is kept of them.
        """
        for number in range(len(self._chunks)):
            yield (number + 1) / len(self._chunks), self._read(number, topics)

    def _last_begun(self, time: int) -> int:
        """Return the number of the last chunk that begins until a time; -1 for none."""
        return bisect_right(self._begins, time) - 1

    def _messages(self, number: int, topic: str | None = None) -> list[LogMessage]:
        with self._lock:
            messages = self._kept.pop(number, None)
        if messages is None:
            messages = self._read(number)
        with self._lock:
            self._kept[number] = messages
            if len(self._kept) > MOST_KEPT:
                self._kept.popitem(last=False)
        return messages if topic is None else [each for each in messages if each.topic == topic]

    def _read(self, number: int, topics: Set[str] | None = None) -> list[LogMessage]:
        """Read the messages of topics in a chunk, by their times; of all but those of bytes."""
        wanted = self.topics if topics is None else topics
        with self._log.damage_told():
            return messages_of(self._records(number, wanted.__contains__))

    def _records(
        self, number: int, wanted: Callable[[str], bool] = lambda topic: True
    ) -> list[LogRecord]:
        """Read messages of a chunk as they lie there."""
        chunk = self._chunks[number]
        with self._log.damage_told(chunk.file.path):
            return chunk.records(wanted)
