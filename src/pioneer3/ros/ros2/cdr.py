"""Messages as bytes: little-endian CDR, as rosbags writes it, in a third of the time.

Numbers that follow each other in a message, also within nested ones, are packed in one call. CDR
aligns each number to its size, from the end of the header of 4 bytes on.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from operator import attrgetter
from struct import Struct, calcsize, pack
from typing import Any, Final

import numpy as np

from pioneer3.ros.typestore import ARRAY, BASE, DTYPES, NAME, python_name

HEADER: Final = b"\0\1\0\0"
"""Header of little-endian CDR."""
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
}
"""Base types but strings, for :mod:`struct`."""
LARGEST: Final = 8
"""Size of the largest numbers; of a power of 2, as all others."""
Write = Callable[[Any, bytearray], None]
"""Appends a message or a part of one, several values, or a text."""


def encoder(name: str, fields: Mapping[str, Any]) -> Callable[[Any], bytes]:
    """Return the function that serializes messages of the type `name`.

    Lists of numbers may stand for arrays, and `bytes` for arrays of bytes. Fields of each type are
    as rosbags has them.
    """
    steps = _steps(name, fields)

    def encode(message: Any) -> bytes:
        out = bytearray(HEADER)
        for step in steps:
            step(message, out)
        return bytes(out)

    return encode


def _steps(name: str, fields: Mapping[str, Any]) -> Sequence[Write]:
    """Return the functions that write the parts of a message, in their order."""
    steps: list[Write] = []
    paths: list[str] = []
    letters = ""
    for path, (kind, what) in _flat(name, fields):
        if kind == BASE and what[0] != "string":
            paths.append(path)
            letters += LETTERS[what[0]]
            continue
        if paths:
            steps.append(_packed(_all_of(paths), letters))
            paths, letters = [], ""
        steps.append(_step(path, kind, what, fields))
    if paths:
        steps.append(_packed(_all_of(paths), letters))
    return steps


def _flat(name: str, fields: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, Any]]:
    """Yield each field of a message, with those of nested ones in their place."""
    for field, desc in fields[name][1]:
        path = before + python_name(field)
        kind, what = desc
        if kind == NAME:
            yield from _flat(what, fields, f"{path}.")
        else:
            yield path, desc


def _step(path: str, kind: int, what: Any, fields: Mapping[str, Any]) -> Write:
    """Return the function that writes a field that is no number."""
    get = attrgetter(path)
    if kind == BASE:
        return _text(get)
    item, length = what
    if kind == ARRAY and (letter := _letter(item)):
        return _packed(get, letter * length)
    write_all = _items(item, fields)

    def write_array(message: Any, out: bytearray) -> None:
        if len(values := get(message)) != length:
            raise ValueError(f"{path} has {len(values)} values, not {length}")
        write_all(values, out)

    def write_sequence(message: Any, out: bytearray) -> None:
        values = get(message)
        out += PACK_COUNT[len(out) & 3](len(values))
        if len(values):
            write_all(values, out)

    return write_array if kind == ARRAY else write_sequence


def _items(item: Any, fields: Mapping[str, Any]) -> Write:
    """Return the function that writes several values of one type, given as rosbags has it."""
    kind, base = item
    if letter := _letter(item):
        return _numbers(letter, np.dtype(DTYPES.get(base[0], base[0])).newbyteorder("<"))
    steps = (_text(str),) if kind == BASE else _steps(base, fields)

    def write(values: Iterable[Any], out: bytearray) -> None:
        for value in values:
            for step in steps:
                step(value, out)

    return write


def _letter(item: Any) -> str:
    """Return the letter of a type of numbers; empty for all others."""
    kind, base = item
    return LETTERS[base[0]] if kind == BASE and base[0] != "string" else ""


def _packed(values_of: Callable[[Any], Iterable[Any]], letters: str) -> Write:
    """Return the function that writes a number for each letter."""
    packs = [Struct(_aligned(letters, start)).pack for start in range(LARGEST)]

    def write(message: Any, out: bytearray) -> None:
        out += packs[len(out) - len(HEADER) & LARGEST - 1](*values_of(message))

    return write


def _aligned(letters: str, start: int) -> str:
    """Return the format of numbers of which the first may begin at `start`, with the gaps."""
    at, parts = start, ["<"]
    for letter in letters:
        size = calcsize(f"={letter}")
        gap = -at % size
        parts.append("x" * gap + letter)
        at += gap + size
    return "".join(parts)


def _all_of(paths: Sequence[str]) -> Callable[[Any], tuple[Any, ...]]:
    """Return the function that reads several fields."""
    get = attrgetter(*paths)
    return get if len(paths) > 1 else lambda message: (get(message),)


def _numbers(letter: str, dtype: "np.dtype[Any]") -> Write:
    """Return the function that writes any number of numbers."""
    size = dtype.itemsize

    def write(values: Any, out: bytearray) -> None:
        out += bytes(len(HEADER) - len(out) & size - 1)
        if isinstance(values, list | tuple):
            out += pack(f"<{len(values)}{letter}", *values)
        elif isinstance(values, np.ndarray):
            out += values.astype(dtype, copy=False).tobytes()
        else:
            out += values

    return write


PACK_COUNT: Final = tuple(Struct(_aligned("I", start)).pack for start in range(4))
"""Pack the number of values of a sequence, by the place where its gap begins."""


def _text(text_of: Callable[[Any], str]) -> Write:
    """Return the function that writes a text, which ends with a 0 that counts."""

    def write(message: Any, out: bytearray) -> None:
        data = text_of(message).encode()
        out += PACK_COUNT[len(out) & 3](len(data) + 1) + data + b"\0"

    return write
