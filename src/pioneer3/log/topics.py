"""The messages of a log, as bytes and back, exactly.

Bytes of a chunk are put together, with the time of each piece; snapshots and scans are columns (see
rows). All else is JSON, in which a number that is none is the text `inf`, `-inf` or `nan`; its
schema is that of the class.
"""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import isfinite
from typing import Any, Final, Generic, TypeVar

import msgspec

from pioneer3.log.differences import differences, joined_planes, planes, sums
from pioneer3.state import Scan, Snapshot

T = TypeVar("T")

SNAPSHOT: Final = "snapshot"
"""Last part of the topic of snapshots; the name of one of several robots comes before it."""
PROGRAM: Final = "program"
"""Name of the description of the program, which is the same in all files of a log."""
END: Final = "end"
"""Name of the description of the end."""
GOES_ON: Final = "goes on in the next file"
"""Why a file ended that is not the last one of its log."""
COLUMNS: Final = "columns"
"""Key in the metadata of a channel whose messages are columns: the shape of a row."""
EXCERPT: Final = "an excerpt"
"""Why a file ended that is a part of a log, with messages that are in that, too."""
TOTALS: Final = "totals"
"""Name of the description of the messages of a file: how many of each topic, and the last time."""
STEADY: Final = "steady"
"""Key in a channel's metadata: the name of the field that is kept there, beside the field."""
PIECES: Final = "pieces"
"""Key in the metadata of a channel whose messages are bytes in pieces."""
NO_NUMBERS: Final = ("inf", "-inf", "nan")
"""Texts in place of numbers that JSON lacks."""
WIRE: Final = re.compile(r"wire/.*/(in|out)", re.DOTALL)
"""Topics of bytes."""
SCAN: Final = re.compile(r"(.*/)?scan/laser\d*", re.DOTALL)
"""Topics of scans; a robot may be called `scan`, another one `wire`."""
AS_THEY_ARE: Final = {int, str, bool, type(None)}
"""Types whose values JSON has, all of them."""
MICRO: Final = 1000
"""Microsecond [ns], in which older logs tell the times of pieces."""
EXACT: Final = 1
"""Tick in which they are told usually [ns]: a driver whose bytes are played again needs it."""
ROUGH: Final = 100_000
"""Times of pieces are told in so many ns where nobody needs them exactly."""
ROWS: Final = (Snapshot, Scan)
"""Messages that are always written as columns."""
LASER_BYTES: Final = 2048
"""Bytes of a link in one message that are worth a look how they take less room: a laser's."""
USUAL_SIZE: Final = 4000
"""Memory that a message takes [bytes], about, where its topic does not tell it."""


def _always(message: Any, now: float) -> bool:
    return True


@dataclass(frozen=True, slots=True)
class LogTopic(Generic[T]):
    """The messages of one kind.

    Attributes:
        kind: Their class; `bytes` for bytes.
        steady: The field that is the same in nearly all messages: it is kept with the channel.
        size: Memory that a message takes [bytes], about; of bytes, besides these.
        make: Makes the message of what was put, in the thread that writes.
        is_news: Whether a message of some time [s] is written, asked in that thread.
        tick: Unit of the times of pieces [ns].
        repeated: Whether its newest message is in each further file of the log, too.
        rows: Whether its messages are written as columns, as snapshots and scans are.
    """

    name: str
    kind: type[T]
    steady: str = ""
    size: int = USUAL_SIZE
    make: Callable[[Any], T] | None = None
    is_news: Callable[[Any, float], bool] = _always
    repeated: bool = False
    tick: int = EXACT
    rows: bool = False

    @property
    def in_rows(self) -> bool:
        """Whether its messages are written as columns."""
        return self.rows or self.kind in ROWS

    def memory(self, message: Any) -> int:
        """Return the memory that a message takes [bytes], about."""
        return self.size + len(message) if self.kind is bytes else self.size

    def encode(self, message: Any) -> bytes:
        """Return a message as JSON."""
        made = self.make(message) if self.make else message
        data = msgspec.json.encode(made)
        if b"null" in data:  # perhaps in place of a number
            data = msgspec.json.encode(with_texts(msgspec.to_builtins(made)))
        return data

    def steady_part(self, message: Any) -> bytes:
        """Return the steady field as bytes; empty where there is none."""
        if not self.steady:
            return b""
        return msgspec.json.encode(with_texts(msgspec.to_builtins(getattr(message, self.steady))))

    @property
    def encoding(self) -> str:
        """The encoding of the messages, as MCAP names it."""
        return "msgpack" if self.kind is bytes or self.in_rows else "json"

    def schema(self) -> bytes:
        """Return the schema of messages in JSON."""
        found = msgspec.json.schema(self.kind)
        parts = {name: _or_text(part) for name, part in found["$defs"].items()}
        own = parts.pop(found["$ref"].rpartition("/")[2])  # readers look for its type at the top
        return msgspec.json.encode(own | {"$defs": parts})


