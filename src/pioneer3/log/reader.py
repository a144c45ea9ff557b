"""Reads a log, with or without its end."""

from bisect import bisect_left
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from itertools import pairwise
from operator import attrgetter
from pathlib import Path
from typing import BinaryIO, Final, TypeVar

import msgspec

from pioneer3.errors import ConfigError, PortNotFoundError
from pioneer3.log.chunks import (
    CHANNEL,
    DAMAGED,
    METADATA,
    METADATA_INDEX,
    MOST_RECORD,
    MOST_UNPACKED,
    OF_MESSAGE,
    STATISTICS,
    TIMES,
    LogChunk,
    LogFile,
    LogRecord,
    split,
    stream,
    summary_groups,
)
from pioneer3.log.cut import CHUNK, MAGIC, data_records
from pioneer3.log.folder import SUFFIX, is_being_written, is_pinned
from pioneer3.log.rows import unpack_rows
from pioneer3.log.topics import (
    COLUMNS,
    END,
    EXCERPT,
    GOES_ON,
    PIECES,
    PROGRAM,
    STEADY,
    TOTALS,
    LogTopic,
    decode,
    unpack_pieces,
)
from pioneer3.state import Snapshot
from pioneer3.text import one_line, wrong

T = TypeVar("T")

MOST_DECODED: Final = 1024 * 1024
"""A longer message is not decoded [bytes]; ours have some kB."""
MOST_OF_MAP: Final = 4 * 1024 * 1024
"""A longer map is not decoded [bytes]; ARIA's largest has 0.7 MB."""
MAP: Final = "map"
"""Last part of the topic of maps."""
OF_EACH: Final = 256
"""Memory that a message takes besides its bytes [bytes], about."""
FIRST_MESSAGE: Final = 1_000_000_000
"""The first message of a log is taken so soon after it began [ns]; of its later files, not."""
MOST_APART: Final = 2_000_000_000
"""A file of a log goes on so soon after the one before [ns]: else one between them has gone."""
MOST_BESIDE: Final = 2048
"""Files of a folder before one, and behind it, that are looked at for the rest of its log."""


@dataclass(frozen=True, slots=True)
class LogMessage:
    """A message of a log: when it was taken [ns since 1970], its topic, its bytes."""

    time: int
    topic: str
    data: bytes
    steady: tuple[str, bytes] = ("", b"")

    def decode(self, kind: type[T]) -> T:
        """Return the message as an object of its class.

        Raises:
            msgspec.MsgspecError, UnicodeDecodeError: It is none.
        """
        return decode(self.data, kind, *self.steady)


@dataclass(frozen=True, slots=True, kw_only=True)
class LogInfo:
    """Facts of a log, without its messages.

    Attributes:
        files: In their order; most logs have one.
        began: When its first message was taken, and `ended` its last one [ns since 1970]; without
            messages, when the file was written last.
        size: [bytes].
        counts: Messages by topic; `None` where the end is missing, which has them.
        texts: Descriptions by their names, such as `program` and `robot`.
        gaps: Times of files that have gone: the end of the one before each, and the begin of the
            one after it [ns since 1970].
    """

    files: tuple[Path, ...]
    began: int
    ended: int
    size: int
    counts: Mapping[str, int] | None
    texts: Mapping[str, Mapping[str, str]]
    pinned: bool = False
    being_written: bool = False
    gaps: tuple[tuple[int, int], ...] = ()

    @property
    def path(self) -> Path:
        """The first file."""
        return self.files[0]

    @property
    def seconds(self) -> float:
        """Time from the first message to the last one [s]."""
        return max(0, self.ended - self.began) / 1e9

    @property
    def command(self) -> str:
        """The command that was started."""
        return self.texts.get(PROGRAM, {}).get("command", "")

    @property
    def robot(self) -> str:
        """The robot, or the names of several in this log; empty where none was connected."""
        return ", ".join(
            name.rpartition("/")[0] or texts.get("name", "")
            for name, texts in self.texts.items()
            if name.rpartition("/")[2] == "robot"
        )

    @property
    def end(self) -> str:
        """Why it ended, in words."""
        if self.being_written:
            return "goes on"
        killed = "cut off: killed, or without power"
        return self.texts.get(END, {}).get("why", killed)


@dataclass(slots=True)
class _Index:
    """Facts that a file tells of itself."""

    channels: dict[int, str] = field(default_factory=dict)
    counts: dict[int, int] | None = None
    texts: dict[str, dict[str, str]] = field(default_factory=dict)
    began: int = 0
    ended: int = 0


