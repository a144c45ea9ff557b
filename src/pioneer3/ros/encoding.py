"""Messages as bytes of ROS 1 and ROS 2, as rosbags writes them, in a fraction of the time.

Each type has a function of its own, made as source. Numbers and texts that follow each other in a
message, also within nested ones, are packed in one call. ROS 2 has CDR, which aligns each number to
its size, from the end of a header of 4 bytes on; ROS 1 has neither. Both are little-endian.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from struct import Struct, calcsize, pack
from typing import Any, Final, cast

import numpy as np

from pioneer3.ros.typestore import ARRAY, BASE, DTYPES, NAME, python_name


@dataclass(frozen=True, slots=True)
class Encoding:
    """A form of messages as bytes; `is_cdr`: numbers are aligned, and texts end with a 0."""

    header: bytes = b""
    is_cdr: bool = False


ROS1: Final = Encoding()
CDR: Final = Encoding(b"\0\1\0\0", is_cdr=True)
NO_FIELD: Final = "structure_needs_at_least_one_member"
"""Field of types without any, which ROS 1 leaves out."""
LETTERS: Final[Mapping[str, str]] = {
    "bool": "?",
    "byte": "b",
    "char": "B",
    "int8": "b",
    "uint8": "B",
    "int16": "h",
    "uint16": "H",
    "int32": "i",
    "uint32": "I",
    "int64": "q",
    "uint64": "Q",
    "float32": "f",
    "float64": "d",
    "string": "s",
}
"""Base types, for :mod:`struct`."""
COUNT: Final = "I"
"""Letter of the length of a text, with the 0 at its end, and of a sequence."""
LARGEST: Final = 8
"""Size of the largest numbers; of a power of 2, as all others."""
LAYOUTS: Final = 256
"""Layouts of a run of fields, by the lengths of its texts, that are remembered."""


def encoder(name: str, fields: Mapping[str, Any], encoding: Encoding) -> Callable[[Any], bytes]:
    """Return the function that serializes messages of the type `name`.

    Lists of numbers may stand for arrays, and `bytes` for arrays of bytes. Fields of each type are
    as rosbags has them.
    """
    source = _Source(fields, encoding)
    source.add(NAME, name, "message")
    source.end_run()
    text = "\n ".join(("def encode(message):", "out = bytearray(header)", *source.lines))
    exec(f"{text}\n return bytes(out)", source.known)
    return cast("Callable[[Any], bytes]", source.known["encode"])


class _Source:
    """Writes the lines of a function that appends a message to `out`, and what they know."""

    def __init__(self, fields: Mapping[str, Any], encoding: Encoding) -> None:
        self.lines: list[str] = []
        self.known: dict[str, object] = {"header": encoding.header}
        self._fields, self._encoding = fields, encoding
        self._indent = ""
        self._letters = ""
        self._values: list[str] = []
        self._lengths: list[str] = []

    def add(self, kind: int, what: Any, value: str) -> None:
        """Append a field, whose value is that of an expression."""
        if kind == NAME:
            message = self._local(value)
            for field, (inner, base) in self._fields[what][1]:
                if self._encoding.is_cdr or field != NO_FIELD:
                    self.add(inner, base, f"{message}.{python_name(field)}")
        elif kind == BASE:
            self._add_base(LETTERS[what[0]], value)
        else:
            item, length = what
            self._add_several(item, length if kind == ARRAY else None, self._local(value))

    def end_run(self) -> None:
        """Pack the numbers and texts that were added one after the other."""
        if self._letters:
            values = ", ".join(self._values)
            if self._encoding.is_cdr or self._lengths:
                pack_run = self._know(_packs(self._letters, self._encoding))
                start = "len(out) & 7" if self._encoding.is_cdr else "0"
                lengths = ", ".join([start, *self._lengths])
                self._write(f"out += {pack_run}({lengths})({values})")
            else:
                self._write(f"out += {self._know(Struct(f'<{self._letters}').pack)}({values})")
            self._letters = ""
            self._values.clear()
            self._lengths.clear()

    def _add_base(self, letter: str, value: str) -> None:
        if letter == "s":
            text = self._local(f"{value}.encode()")
            length = self._local(f"len({text})")
            self._lengths.append(length)
            self._add_base(COUNT, f"{length} + 1" if self._encoding.is_cdr else length)
            value = text
        self._letters += letter
        self._values.append(value)

    def _add_several(self, item: Any, length: int | None, values: str) -> None:
        """Append an array of a `length`, or a sequence."""
        kind, base = item
        letter = LETTERS[base[0]] if kind == BASE and base[0] != "string" else ""
        if letter and length is not None:
            self._letters += letter * length
            self._values.append(f"*{values}")
            return
        if length is None:
            self._add_base(COUNT, f"len({values})")
        else:
            wrong = f"raise ValueError(f'{{len({values})}} values, not {length}')"
            self._write(f"if len({values}) != {length}: {wrong}")
        self.end_run()
        if letter:
            dtype = np.dtype(DTYPES.get(base[0], base[0])).newbyteorder("<")
            write = self._know(_numbers(letter, dtype, self._encoding))
            self._write(f"if len({values}): {write}({values}, out)")
            return
        each = f"each{len(self.lines)}"
        self._write(f"for {each} in {values}:")
        self._indent += " "
        self.add(kind, base, each)
        self.end_run()
        self._indent = self._indent[1:]

    def _local(self, value: str) -> str:
        """Return the name of a variable with the value of an expression."""
        name = f"v{len(self.lines)}"
        self._write(f"{name} = {value}")
        return name

    def _know(self, thing: object) -> str:
        """Return the name by which the function knows a thing."""
        name = f"k{len(self.known)}"
        self.known[name] = thing
        return name

    def _write(self, line: str) -> None:
        self.lines.append(self._indent + line)


def _packs(letters: str, encoding: Encoding) -> Callable[..., Callable[..., bytes]]:
    """Return the function that finds how to pack a run that starts somewhere, with its texts."""

    @lru_cache(LAYOUTS)
    def packs(start: int, *lengths: int) -> Callable[..., bytes]:
        if encoding.is_cdr:
            start -= len(encoding.header)
            return Struct("<" + "".join(_aligned(letters, start, lengths))).pack
        left = iter(lengths)
        return Struct("<" + "".join(f"{next(left)}s" if x == "s" else x for x in letters)).pack

    return packs


def _aligned(letters: str, start: int, lengths: tuple[int, ...]) -> Iterator[str]:
    """Yield the format of each value of a run, after the gap before it."""
    at, left = start, iter(lengths)
    for letter in letters:
        if letter == "s":
            length = next(left)
            yield f"{length}sx"
            at += length + 1
        else:
            size = calcsize(f"={letter}")
            gap = -at % size
            yield "x" * gap + letter
            at += gap + size


def _numbers(
    letter: str, dtype: "np.dtype[Any]", encoding: Encoding
) -> Callable[[Any, bytearray], None]:
    """Return the function that appends any number of numbers."""
    size, header = dtype.itemsize if encoding.is_cdr else 1, len(encoding.header)

    def write(values: Any, out: bytearray) -> None:
        out += bytes(header - len(out) & size - 1)
        if isinstance(values, list | tuple):
            out += pack(f"<{len(values)}{letter}", *values)
        elif isinstance(values, np.ndarray):
            out += values.astype(dtype, copy=False).tobytes()
        else:
            out += values

    return write
