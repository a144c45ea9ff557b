"""Messages of one topic and chunk as columns, exactly, and back.

A column has the values of one field in all messages, which take less room side by side: what is the
same in all is there once, and numbers are told by their differences.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from enum import IntEnum
from itertools import accumulate, chain, pairwise, repeat
from typing import Any, Final

import msgspec
import numpy as np
from numpy.typing import NDArray

from pioneer3.log.differences import differences, joined_planes, planes, sums
from pioneer3.log.topics import with_texts
from pioneer3.units import MM

NO_NUMBERS: Final = (np.inf, -np.inf, np.nan)
"""Values that the whole numbers behind the greatest one stand for."""
LARGEST: Final = 2.0**53
"""Whole numbers are exact up to it."""
LONGEST_WAY: Final = 1e9
"""Longer numbers are no lengths [m]."""
SIZES: Final = (1, 2, 4, 8)
"""Sizes of whole numbers [bytes]."""
EXACT: Final = 8
"""Size of other numbers [bytes]."""
LONGEST: Final = 64
"""Longer lists of numbers stay as they are."""
STEP: Final = 2
"""Bytes are told by their difference to those so many before: lasers send whole numbers of 2."""
MOST_ROWS: Final = 20_000
"""Rows of one message at most; ours have a second."""
PLACE: Final = re.compile(rb":(\d+)(?=[,}])")
"""Number of a column in a shape, as JSON has it."""
ENCODER: Final = msgspec.json.Encoder()
"""Writes JSON."""
Shape = dict[str, "int | Shape"]
"""Fields of messages by their names, each the number of its column, or the fields inside."""


class Kind(IntEnum):
    """Kinds of columns, by what follows in them."""

    SAME = 0
    """The value in all rows."""
    PLAIN = 1
    """All values."""
    COUNTS = 2
    """Whole numbers: the first, size, planes of what is added in each row."""
    LENGTHS = 3
    """Whole millimetres: the greatest, then as above; those behind it stand for no numbers."""
    FLOATS = 4
    """Planes of all numbers."""
    BYTES = 5
    """Planes of the differences of all bytes, which are as many in each row."""


def pack_rows(times: Sequence[int], rows: Sequence[Mapping[str, Any]]) -> tuple[bytes, bytes]:
    """Return the shape of messages as JSON, and all as one, by their times [ns] and fields."""
    columns: list[list[Any]] = []
    shape = _shape(rows, columns)
    steps = [after - before for before, after in pairwise(times)]
    return ENCODER.encode(shape), msgspec.msgpack.encode([steps, columns])


def _shape(rows: Sequence[Mapping[str, Any]], columns: list[list[Any]]) -> Shape:
    """Return the shape of rows, and append their columns."""
    shape: Shape = {}
    for name, first in rows[0].items():
        values = [row[name] for row in rows]
        if type(first) is dict and all(type(each) is dict for each in values):
            shape[name] = _shape(values, columns)
        else:
            shape[name] = len(columns)
            columns.append(_column(values))
    return shape


def unpack_rows(time: int, data: bytes, shape: bytes) -> Iterator[tuple[int, bytes]]:
    """Yield messages as JSON with their times; the first is of `time` [ns].

    Raises:
        msgspec.MsgspecError, ValueError, TypeError, IndexError: They are damaged.
    """
    steps, told = msgspec.msgpack.decode(data, type=tuple[list[int], list[list[Any]]])
    count = len(steps) + 1
    if count > MOST_ROWS:
        raise ValueError(f"a message of {count} rows")
    columns = [told[int(number)] for number in PLACE.findall(shape)]
    same = iter(_lines([value for kind, value, *_ in columns if kind == Kind.SAME]))
    template = PLACE.sub(b":%s", shape.replace(b"%", b"%%%%")) % tuple(
        next(same).replace(b"%", b"%%") if kind == Kind.SAME else b"%s" for kind, *_ in columns
    )
    varying = [_lines(_values(*each, rows=count)) for each in columns if each[0] != Kind.SAME]
    rows = zip(*varying, strict=True) if varying else repeat((), count)
    for at, row in zip(accumulate(steps, initial=time), rows, strict=True):
        yield at, template % row


def _lines(values: Sequence[Any]) -> list[bytes]:
    """Return values as JSON, each."""
    return ENCODER.encode_lines([*map(with_texts, values)]).split(b"\n")[:-1]


def _column(values: Sequence[Any]) -> list[Any]:
    first = values[0]
    if values.count(first) == len(values) and len({*map(msgspec.msgpack.encode, values)}) == 1:
        return [Kind.SAME, first]
    if isinstance(first, bytes):
        joined = b"".join(values)
        if all(len(each) == len(first) for each in values):
            return [Kind.BYTES, planes(differences(joined, STEP), STEP)]
        return [Kind.PLAIN, values]
    kinds = {*map(type, chain.from_iterable(values) if _are_even_lists(values) else values)}
    if kinds == {float}:
        return _floats(np.array(values))
    whole = np.array(values if kinds == {int} else 0.0)
    if whole.dtype == np.int64 and (np.abs(whole) < LARGEST).all():
        return [Kind.COUNTS, *_counts(whole)]
    return [Kind.PLAIN, values]


def _are_even_lists(values: Sequence[Any]) -> bool:
    """Whether values are lists of one length that is not too long."""
    if not all(isinstance(each, list | tuple) for each in values):
        return False
    length = len(values[0])
    return 0 < length <= LONGEST and all(len(each) == length for each in values)


def _floats(numbers: NDArray[np.float64]) -> list[Any]:
    is_number = np.isfinite(numbers)
    known = numbers[is_number]
    whole = np.rint(np.clip(known, -LONGEST_WAY, LONGEST_WAY) / MM)
    if (whole * MM == known).all() and not np.signbit(known[known == 0]).any():
        most = int(whole.max(initial=0))
        full = np.where(np.isnan(numbers), most + 3, most + np.where(numbers > 0, 1, 2))
        full[is_number] = whole
        return [Kind.LENGTHS, most, *_counts(full)]
    return [Kind.FLOATS, planes(numbers.astype("<f8").tobytes(), EXACT)]


def _counts(whole: NDArray[np.int64]) -> list[Any]:
    steps = np.diff(whole, axis=0)
    bound = int(np.abs(steps).max())
    size = next(size for size in SIZES if bound < 1 << (8 * size - 1))
    return [whole[0].tolist(), size, planes(steps.T.astype(f"<i{size}").tobytes(), size)]


def _values(kind: int, *parts: Any, rows: int) -> Sequence[Any]:
    """Return the values of a column that is not the same in all rows."""
    match kind, *parts:
        case Kind.PLAIN, list(values) if len(values) == rows:
            return values
        case Kind.COUNTS, first, int(size), bytes(data):
            return _whole(first, size, data, rows).tolist()  # type: ignore[no-any-return]
        case Kind.LENGTHS, int(most), first, int(size), bytes(data):
            whole = _whole(first, size, data, rows)
            numbers = whole * MM
            if whole.max() > most:
                for number, value in enumerate(NO_NUMBERS, most + 1):
                    numbers[whole == number] = value
            return numbers.tolist()  # type: ignore[no-any-return]
        case Kind.FLOATS, bytes(data):
            numbers = np.frombuffer(joined_planes(data, EXACT), "<f8")
            shape = (rows,) if len(numbers) == rows else (rows, -1)
            return numbers.reshape(shape).tolist()  # type: ignore[no-any-return]
        case Kind.BYTES, bytes(data):
            joined, length = sums(joined_planes(data, STEP), STEP), len(data) // rows
            if length * rows != len(joined):
                raise ValueError("the sizes of bytes do not fit")
            return [joined[at : at + length] for at in range(0, len(joined), length)]
    raise ValueError(f"a column of kind {kind}")


def _whole(first: Any, size: int, data: bytes, rows: int) -> NDArray[np.int64]:
    """Return the whole numbers of a column."""
    if size not in SIZES:
        raise ValueError(f"whole numbers of {size} bytes")
    begin = np.array(first, np.int64)
    steps = np.frombuffer(joined_planes(data, size), f"<i{size}")
    added = steps.reshape(begin.size, rows - 1).T.reshape(rows - 1, *begin.shape)
    return np.concatenate([begin[np.newaxis], added]).cumsum(axis=0)