class RunLog:
    """A log of a run, to be read: one file, or all that it went on in, in their order.

    Raises:
        PortNotFoundError: There is no such file.
        ConfigError: It is no log, or damaged; so do all methods.
    """

    def __init__(self, path: Path, *more: Path) -> None:
        self.path, self.files = path, (path, *more)
        self._now: list[LogChunk] | None = None
        for file in self.files:
            if not is_mcap(file):
                raise wrong(file, " is no log: expected is an MCAP file")

    def info(self) -> LogInfo:
        """Return the facts of the log, by its index if it has one."""
        infos = [self._info_of(path) for path in self.files]
        counts: Counter[str] | None = Counter()
        texts: dict[str, Mapping[str, str]] = {}
        for each in infos:
            counts = (
                None if counts is None or each.counts is None else counts + Counter(each.counts)
            )
            texts.pop(END, None)
            texts |= each.texts
        return LogInfo(
            files=self.files,
            began=min(each.began for each in infos),
            ended=max(each.ended for each in infos),
            size=sum(each.size for each in infos),
            counts=counts,
            texts=texts,
            pinned=all(each.pinned for each in infos),
            being_written=infos[-1].being_written,
            gaps=tuple(
                (before.ended, after.began)
                for before, after in pairwise(each for each in infos if each.seconds)
                if after.began - before.ended > MOST_APART
            ),
        )

    def _info_of(self, path: Path) -> LogInfo:
        """Return the facts of one of its files."""
        with self._opened(path) as file:
            size = file.seek(0, 2)
            index = _read_index(file, size) or _index_of_all(file)
            counts: dict[str, int] = {}
            for channel, number in (index.counts or {}).items():
                topic = index.channels[channel]
                counts[topic] = counts.get(topic, 0) + number
            if totals := index.texts.pop(TOTALS, None):
                counts |= msgspec.json.decode(totals["messages"], type=dict[str, int])
                index.ended = max(index.ended, int(totals["ended_ns"][:20]))
        if not index.ended:  # it has no messages
            index.began = index.ended = path.stat().st_mtime_ns
        return LogInfo(
            files=(path,),
            began=index.began,
            ended=index.ended,
            size=size,
            counts=None if index.counts is None else counts,
            texts=index.texts,
            pinned=is_pinned(path),
            being_written=is_being_written(path),
        )

    def topics(self) -> set[str]:
        """Return the topics that have messages; a file without its end is read for that."""
        counts = self.info().counts
        if counts is not None:
            return {*counts}
        with self.damage_told():
            return {topic for chunk in self.chunks() for topic in chunk.topics}

    def messages(self, wanted: Callable[[str], bool] = lambda topic: True) -> Iterator[LogMessage]:
        """Yield the messages of the topics that are wanted, in the order of their times.

        A chunk is sorted: its topics lie one behind the other.
        """
        with self.damage_told():
            for chunk in self.chunks():
                yield from messages_of(chunk.records(wanted))

    def as_of_now(self) -> "RunLog":
        """Return the log with the messages that it has now: it may be written meanwhile."""
        log = RunLog(*self.files)
        log._now = list(self.chunks())
        return log

    def chunks(self) -> Iterator[LogChunk]:
        """Yield the chunks of its files, as they lie there."""
        if self._now is not None:
            yield from self._now
            return
        for path in self.files:
            with self.damage_told(path):
                yield from LogFile(path).chunks()

    def of(self, topic: LogTopic[T]) -> Iterator[tuple[int, T]]:
        """Yield the messages of a topic, each with its time [ns since 1970]."""
        for message in self.messages(lambda name: name == topic.name):
            yield message.time, self.decoded(message, topic)

    def decoded(self, message: LogMessage, topic: LogTopic[T]) -> T:
        """Return the content of a message of a topic."""
        with self.damage_told():
            size = len(message.data) + len(message.steady[1])
            most = MOST_OF_MAP if topic.name.rpartition("/")[2] == MAP else MOST_DECODED
            if size > most:
                raise ValueError(f"a message of {topic.name} has {size} bytes")
            return message.decode(topic.kind)

    def snapshots(self, name: str = "snapshot") -> Iterator[Snapshot]:
        """Yield the snapshots of a robot, by the name of their topic."""
        return (snapshot for _, snapshot in self.of(LogTopic(name, Snapshot)))

    @contextmanager
    def _opened(self, path: Path) -> Iterator[BinaryIO]:
        with self.damage_told(path), path.open("rb") as file:
            yield file

    @contextmanager
    def damage_told(self, path: Path | None = None) -> Iterator[None]:
        """Turn errors of readers during the block into errors about a file, else the first one."""
        path = path or self.path
        from mcap.exceptions import McapError
        from zstandard import ZstdError

        try:
            yield
        except ConfigError:
            raise
        except OSError as error:
            raise wrong(path, f" cannot be read: {error.strerror or error}") from None
        except (*DAMAGED, McapError, ZstdError) as error:
            raise wrong(path, f" is damaged: {one_line(error)}") from None


def open_log(path: str | Path) -> RunLog:
    """Open one file of a log to read it; errors as of :class:`RunLog`."""
    return RunLog(Path(path))


