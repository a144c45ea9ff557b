"""The messages of a log, as bytes and back, exactly.

Bytes of a chunk are put together, with the time of each piece; scans are msgpack. All else is JSON,
in which a number that is none is the text `inf`, `-inf` or `nan`; its schema is that of the class.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import isfinite
from typing import Any, Final, Generic, TypeVar

import msgspec

from pioneer3.state import Scan

T = TypeVar("T")

NO_NUMBERS: Final = ("inf", "-inf", "nan")
"""Texts in place of numbers that JSON lacks."""
MICRO: Final = 1000
"""Microsecond [ns], in which the times of pieces are told."""
USUAL_SIZE: Final = 4000
"""Memory that a message takes [bytes], about, where its topic does not tell it."""


def _usual(_: Any) -> int:
    return USUAL_SIZE


@dataclass(frozen=True, slots=True)
class LogTopic(Generic[T]):
    """The messages of one kind.

    Attributes:
        kind: Their class; `bytes` for bytes.
        steady: The field that is the same in nearly all messages: it is kept with the channel.
        size: Returns the memory that a message takes [bytes], about.
        make: Makes the message of what was put, in the thread that writes.
        repeated: Whether its newest message is in each further file of the log, too.
    """

    name: str
    kind: type[T]
    steady: str = ""
    size: Callable[[Any], int] = _usual
    make: Callable[[Any], T] | None = None
    repeated: bool = False

    def encode(self, message: Any) -> bytes:
        """Return a message as bytes, without its steady field."""
        if self.kind is Scan:
            from pioneer3.log.scans import pack_scan  # numpy loads slowly

            return pack_scan(message)
        fields = msgspec.to_builtins(self.make(message) if self.make else message)
        fields.pop(self.steady, None)
        return msgspec.json.encode(_with_texts(fields))

    def steady_part(self, message: Any) -> bytes:
        """Return the steady field as bytes; empty where there is none."""
        if not self.steady:
            return b""
        return msgspec.json.encode(_with_texts(msgspec.to_builtins(getattr(message, self.steady))))

    @property
    def encoding(self) -> str:
        """The encoding of the messages, as MCAP names it."""
        return "msgpack" if self.kind in {bytes, Scan} else "json"

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


def pack_pieces(pieces: Sequence[tuple[int, bytes]]) -> bytes:
    """Return bytes that came in pieces, each at a time [ns], as one message of the first time.

    Links are read in small pieces: a message for each would take more room than they do.
    """
    times = [time // MICRO for time, _ in pieces]
    steps = [after - before for before, after in pairwise([times[0], *times])]
    sizes = [len(data) for _, data in pieces]
    return msgspec.msgpack.encode((steps, sizes, b"".join(data for _, data in pieces)))


def unpack_pieces(time: int, data: bytes) -> Iterator[tuple[int, bytes]]:
    """Yield the pieces of a message of some time [ns], each with its own.

    Raises:
        msgspec.MsgspecError, ValueError: It is no such message.
    """
    steps, sizes, joined = msgspec.msgpack.decode(data, type=tuple[list[int], list[int], bytes])
    if len(steps) != len(sizes) or sum(sizes) != len(joined) or min(sizes, default=0) < 0:
        raise ValueError("the sizes of pieces do not fit")
    at = 0
    for step, size in zip(steps, sizes, strict=True):
        time += step * MICRO
        yield time, joined[at : at + size]
        at += size


def _with_texts(value: Any) -> Any:
    """Return a value with texts in place of numbers that JSON lacks."""
    if isinstance(value, dict):
        return {key: _with_texts(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        if value and type(value[0]) is float and isfinite(sum(value)):
            return value
        return [_with_texts(each) for each in value]
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
