"""The messages of a log, as bytes and back, exactly.

Bytes stay as they are. All else is JSON, in which a number that is none is the text `inf`, `-inf`
or `nan`; its schema is that of the class.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import isfinite
from typing import Any, Final, Generic, TypeVar

import msgspec

T = TypeVar("T")

NO_NUMBERS: Final = ("inf", "-inf", "nan")
"""Texts in place of numbers that JSON lacks."""
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
    """

    name: str
    kind: type[T]
    steady: str = ""
    size: Callable[[Any], int] = _usual
    make: Callable[[Any], T] | None = None

    def encode(self, message: Any) -> bytes:
        """Return a message as bytes, without its steady field."""
        if isinstance(message, bytes):
            return message
        fields = msgspec.to_builtins(self.make(message) if self.make else message)
        fields.pop(self.steady, None)
        return msgspec.json.encode(_with_texts(fields))

    def steady_part(self, message: Any) -> bytes:
        """Return the steady field as bytes; empty where there is none."""
        if not self.steady:
            return b""
        return msgspec.json.encode(_with_texts(msgspec.to_builtins(getattr(message, self.steady))))

    def schema(self) -> bytes:
        """Return the JSON schema of the messages."""
        found = msgspec.json.schema(self.kind)
        parts = {name: _or_text(part) for name, part in found["$defs"].items()}
        own = parts.pop(found["$ref"].rpartition("/")[2])  # readers look for its type at the top
        return msgspec.json.encode(own | {"$defs": parts})


def decode(data: bytes, kind: type[T], steady: str = "", part: bytes = b"") -> T:
    """Return the message in `data`, with its steady field in `part`.

    Raises:
        msgspec.MsgspecError, UnicodeDecodeError: It is no such message.
    """
    if part:
        data = b'{"%s":%s%s%s' % (steady.encode(), part, b"," if len(data) > 2 else b"", data[1:])
    return msgspec.json.decode(data, type=kind, strict=False)


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
