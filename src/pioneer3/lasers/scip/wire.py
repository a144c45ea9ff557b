"""SCIP on the wire: lines, checksums, characters and numbers (scip.md 1). No I/O.

An answer is some lines that end in LF; an empty line ends it::

    echo of the command LF  status LF  data LF  data LF  LF
"""

from array import array
from binascii import a2b_base64, b2a_base64
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from string import ascii_lowercase, ascii_uppercase, digits
from struct import unpack
from sys import byteorder
from typing import Final
from zlib import adler32

ZERO: Final = 0x30
"""The character of six zero bits."""
ALPHABET: Final = bytes(range(ZERO, ZERO + 64))
BASE64: Final = (ascii_uppercase + ascii_lowercase + digits + "+/").encode()
"""Alphabet of base64, which the standard library packs much faster than a loop."""
TO_BASE64: Final = bytes.maketrans(ALPHABET, BASE64)
FROM_BASE64: Final = bytes.maketrans(BASE64, ALPHABET)
LINE: Final = 64
"""Characters of a data line, without its checksum."""
STAMP: Final = 4
"""Characters of a time stamp."""
MAX_ANSWER: Final = 1 << 16
"""More bytes without an empty line are noise; the longest answer has some 25000."""
ENDED: Final = b"\n\n"


@dataclass(frozen=True, slots=True)
class Answer:
    """One answer, not yet checked, whose first byte came when it `began` [s, monotonic].

    Its `lines` have no LF; there is at least one, and none is empty.
    """

    lines: list[bytes]
    began: float

    def after(self, command: bytes) -> "Answer | None":
        """Return the answer to `command` with all before its echo cut off; `None` without one.

        An echo behind noise counts too, if there is no other.
        """
        lines = self.lines
        found = [number for number, line in enumerate(lines) if line == command] or [
            number for number, line in enumerate(lines) if line.endswith(command)
        ]
        return Answer([command, *lines[found[-1] + 1 :]], self.began) if found else None

    @property
    def status(self) -> str:
        """The status without its checksum: two characters, in SCIP 1.1 one; empty if it is wrong.

        A 1.1 answer has no checksum at all (scip.md 1.5).
        """
        line = self.lines[1] if len(self.lines) > 1 else b""
        text = line if len(line) == 1 else unseal(line) if len(line) == 3 else None
        return text.decode() if text and text.isalnum() and text.isascii() else ""


def checksum(text: bytes) -> int:
    """Return the character that follows `text`."""
    total = sum(text) if len(text) > LINE else adler32(text, 0)  # a sum modulo 65521, much faster
    return (total & 0x3F) + ZERO


def seal(text: bytes) -> bytes:
    """Return `text` with its checksum."""
    return text + bytes((checksum(text),))


def unseal(line: bytes) -> bytes | None:
    """Return `line` without its checksum, or `None` if that is wrong."""
    return line[:-1] if len(line) > 1 and checksum(line[:-1]) == line[-1] else None


def encode_values(values: Sequence[int], width: int) -> bytes:
    """Return each of `values` as `width` characters of six bits, the highest first."""
    numbers = array("I", values)
    if byteorder == "little":
        numbers.byteswap()
    words, low = numbers.tobytes(), bytearray(3 * len(values))
    for place in range(3):
        low[place::3] = words[place + 1 :: 4]
    fours = b2a_base64(low, newline=False).translate(FROM_BASE64)
    text = bytearray(width * len(values))
    for place in range(width):
        text[place::width] = fours[4 - width + place :: 4]
    return bytes(text)


def decode_values(text: bytes, width: int) -> list[int]:
    """Return the numbers in `text`, whose characters and length have been checked."""
    count = len(text) // width
    fours, words = bytearray(ALPHABET[:1] * 4 * count), bytearray(4 * count)
    for place in range(width):
        fours[4 - width + place :: 4] = text[place::width]
    low = a2b_base64(fours.translate(TO_BASE64))
    for place in range(3):
        words[place + 1 :: 4] = low[place::3]
    return [*unpack(f">{count}I", words)]


