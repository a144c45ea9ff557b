"""Declarative layouts: the annotations of a message class describe its bytes.

The fields are annotated with the kinds of :mod:`pioneer3.arcos.wire`, in wire order::

    class Encoders(Report, frozen=True):
        ID: ClassVar[int] = 0x90
        left_counts: S32
        right_counts: S32
        extra: Rest = b""

A record of :class:`~pioneer3.arcos.lists.CountedStructs` is a `NamedTuple`, which is made faster.

Fields with a default may be missing at the end of a packet: reading stops there and leaves the
defaults, writing stops at the first `None`. `Rest` takes all bytes that are left.
"""

from functools import cache
from typing import Any, ClassVar, TypeVar, get_args, get_type_hints

from msgspec import Struct
from msgspec.structs import fields

from pioneer3.arcos.wire import AllThatIsLeft, Reader, WireKind
from pioneer3.errors import CommandError

T = TypeVar("T")


class Command(Struct, frozen=True):
    """A message from a host to a robot."""

    ID: ClassVar[int]


class Report(Struct, frozen=True):
    """A message from a robot to its host."""

    ID: ClassVar[int]


class Slot(Struct, frozen=True):
    """One field of a layout."""

    name: str
    kind: WireKind
    optional: bool
    """Whether a packet may end before this field."""

    @property
    def is_rest(self) -> bool:
        """Whether this field takes the remaining bytes, wherever reading stopped."""
        return isinstance(self.kind, AllThatIsLeft)


def layout(cls: type) -> tuple[Slot, ...]:
    """Return the fields of message class `cls` in wire order."""
    return _compiled(cls)


@cache
def _compiled(cls: type) -> tuple[Slot, ...]:
    hints = get_type_hints(cls, include_extras=True)
    slots: list[Slot] = []
    optional = True
    for name, has_default in reversed(_fields(cls)):
        optional = optional and has_default
        slots.append(Slot(name, _kind(hints[name]), optional))
    return tuple(reversed(slots))


def _fields(cls: Any) -> list[tuple[str, bool]]:
    """Return the names of the fields of a `Struct` or `NamedTuple`, and which have a default."""
    if issubclass(cls, Struct):
        return [(each.name, not each.required) for each in fields(cls)]
    return [(name, name in cls._field_defaults) for name in cls._fields]


def _kind(hint: object) -> WireKind:
    """Return the kind inside `Annotated[X, kind]` or `Annotated[X, kind] | None`."""
    annotated = next(part for part in (hint, *get_args(hint)) if hasattr(part, "__metadata__"))
    kind: WireKind = annotated.__metadata__[0]
    return kind


def pack(message: object) -> bytes:
    """Return the fields of `message` as bytes; CommandError for a value that does not fit."""
    out = bytearray()
    write_fields(message, out)
    return bytes(out)


def unpack(cls: type[T], body: bytes) -> T:
    """Return the `cls` in `body`; EOFError or ValueError when there is none."""
    return read_fields(cls, Reader(body))


def write_fields(message: object, out: bytearray) -> None:
    """Append the fields of `message`; CommandError names the one that does not fit."""
    missing = ""
    for slot in layout(type(message)):
        value = getattr(message, slot.name)
        if value is None and slot.optional:
            missing = missing or slot.name
            continue
        where = f"{type(message).__name__}.{slot.name}"
        if missing and not slot.is_rest:
            raise CommandError(f"{where}: {value!r} cannot follow {missing}, which is missing")
        try:
            slot.kind.write(value, out)
        except CommandError as error:
            raise CommandError(f"{where}: {error}") from None


def read_fields(cls: type[T], reader: Reader) -> T:
    """Take the fields of `cls` from `reader`."""
    values: dict[str, object] = {}
    ended = False
    for slot in layout(cls):
        if ended and not slot.is_rest:
            continue
        start = reader.at
        try:
            values[slot.name] = slot.kind.read(reader)
        except EOFError:
            if not slot.optional:
                raise
            reader.at, ended = start, True
    return cls(**values)
