"""Kinds that hold several values: sequences and records."""

import struct
from collections.abc import Sequence
from functools import cache, partial
from itertools import chain
from typing import Any

from msgspec import Struct

from pioneer3.arcos.layout import read_fields, write_fields
from pioneer3.arcos.wire import Integer, IntegerKind, Reader, WireKind, latin1
from pioneer3.errors import CommandError


class Record(Struct, frozen=True):
    """A nested message of class `cls`, without an id of its own."""

    cls: type

    def read(self, reader: Reader) -> object:
        return read_fields(self.cls, reader)

    def write(self, value: object, out: bytearray) -> None:
        if not isinstance(value, self.cls):
            raise CommandError(f"{value!r} is not a {self.cls.__name__}")
        write_fields(value, out)


class Repeated(Struct, frozen=True):
    """A tuple of `item` up to the end of the packet, or of exactly `length`."""

    item: WireKind
    length: int | None = None

    def read(self, reader: Reader) -> tuple[object, ...]:
        if self.length is not None:
            return tuple(self.item.read(reader) for _ in range(self.length))
        values = []
        while reader.at < len(reader.data):
            values.append(self.item.read(reader))
        return tuple(values)

    def write(self, value: object, out: bytearray) -> None:
        values = sequence(value)
        if self.length not in (None, len(values)):
            raise CommandError(f"{len(values)} values are not {self.length}")
        for item in values:
            self.item.write(item, out)


class Counted(Struct, frozen=True):
    """A number, and that many of `item`."""

    count: IntegerKind
    item: WireKind

    def read(self, reader: Reader) -> tuple[object, ...]:
        count = self.count.read(reader)
        if count < 0:
            raise ValueError(f"{count} values")
        return tuple(self.item.read(reader) for _ in range(count))

    def write(self, value: object, out: bytearray) -> None:
        values = sequence(value)
        if len(values) > self.count.high:
            raise CommandError(f"{len(values)} values are more than {self.count.high}")
        self.count.write(len(values), out)
        for item in values:
            self.item.write(item, out)


class SizedRecords(Struct, frozen=True):
    """How many records of `cls`, the bytes that each one takes (`size` by default), the records."""

    cls: type
    size: int

    def read(self, reader: Reader) -> tuple[object, ...]:
        count, size = reader.take(2)
        return tuple(read_fields(self.cls, Reader(reader.take(size))) for _ in range(count))

    def write(self, value: object, out: bytearray) -> None:
        records = [bytearray() for _ in sequence(value)]
        for record, item in zip(records, sequence(value), strict=True):
            Record(self.cls).write(item, record)
        sizes = {len(record) for record in records} or {self.size}
        if len(sizes) > 1 or max(*sizes, len(records)) > 255:
            raise CommandError(f"records of {sorted(sizes)} bytes cannot share one packet")
        out += bytes([len(records), *sizes]) + b"".join(records)


def sequence(value: object) -> tuple[object, ...] | list[object]:
    """Return `value` if it is a tuple or list, else raise CommandError."""
    if not isinstance(value, tuple | list):
        raise CommandError(f"{value!r} is not a sequence")
    return value


class CountedStructs(Struct, frozen=True):
    """A byte, and that many records of `cls`, a `NamedTuple` whose fields have letters `format`.

    The same bytes as `Counted(Integer(1), Record(cls))`, seven times faster (:mod:`struct`).
    """

    cls: type[tuple[object, ...]]
    format: str

    def read(self, reader: Reader) -> tuple[object, ...]:
        record = _record(self.format)
        data = reader.take(reader.take(1)[0] * record.size)
        # without the checks of `cls`: a record has as many values as letters
        return tuple(map(partial(tuple.__new__, self.cls), record.iter_unpack(data)))

    def write(self, value: object, out: bytearray) -> None:
        records: Sequence[Any] = sequence(value)
        try:
            if set(map(type, records)) <= {self.cls}:
                data = struct.pack("<" + self.format * len(records), *chain.from_iterable(records))
                out += bytes([len(records)]) + data
                return
        except (ValueError, struct.error):
            pass
        Counted(Integer(1), Record(self.cls)).write(value, out)  # it says the reason


@cache
def _record(letters: str) -> struct.Struct:
    return struct.Struct(f"<{letters}")


class CountedText(Struct, frozen=True):
    """A number, and that many latin-1 letters."""

    count: IntegerKind

    def read(self, reader: Reader) -> str:
        return reader.take(self.count.read(reader)).decode("latin-1")

    def write(self, value: object, out: bytearray) -> None:
        data = latin1(value)
        self.count.write(len(data), out)
        out += data
