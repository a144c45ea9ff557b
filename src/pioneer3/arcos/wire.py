"""Kinds of single values on the wire, with which the fields of messages are annotated.

Reading raises EOFError or ValueError, and the caller decides what to do. Writing raises
CommandError, which names the value and the range. All numbers are little-endian (protocol.md 1.2).
"""

from collections.abc import Callable
from enum import IntEnum, IntFlag
from math import isfinite
from typing import Annotated, Protocol

from msgspec import Struct

from pioneer3.errors import CommandError


class Reader:
    """A position in the body of one packet."""

    __slots__ = ("at", "data")

    def __init__(self, data: bytes) -> None:
        self.data = data
        self.at = 0

    def take(self, count: int) -> bytes:
        """Return the next `count` bytes; EOFError when the packet ends before."""
        end = self.at + count
        if end > len(self.data):
            raise EOFError
        taken, self.at = self.data[self.at : end], end
        return taken

    def take_rest(self) -> bytes:
        """Return all bytes that are left."""
        return self.take(len(self.data) - self.at)

    def take_text(self) -> bytes:
        """Return the bytes before the next NUL and pass the NUL; EOFError when there is none."""
        end = self.data.find(0, self.at)
        return self.take((end if end >= 0 else len(self.data)) + 1 - self.at)[:-1]


class WireKind(Protocol):
    """One value on the wire."""

    def read(self, reader: Reader) -> object: ...
    def write(self, value: object, out: bytearray) -> None: ...


class IntegerKind(WireKind, Protocol):
    """One integer on the wire, and its limits."""

    @property
    def low(self) -> int: ...
    @property
    def high(self) -> int: ...
    def read(self, reader: Reader) -> int: ...


def checked(value: object, kind: IntegerKind) -> int:
    """Return `value` if it is an integer that `kind` can carry, else raise CommandError."""
    if isinstance(value, bool) or not isinstance(value, int):
        raise CommandError(f"{value!r} is not an integer")
    if not kind.low <= value <= kind.high:
        raise CommandError(f"{value!r} is outside {kind.low}..{kind.high}")
    return int(value)


class Integer(Struct, frozen=True):
    """`size` bytes, two's complement if `signed`."""

    size: int
    signed: bool = False

    @property
    def low(self) -> int:
        return -1 << 8 * self.size - 1 if self.signed else 0

    @property
    def high(self) -> int:
        return (1 << 8 * self.size - self.signed) - 1

    def read(self, reader: Reader) -> int:
        return int.from_bytes(reader.take(self.size), "little", signed=self.signed)

    def write(self, value: object, out: bytearray) -> None:
        out += checked(value, self).to_bytes(self.size, "little", signed=self.signed)


class PacketId(Struct, frozen=True):
    """The id of a packet that may have any of a few, as its first field."""

    choices: tuple[int, ...]

    def read(self, reader: Reader) -> int:
        number = reader.take(1)[0]
        if number not in self.choices:
            raise ValueError(f"{number} is not one of {self.choices}")
        return number

    def write(self, value: object, out: bytearray) -> None:
        if value not in self.choices:
            raise CommandError(f"{value!r} is not one of {self.choices}")
        out.append(self.choices[self.choices.index(value)])


class Unit(Struct, frozen=True):
    """The unit of an integer on the wire: `to_si(raw)` and its inverse `to_raw(si)`."""

    to_si: Callable[[float], float]
    to_raw: Callable[[float], float]


class Scaled(Struct, frozen=True):
    """An SI value, rounded once to the integer that `kind` carries."""

    kind: IntegerKind
    unit: Unit

    def read(self, reader: Reader) -> float:
        return self.unit.to_si(self.kind.read(reader))

    def write(self, value: object, out: bytearray) -> None:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise CommandError(f"{value!r} is not a number")
        low, high = self.kind.low, self.kind.high
        raw = self.unit.to_raw(value) if isfinite(value) else value
        if not (isfinite(raw) and low <= round(raw) <= high):
            limits = f"{self.unit.to_si(low):g}..{self.unit.to_si(high):g}"
            raise CommandError(f"{value!r} is outside {limits}")
        self.kind.write(round(raw), out)


class Enumerated(Struct, frozen=True):
    """A member of `choices`; an integer that is none does not decode."""

    kind: IntegerKind
    choices: type[IntEnum] | type[IntFlag]

    def read(self, reader: Reader) -> IntEnum | IntFlag:
        return self.choices(self.kind.read(reader))

    def write(self, value: object, out: bytearray) -> None:
        try:
            member = self.choices(checked(value, self.kind))
        except ValueError:
            names = ", ".join(f"{choice.value} {choice.name}" for choice in self.choices)
            raise CommandError(f"{value!r} is not one of {names}") from None
        self.kind.write(member, out)


class Switch(Struct, frozen=True):
    """A bool: any integer but 0 reads as true, 1 is written for it."""

    kind: IntegerKind

    def read(self, reader: Reader) -> bool:
        return self.kind.read(reader) != 0

    def write(self, value: object, out: bytearray) -> None:
        if not isinstance(value, bool):
            raise CommandError(f"{value!r} is neither True nor False")
        self.kind.write(int(value), out)


def latin1(value: object) -> bytes:
    """Return the bytes of a text; CommandError if it is none or has letters beyond latin-1."""
    if not isinstance(value, str) or not all(ord(letter) < 256 for letter in value):
        raise CommandError(f"{value!r} is not a latin-1 text")
    return value.encode("latin-1")


class NulTerminated(Struct, frozen=True):
    """A text of latin-1 letters, ended by a NUL."""

    def read(self, reader: Reader) -> str:
        return reader.take_text().decode("latin-1")

    def write(self, value: object, out: bytearray) -> None:
        data = latin1(value)
        if 0 in data:
            raise CommandError(f"{value!r} contains a NUL")
        out += data + b"\0"


class AllThatIsLeft(Struct, frozen=True):
    """Every byte up to the end of the packet."""

    def read(self, reader: Reader) -> bytes:
        return reader.take_rest()

    def write(self, value: object, out: bytearray) -> None:
        if not isinstance(value, bytes | bytearray):
            raise CommandError(f"{value!r} is not bytes")
        out += value


U8 = Annotated[int, Integer(1)]
S8 = Annotated[int, Integer(1, signed=True)]
U16 = Annotated[int, Integer(2)]
S16 = Annotated[int, Integer(2, signed=True)]
U32 = Annotated[int, Integer(4)]
S32 = Annotated[int, Integer(4, signed=True)]
Flag = Annotated[bool, Switch(Integer(1))]
Text = Annotated[str, NulTerminated()]
Rest = Annotated[bytes, AllThatIsLeft()]