def decode(data: bytes, kind: type[T], steady: str = "", part: bytes = b"") -> T:
    """Return the message in `data`, with its steady field in `part`.

    Raises:
        msgspec.MsgspecError, ValueError, KeyError, TypeError: It is no such message.
    """
    if kind is Scan:
        from pioneer3.log.scans import unpack_scan

        angles = msgspec.json.decode(part, type=tuple[float, ...], strict=False)
        return unpack_scan(data, angles)  # type: ignore[return-value]
    if part:
        data = b'{"%s":%s%s%s' % (steady.encode(), part, b"," if len(data) > 2 else b"", data[1:])
    return msgspec.json.decode(data, type=kind, strict=False)


class Pieces(msgspec.Struct, array_like=True, omit_defaults=True):
    """Bytes that came in pieces: the times between them [ticks], their sizes, and all joined.

    With a `step` the bytes are :func:`~pioneer3.log.differences.differences`, as planes if these
    are of that size; a tick is of `tick` [ns]. Older logs have none of them.
    """

    times: list[int]
    sizes: list[int]
    joined: bytes
    step: int = 0
    tick: int = MICRO
    planes: int = 0


def pack_pieces(
    pieces: Sequence[tuple[int, bytes]], tick: int, step_of: Callable[[bytes], int]
) -> bytes:
    """Return bytes that came in pieces, each at a time [ns], as one message of the first time.

    Links are read in small pieces: a message for each would take more room than they do. `step_of`
    returns the step for many bytes, 0 for none.
    """
    begin = pieces[0][0]
    times, parts = zip(*pieces, strict=True)
    ticks = [(time - begin) // tick for time in times]
    steps = [after - before for before, after in pairwise([0, *ticks])]
    joined, step = b"".join(parts), 0
    if len(joined) >= LASER_BYTES:
        step = step_of(joined)
        joined = planes(differences(joined, step), step) if step else joined
    return msgspec.msgpack.encode(Pieces(steps, [*map(len, parts)], joined, step, tick, step))


def unpack_pieces(time: int, data: bytes) -> Iterator[tuple[int, bytes]]:
    """Yield the pieces of a message of some time [ns], each with its own.

    Raises:
        msgspec.MsgspecError, ValueError: It is no such message.
    """
    told = msgspec.msgpack.decode(data, type=Pieces)
    sizes, joined = told.sizes, told.joined
    if len(told.times) != len(sizes) or sum(sizes) != len(joined) or min(sizes, default=0) < 0:
        raise ValueError("the sizes of pieces do not fit")
    if told.step:
        joined = joined_planes(joined, told.planes) if told.planes else joined
        joined = sums(joined, told.step)
    at = 0
    for step, size in zip(told.times, sizes, strict=True):
        time += step * told.tick
        yield time, joined[at : at + size]
        at += size


def is_wire(topic: str) -> bool:
    """Whether a topic has the bytes of a link."""
    return WIRE.fullmatch(topic) is not None


def is_scan(topic: str) -> bool:
    """Whether a topic has the scans of a laser."""
    return SCAN.fullmatch(topic) is not None


def totals(counts: Mapping[str, int], ended: int) -> dict[str, str]:
    """Return the description of the messages of a file, the last of them of a time [ns]."""
    return {"messages": msgspec.json.encode(counts).decode(), "ended_ns": str(ended)}


def robots_in(topics: Iterable[str]) -> list[str]:
    """Return the prefix of each robot's topics, by those of their snapshots."""
    return sorted(
        topic.removesuffix(SNAPSHOT) for topic in topics if topic.rpartition("/")[2] == SNAPSHOT
    )


def with_texts(value: Any) -> Any:
    """Return a value with texts in place of numbers that JSON lacks."""
    if type(value) in AS_THEY_ARE:
        return value
    if isinstance(value, dict):
        return {key: with_texts(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        if {*map(type, value)} == {float} and isfinite(sum(value)):
            return value
        return [with_texts(each) for each in value]
    return str(value) if isinstance(value, float) and not isfinite(value) else value


def _or_text(part: Any) -> Any:
    """Return a part of a schema that lets texts stand for numbers, and takes less room."""
    if isinstance(part, list):
        return [_or_text(each) for each in part]
    if not isinstance(part, dict):
        return part
    if part.get("type") == "number":
        return {"anyOf": [{"type": "number"}, {"enum": [*NO_NUMBERS]}]}
    kept = {key: _or_text(each) for key, each in part.items() if key != "description"}
    return kept | ({"description": part["description"]} if "description" in part else {})


@dataclass(frozen=True, slots=True)
class LogEvent:
    """A change that is told in words; the kind is one word, such as `clock`."""

    kind: str
    text: str


EVENT: Final = LogTopic("event", LogEvent)
"""Events of the log itself, and of the program."""