def decode_stamp(line: bytes) -> int | None:
    """Return the milliseconds of a time stamp's line, or `None` if it is spoilt."""
    text = unseal(line)
    if text is None or len(text) != STAMP or text.translate(None, ALPHABET):
        return None
    return decode_values(text, STAMP)[0]


def to_lines(text: bytes) -> bytes:
    """Return data as lines with checksums and LF."""
    pieces = [text[start : start + LINE] for start in range(0, len(text), LINE)]
    return b"".join([b"%b%c\n" % (piece, checksum(piece)) for piece in pieces])


def from_lines(lines: Sequence[bytes], others: bytes = b"") -> bytes | None:
    """Return the data of `lines`, or `None` if any of them is spoilt.

    The checksum counts six bits. An error in the other two shows in a character that is none of
    SCIP's 64, and none of `others`.
    """
    if not {*map(len, lines[:-1])} <= {LINE + 1}:
        return None
    texts = [line[:-1] for line in lines]
    sums = bytes(map(checksum, texts))
    if sums != b"".join([line[-1:] for line in lines]):
        return None
    text = b"".join(texts)
    return None if text.translate(None, ALPHABET + others) else text


def from_plain_lines(lines: Sequence[bytes]) -> bytes | None:
    """Return the data of SCIP 1.1's lines, which have no checksums, or `None`."""
    if any(len(line) != LINE for line in lines[:-1]):
        return None
    text = b"".join(lines)
    return None if text.translate(None, ALPHABET) else text


def pair(key: str, value: object) -> bytes:
    """Return a line of VV, PP or II, with LF."""
    text = f"{key}:{value}".encode("ascii")
    return text + b";" + bytes((checksum(text),)) + b"\n"


def from_pairs(lines: Iterable[bytes], *, summed: bool = True) -> dict[str, str] | None:
    """Return the keys and values of `KEY:value;c` lines, or `None` if any of them is spoilt.

    Some lasers count the semicolon into the checksum. Without `summed`, as in SCIP 1.1, there may
    be neither.
    """
    pairs: dict[str, str] = {}
    for line in lines:
        text, mark = line[:-2], line[-2:-1]
        if mark != b";" and not summed:
            text = line
        elif mark != b";" or line[-1] not in {checksum(text), checksum(text + mark)}:
            return None
        key, colon, value = text.decode("latin-1").partition(":")
        if not (colon and key.isupper() and key.isascii() and value.isprintable()):
            return None
        pairs[key] = value
    return pairs


class AnswerReader:
    """Cuts a stream of bytes, in any pieces, into answers. Noise is neither raised nor kept."""

    def __init__(self) -> None:
        self._buffer = bytearray()
        self._began = 0.0
        self._return_held = False

    def discard(self) -> None:
        """Forget an answer that has begun."""
        self._buffer.clear()
        self._return_held = False

    def began(self, command: bytes) -> float | None:
        """Return when the answer to `command` began [s, monotonic], or `None` without one."""
        return self._began if self._buffer.startswith(command) else None

    def feed(self, data: bytes, now: float) -> list[Answer]:
        """Add bytes received at `now` [s, monotonic]; return the answers that they complete."""
        data = self._without_returns(data)
        buffer = self._buffer
        if not buffer:
            data = data.lstrip(b"\n")
            self._began = now
        searched = max(len(buffer) - 1, 0)
        buffer += data
        if buffer.find(ENDED, searched) < 0:
            self._limit()
            return []
        *complete, rest = bytes(buffer).split(ENDED)
        self._buffer = bytearray(rest.lstrip(b"\n"))
        answers = []
        for block in complete:
            if text := block.lstrip(b"\n"):
                answers.append(Answer(text.split(b"\n"), self._began))
            self._began = now
        self._limit()
        return answers

    def _without_returns(self, data: bytes) -> bytes:
        """Make CR LF to LF; a CR at the end waits for its LF."""
        if self._return_held:
            data = b"\r" + data
        self._return_held = data.endswith(b"\r")
        return data.removesuffix(b"\r").replace(b"\r\n", b"\n") if b"\r" in data else data

    def _limit(self) -> None:
        if len(self._buffer) > MAX_ANSWER:
            self._buffer.clear()
