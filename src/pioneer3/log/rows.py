"""Messages of one topic and chunk as columns, exactly, and back.

A column has the values of one field in all messages, which take less room side by side: what is the
same in all is there once, and numbers are told by their differences.
"""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from enum import IntEnum
from itertools import accumulate, chain, pairwise, repeat
from math import copysign, inf, isfinite, nan
from operator import attrgetter
from struct import pack
from typing import TYPE_CHECKING, Any, Final

import msgspec

from pioneer3.log.differences import differences, joined_planes, planes, sums
from pioneer3.log.topics import AS_THEY_ARE, with_texts
from pioneer3.state import Scan
from pioneer3.units import MM

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

NO_NUMBERS: Final = (inf, -inf, nan)
"""Values that the whole numbers behind the greatest one stand for."""
LARGEST: Final = 2.0**53
"""Whole numbers are exact up to it."""
LONGEST_WAY: Final = 1e9
"""Longer numbers are no lengths [m]."""
SIZES: Final = {1: "b", 2: "h", 4: "i", 8: "q"}
"""Sizes of whole numbers [bytes], with the format of each."""
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
Values = Sequence[Any]
"""The values of one field in all messages."""
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


def pack_rows(times: Sequence[int], fields: Mapping[str, Values]) -> tuple[bytes, bytes]:
    """Return the shape of messages as JSON, and all as one, by their times [ns] and fields."""
    columns: list[list[Any]] = []
    shape = _shape(fields, columns)
    steps = [after - before for before, after in pairwise(times)]
    return ENCODER.encode(shape), msgspec.msgpack.encode([steps, columns])


def fields_of(messages: Sequence[Any]) -> dict[str, Values]:
    """Return the values of each field of objects of one class."""
    names = type(messages[0]).__dataclass_fields__
    fields: dict[str, Values] = {name: [*map(attrgetter(name), messages)] for name in names}
    if isinstance(messages[0], Scan):
        from pioneer3.log.scans import packed_ranges  # numpy loads slowly

        fields |= packed_ranges(fields.pop("ranges"))
    return fields


def _shape(fields: Mapping[str, Values], columns: list[list[Any]]) -> Shape:
    """Return the shape of messages, and append their columns."""
    shape: Shape = {}
    for name, values in fields.items():
        kinds = {*map(type, values)}
        if len(kinds) == 1 and hasattr(values[0], "__dataclass_fields__"):
            shape[name] = _shape(fields_of(values), columns)
        else:
            shape[name] = len(columns)
            columns.append(_column(values, kinds))
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


def _lines(values: Values) -> list[bytes]:
    """Return values as JSON, each."""
    return ENCODER.encode_lines([*map(with_texts, values)]).split(b"\n")[:-1]


def _column(values: Values, kinds: set[type]) -> list[Any]:
    first = values[0]
    if values.count(first) == len(values) and (
        (len(kinds) == 1 and (kinds <= AS_THEY_ARE or (kinds == {float} and first)))
        or len({*map(id, values)}) == 1
        or len({*map(msgspec.msgpack.encode, values)}) == 1  # 0.0 is not -0.0
    ):
        return [Kind.SAME, first]
    if kinds == {bytes}:
        if len({*map(len, values)}) == 1:
            return [Kind.BYTES, planes(differences(b"".join(values), STEP), STEP)]
        return [Kind.PLAIN, values]
    places, begin = [values], first
    if _are_even_lists(values):
        places, begin = [*zip(*values, strict=True)], [*first]
        kinds = {*map(type, chain.from_iterable(places))}
    if kinds == {float}:
        return _floats(places, begin)
    if kinds == {int} and max(map(abs, chain.from_iterable(places))) < LARGEST:
        return [Kind.COUNTS, begin, *_steps(places)]
    return [Kind.PLAIN, values]


def _are_even_lists(values: Values) -> bool:
    """Whether values are lists of one length that is not too long."""
    if not all(isinstance(each, list | tuple) for each in values):
        return False
    length = len(values[0])
    return 0 < length <= LONGEST and all(len(each) == length for each in values)


def _floats(places: Sequence[Values], begin: Any) -> list[Any]:
    """Return a column of numbers by their places in lists, and those of the first row."""
    whole = _lengths(chain.from_iterable(places))
    if whole is None:
        numbers = [*chain.from_iterable(zip(*places, strict=True))]
        return [Kind.FLOATS, planes(pack(f"<{len(numbers)}d", *numbers), EXACT)]
    most = max(whole.values(), default=0)
    whole |= {inf: most + 1, -inf: most + 2}
    counts = [[whole.get(number, most + 3) for number in place] for place in places]
    first = [place[0] for place in counts]
    return [Kind.LENGTHS, most, first if isinstance(begin, list) else first[0], *_steps(counts)]


def _lengths(numbers: Iterable[float]) -> dict[float, int] | None:
    """Return whole millimetres for each finite number; `None` where one is of another length."""
    whole: dict[float, int] = {}
    for number in numbers:
        if number not in whole and isfinite(number):
            count = round(number / MM) if abs(number) < LONGEST_WAY else 0
            if count * MM != number:
                return None
            whole[number] = count
        if not number and copysign(1, number) < 0:
            return None
    return whole


def _steps(places: Sequence[Values]) -> tuple[int, bytes]:
    """Return the size of what is added in each row, and its planes, place by place."""
    steps = [after - before for place in places for before, after in pairwise(place)]
    bound = max(map(abs, steps))
    size = next(size for size in SIZES if bound < 1 << (8 * size - 1))
    return size, planes(pack(f"<{len(steps)}{SIZES[size]}", *steps), size)


def _values(kind: int, *parts: Any, rows: int) -> Values:
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
            import numpy as np

            numbers = np.frombuffer(joined_planes(data, EXACT), "<f8")
            shape = (rows,) if len(numbers) == rows else (rows, -1)
            return numbers.reshape(shape).tolist()  # type: ignore[no-any-return]
        case Kind.BYTES, bytes(data):
            joined, length = sums(joined_planes(data, STEP), STEP), len(data) // rows
            if length * rows != len(joined):
                raise ValueError("the sizes of bytes do not fit")
            return [joined[at : at + length] for at in range(0, len(joined), length)]
    raise ValueError(f"a column of kind {kind}")


def _whole(first: Any, size: int, data: bytes, rows: int) -> "NDArray[np.int64]":
    """Return the whole numbers of a column."""
    if size not in SIZES:
        raise ValueError(f"whole numbers of {size} bytes")
    import numpy as np  # loads slowly, and writing needs none of it

    begin = np.array(first, np.int64)
    steps = np.frombuffer(joined_planes(data, size), f"<i{size}")
    added = steps.reshape(begin.size, rows - 1).T.reshape(rows - 1, *begin.shape)
    return np.concatenate([begin[np.newaxis], added]).cumsum(axis=0)
