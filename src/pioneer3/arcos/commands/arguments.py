"""Arguments of commands on the wire, and their units (protocol.md 1.3).

====  ====================  ========================================
type  meaning               followed by
====  ====================  ========================================
0x3B  non-negative integer  u16 magnitude
0x1B  negative integer      u16 magnitude
0x2B  string                u8 length and that many bytes
====  ====================  ========================================

After a string ARIA's `comStr` adds a NUL that is not counted; its `comDataN` leaves out the length.

An integer stands for itself modulo 2**16: ARIA converts every argument to a signed 16-bit
number, so that 40000 arrives as 0x1B 25536, and two packed bytes of 0xF60A as 0x1B 0x09F6.
Each field takes the one value of that class that lies in its range.

ARIA's arguments are signed 16-bit numbers, so a quantity without sign ends at 32767; a `Word` is
a plain number for which the robot uses all 16 bits.
"""

from enum import IntEnum
from math import degrees, radians
from typing import Annotated

from msgspec import Struct

from pioneer3.arcos.wire import (
    AllThatIsLeft,
    Enumerated,
    Reader,
    Scaled,
    Switch,
    Unit,
    WireKind,
    checked,
    latin1,
)
from pioneer3.errors import CommandError
from pioneer3.units import DECIVOLT, MM, MS

__all__ = ["Baud", "RequestMode"]
"""Names that callers use; the rest is for the modules beside this one."""

NON_NEGATIVE, NEGATIVE, STRING = 0x3B, 0x1B, 0x2B
SIGNS = {NON_NEGATIVE: 1, NEGATIVE: -1}
ARGUMENT_SIZE = 3
MAX_STRING = 199
"""Longest string that ARIA sends [bytes] (protocol.md 1.2)."""


def take_argument(reader: Reader) -> int:
    """Return the next integer argument, -65535..65535."""
    sign = SIGNS.get(reader.take(1)[0])
    if sign is None:
        raise ValueError("not an integer argument")
    return sign * int.from_bytes(reader.take(2), "little")


def put_argument(value: int, out: bytearray) -> None:
    """Append `value`, -65535..65535, as an integer argument."""
    out.append(NON_NEGATIVE if value >= 0 else NEGATIVE)
    out += abs(value).to_bytes(2, "little")


class Argument(Struct, frozen=True):
    """One integer argument between `low` and `high`."""

    low: int
    high: int

    def read(self, reader: Reader) -> int:
        value = (take_argument(reader) - self.low) % 0x10000 + self.low
        if value > self.high:
            raise ValueError(f"{value} is outside {self.low}..{self.high}")
        return value

    def write(self, value: object, out: bytearray) -> None:
        put_argument(checked(value, self), out)


class Bits(Struct, frozen=True):
    """Some bits of an integer argument that several fields share, a two's complement if `signed`.

    `shift` is the number of the lowest bit; `continues` says that the field before this one belongs
    to the same argument.
    """

    shift: int
    width: int
    signed: bool = False
    continues: bool = False

    @property
    def low(self) -> int:
        return -1 << self.width - 1 if self.signed else 0

    @property
    def high(self) -> int:
        return self.low + self._mask

    @property
    def _mask(self) -> int:
        return (1 << self.width) - 1

    def read(self, reader: Reader) -> int:
        if self.continues:
            reader.at -= ARGUMENT_SIZE
        return ((take_argument(reader) >> self.shift) - self.low & self._mask) + self.low

    def write(self, value: object, out: bytearray) -> None:
        word = (checked(value, self) & self._mask) << self.shift
        if self.continues:
            word |= take_argument(Reader(bytes(out[-ARGUMENT_SIZE:]))) & 0xFFFF
            del out[-ARGUMENT_SIZE:]
        # like ARIA's com2Bytes, which hands a signed 16-bit number to comInt
        put_argument(word - 0x10000 if word & 0x8000 else word, out)


