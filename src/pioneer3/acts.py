"""The protocol of ACTS, ARIA's colour tracker, without I/O: blobs of colour in a camera's picture.

A client connects (port 5001), asks for one picture with the byte `0`, gets one, and asks again; the
byte `1` asks ACTS to quit. A picture is a header, then its blobs, by channel. Each byte holds six
bits of a number, the highest first, plus one, so that none is 0:

======  ==================================================  ============
part    fields                                              bytes
======  ==================================================  ============
header  32 times: index of the first blob, number of blobs  2, 2
blob    area; x, y, left, right, top, bottom                4; 2 each
======  ==================================================  ============

This is the format of ACTS 1.2 and 2.0. Sources, which agree: ARIA's `ArACTS_1_2` and Player's
driver `acts`. Pixels count from the upper left corner; the size of the picture is not sent.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

PORT: Final = 5001
REQUEST, QUIT = b"0", b"1"
CHANNELS: Final = 32
MOST_BLOBS: Final = 10
"""Most blobs in one channel."""
DIGIT, BASE = 6, 64
HEADER_SIZE, BLOB_SIZE = 4 * CHANNELS, 16
LONGEST: Final = HEADER_SIZE + CHANNELS * MOST_BLOBS * BLOB_SIZE


@dataclass(frozen=True, slots=True, kw_only=True)
class Blob:
    """A patch of one colour [pixels]: area, centre of gravity, first and last column and row."""

    area: int
    x: int
    y: int
    left: int
    right: int
    top: int
    bottom: int


@dataclass(frozen=True, slots=True)
class BlobPicture:
    """The blobs of one picture; `channels[0]` are those of channel 1, the largest first."""

    channels: tuple[tuple[Blob, ...], ...]

    def channel(self, number: int) -> tuple[Blob, ...]:
        """Return the blobs of channel `number`, 1 to 32."""
        return self.channels[number - 1]


def encode(blobs: Mapping[int, Sequence[Blob]]) -> bytes:
    """Return the bytes of a picture with `blobs` by channel, 1 to 32; the ten largest of each."""
    header, body, index = b"", b"", 0
    for channel in range(1, CHANNELS + 1):
        shown = sorted(blobs.get(channel, ()), key=lambda blob: -blob.area)[:MOST_BLOBS]
        header += _digits(index, 2) + _digits(len(shown), 2)
        index += len(shown)
        for blob in shown:
            body += _digits(blob.area, 4)
            for edge in (blob.x, blob.y, blob.left, blob.right, blob.top, blob.bottom):
                body += _digits(edge, 2)
    return header + body


class PictureReader:
    """Parses the bytes of a server, in chunks of any size, into pictures."""

    def __init__(self) -> None:
        self._waiting = bytearray()

    def feed(self, data: bytes) -> list[BlobPicture]:
        """Return the pictures that `data` completes.

        Raises:
            ValueError: the bytes are not those of ACTS 1.2 or 2.0.
        """
        self._waiting += data
        pictures = []
        while len(self._waiting) >= HEADER_SIZE:
            spans = [
                (_number(self._waiting[at : at + 2]), _number(self._waiting[at + 2 : at + 4]))
                for at in range(0, HEADER_SIZE, 4)
            ]
            size = HEADER_SIZE + BLOB_SIZE * sum(count for _, count in spans)
            if size > LONGEST:
                raise ValueError(f"a picture of {size} bytes is longer than {LONGEST}")
            if len(self._waiting) < size:
                break
            pictures.append(_picture(bytes(self._waiting[HEADER_SIZE:size]), spans))
            del self._waiting[:size]
        return pictures


def _picture(body: bytes, spans: Sequence[tuple[int, int]]) -> BlobPicture:
    blobs = [_blob(body[at : at + BLOB_SIZE]) for at in range(0, len(body), BLOB_SIZE)]
    if any(first + count > len(blobs) for first, count in spans if count):
        raise ValueError("a channel has blobs that are not there")
    return BlobPicture(tuple(tuple(blobs[first : first + count]) for first, count in spans))


def _blob(data: bytes) -> Blob:
    x, y, left, right, top, bottom = (_number(data[at : at + 2]) for at in range(4, BLOB_SIZE, 2))
    area = _number(data[:4])
    return Blob(area=area, x=x, y=y, left=left, right=right, top=top, bottom=bottom)


def _digits(value: int, count: int) -> bytes:
    """Return `value` in `count` digits, bounded by the largest number."""
    bounded = max(0, min(BASE**count - 1, value))
    shifts = range(DIGIT * (count - 1), -1, -DIGIT)
    return bytes((bounded >> shift) % BASE + 1 for shift in shifts)


def _number(digits: bytes | bytearray) -> int:
    value = 0
    for digit in digits:
        if not 1 <= digit <= BASE:
            raise ValueError(f"the byte {digit:#04x} is not a digit of ACTS")
        value = value << DIGIT | digit - 1
    return value