def whole_log(path: Path) -> RunLog:
    """Open a log with all files beside it that it went on in, or that it is the rest of.

    Each begins with the description of the same program, after the end of the one before: an
    excerpt and a copy are none of them. Errors as of :class:`RunLog`.
    """
    log = RunLog(path)
    known = log.info()
    program = known.texts.get(PROGRAM, {})
    began = program.get("began_ns", "")
    why = known.texts.get(END, {}).get("why")
    if why == EXCERPT or not began.isdecimal():
        return log
    goes_on = why == GOES_ON or known.began - int(began[:20]) > FIRST_MESSAGE
    if not goes_on:
        return log
    parts = [known]
    beside = sorted(path.parent.glob(f"*{SUFFIX}"))  # the names of a folder are times
    at = bisect_left(beside, path)
    for other in beside[max(0, at - MOST_BESIDE) : at + MOST_BESIDE]:
        with suppress(ConfigError, PortNotFoundError, OSError):
            if not other.samefile(path) and other.is_file():
                info = RunLog(other).info()
                same = info.texts.get(PROGRAM) == program and info.end != EXCERPT
                parts += [info] if same else []
    whole: list[LogInfo] = []
    for each in sorted(parts, key=attrgetter("began")):
        if not whole or each.began > whole[-1].ended - FIRST_MESSAGE:
            whole.append(each)
    return RunLog(*(each.path for each in whole))


def whole_logs(
    paths: Iterable[Path], tell: Callable[[ConfigError], None] = lambda error: None
) -> Iterator[LogInfo]:
    """Yield the facts of the logs in files, each log once; a file that cannot be read is told."""
    known = set[Path]()
    for path in paths:
        if path in known:
            continue
        try:
            info = whole_log(path).info()
        except ConfigError as error:
            tell(error)
        except (PortNotFoundError, OSError):  # it has gone just now
            continue
        else:
            known |= {*info.files}
            yield info


def is_mcap(path: Path) -> bool:
    """Whether a file is of this format.

    Raises:
        PortNotFoundError: There is no such file.
        ConfigError: It cannot be read.
    """
    try:
        with path.open("rb") as file:
            return file.read(len(MAGIC)) == MAGIC
    except FileNotFoundError:
        raise PortNotFoundError(f"{path}: no such recording") from None
    except OSError as error:
        raise ConfigError(f"{path}: not a readable recording: {error.strerror}") from None


def _read_index(file: BinaryIO, size: int) -> _Index | None:
    """Return the index at the end of a file; `None` if it has none.

    Of its groups only those are read that are short also where the log is long.
    """
    from mcap.records import Channel, MetadataIndex, Statistics

    index = _Index()
    groups = list(summary_groups(file, size, {CHANNEL, STATISTICS, METADATA_INDEX}))
    for kind, data in (record for _, group in groups for record in split(group)):
        if kind == CHANNEL:
            channel = Channel.read(stream(data))
            index.channels[channel.id] = channel.topic
        elif kind == STATISTICS:
            told = Statistics.read(stream(data))
            index.counts = told.channel_message_counts
            index.began, index.ended = told.message_start_time, told.message_end_time
        elif kind == METADATA_INDEX:
            place = MetadataIndex.read(stream(data))
            if place.offset + place.length > size or place.length > MOST_RECORD:
                raise ValueError("its index is wrong")
            file.seek(place.offset)
            for _, text in split(file.read(place.length)):
                _take_texts(index, text)
    if not groups:
        return None
    return index


def _index_of_all(file: BinaryIO) -> _Index:
    """Return the facts of a file without its end, read from the heads of its records."""
    index = _Index()
    for kind, at, length, head in data_records(file):
        if kind == CHUNK and length >= TIMES.size:
            began, ended = TIMES.unpack(head)
            index.began = min(index.began or began, began)
            index.ended = max(index.ended, ended)
        elif kind == METADATA and length <= MOST_RECORD:
            file.seek(at)
            _take_texts(index, file.read(length))
    return index


def messages_of(records: Iterable[LogRecord]) -> list[LogMessage]:
    """Return the messages in records, by their times.

    Raises:
        ValueError: They are damaged, or take too much room.
    """
    found, room = list[LogMessage](), MOST_UNPACKED
    for record in records:
        for message in _messages_of(record):
            room -= len(message.data) + OF_EACH
            if room < 0:
                raise ValueError(f"messages of more than {MOST_UNPACKED} bytes in one chunk")
            found.append(message)
    found.sort(key=attrgetter("time"))
    return found


def _messages_of(record: LogRecord) -> Iterator[LogMessage]:
    """Yield a message, the pieces of bytes in it, or the rows."""
    data, topic = record.data[OF_MESSAGE:], record.channel.topic
    told = record.channel.metadata
    steady = told.get(STEADY, "")
    part = steady, told.get(steady, "").encode()
    if PIECES in told:
        for at, piece in unpack_pieces(record.time, data):
            yield LogMessage(at, topic, piece)
    elif COLUMNS in told:
        for at, row in unpack_rows(record.time, data, told[COLUMNS].encode()):
            yield LogMessage(at, topic, row, part)
    else:
        yield LogMessage(record.time, topic, data, part)


def _take_texts(index: _Index, data: bytes) -> None:
    from mcap.records import Metadata

    texts = Metadata.read(stream(data))
    index.texts[texts.name] = texts.metadata