class String(Struct, frozen=True):
    """A string argument; `tail` follows it uncounted."""

    content: WireKind
    limit: int = MAX_STRING
    tail: bytes = b""

    def read(self, reader: Reader) -> object:
        if reader.take(1)[0] != STRING:
            raise ValueError("not a string argument")
        body = reader.take_rest()
        end = 1 + body[0] if body else 1
        is_counted = len(body) == end or body[end:] == b"\0"
        content = body[1:end] if is_counted else body
        if len(content) > self.limit:
            raise ValueError(f"{len(content)} bytes are more than {self.limit}")
        return self.content.read(Reader(content))

    def write(self, value: object, out: bytearray) -> None:
        data = bytearray()
        self.content.write(value, data)
        if len(data) > self.limit:
            raise CommandError(f"{len(data)} bytes are more than {self.limit}")
        out += bytes([STRING, len(data)]) + data + self.tail


class Latin1(Struct, frozen=True):
    """The content of a string, as text."""

    def read(self, reader: Reader) -> str:
        return reader.take_rest().decode("latin-1")

    def write(self, value: object, out: bytearray) -> None:
        out += latin1(value)


class Prefixed(Struct, frozen=True):
    """A value after a type byte without meaning: any is read, `prefix` is written."""

    kind: WireKind
    prefix: int

    def read(self, reader: Reader) -> object:
        reader.take(1)
        return self.kind.read(reader)

    def write(self, value: object, out: bytearray) -> None:
        out.append(self.prefix)
        self.kind.write(value, out)


class RequestMode(IntEnum):
    """How often to send a report."""

    STOP = 0
    ONCE = 1
    STREAM = 2


class Baud(IntEnum):
    """Baud codes of HOSTBAUD, AUX1BAUD, AUX2BAUD and CONFIG (protocol.md 1.1)."""

    B9600 = 0
    B19200 = 1
    B38400 = 2
    B57600 = 3
    B115200 = 4


def per_si(count: float) -> Unit:
    """Return the unit of which `count` make one SI unit."""
    # dividing, not multiplying by 0.001, gives back exactly the number a person would write
    return Unit(lambda raw: raw / count, lambda si: si * count)


MILLI = per_si(1 / MM)
DECI = per_si(1 / DECIVOLT)
ONE = per_si(1)
TWENTY_MS = per_si(1 / (20 * MS))
DEGREES = Unit(radians, degrees)
CENTIDEGREES = Unit(lambda raw: radians(raw / 100), lambda si: degrees(si) * 100)
HUNDREDTHS_OR_DEGREES = Unit(
    lambda raw: radians(raw if raw <= 5 else raw / 100), CENTIDEGREES.to_raw
)
"""For SIM_LRF_SET_RES, where sources disagree (facts.md 13, row 15)."""

POSITIVE = Argument(0, 0x7FFF)
SIGNED = Argument(-0x8000, 0x7FFF)
WORD = Argument(0, 0xFFFF)

BaudCode = Annotated[Baud, Enumerated(WORD, Baud)]
RequestModeCode = Annotated[RequestMode, Enumerated(WORD, RequestMode)]
On = Annotated[bool, Switch(WORD)]
Word = Annotated[int, WORD]
Number = Annotated[int, SIGNED]
Celsius = Annotated[int, Argument(-128, 127)]

Millis = Annotated[float, Scaled(POSITIVE, MILLI)]
SignedMillis = Annotated[float, Scaled(SIGNED, MILLI)]
Degrees = Annotated[float, Scaled(POSITIVE, DEGREES)]
SignedDegrees = Annotated[float, Scaled(SIGNED, DEGREES)]
Decivolts = Annotated[float, Scaled(POSITIVE, DECI)]
Seconds = Annotated[float, Scaled(POSITIVE, ONE)]

High = Annotated[int, Bits(8, 8)]
Low = Annotated[int, Bits(0, 8, continues=True)]
LowOn = Annotated[bool, Switch(Bits(0, 8, continues=True))]
SignedHigh = Annotated[int, Bits(8, 8, signed=True)]
SignedLow = Annotated[int, Bits(0, 8, signed=True, continues=True)]

Data = Annotated[bytes, String(AllThatIsLeft())]
Message = Annotated[str, String(Latin1(), tail=b"\0")]
