"""How the arguments of client commands travel (arcos.md 1.3).

====  ====================  ========================================
type  meaning               followed by
====  ====================  ========================================
0x3B  non-negative integer  u16 magnitude
0x1B  negative integer      u16 magnitude
0x2B  string                u8 length and that many bytes
====  ====================  ========================================

After a string ARIA's `comStr` adds a NUL that is not counted; its `comDataN` leaves out the length.

An integer stands for itself modulo 2**16: ARIA squeezes every argument through a signed 16-bit
number, so that 40000 arrives as 0x1B 25536, and two packed bytes of 0xF60A as 0x1B 0x09F6.
Each field takes the one value of that class that lies in its range.
"""

from dataclasses import dataclass

from pioneer3.arcos.wire import Kind, Reader, checked, latin1
from pioneer3.errors import CommandError

NON_NEGATIVE, NEGATIVE, STRING = 0x3B, 0x1B, 0x2B
SIGNS = {NON_NEGATIVE: 1, NEGATIVE: -1}
ARGUMENT_SIZE = 3
MAX_STRING = 199
"""Longest string that ARIA sends [bytes] (arcos.md 1.2)."""


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


@dataclass(frozen=True, slots=True)
class Argument:
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


@dataclass(frozen=True, slots=True)
class Bits:
    """Some bits of an integer argument that several fields share.

    Attributes:
        shift: Number of the lowest bit.
        width: How many bits.
        signed: Whether they are a two's complement number.
        continues: Whether the field before this one belongs to the same argument.
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


@dataclass(frozen=True, slots=True)
class String:
    """A string argument; `tail` is what follows it uncounted."""

    content: Kind
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


@dataclass(frozen=True, slots=True)
class Latin1:
    """The content of a string, as text."""

    def read(self, reader: Reader) -> str:
        return reader.take_rest().decode("latin-1")

    def write(self, value: object, out: bytearray) -> None:
        out += latin1(value)


@dataclass(frozen=True, slots=True)
class Prefixed:
    """A value after a type byte that says nothing: any is read, `prefix` is written."""

    kind: Kind
    prefix: int

    def read(self, reader: Reader) -> object:
        reader.take(1)
        return self.kind.read(reader)

    def write(self, value: object, out: bytearray) -> None:
        out.append(self.prefix)
        self.kind.write(value, out)
