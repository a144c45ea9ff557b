"""Reads and writes PGM pictures: P2 (text) and P5 (binary), 8 and 16 bit."""

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.maps.image import Bytes, Image, bad_image, check_size

_GAP = rb"(?:\s|#[^\n]*\n)+"
_HEADER = re.compile(
    rb"P([25])" + _GAP + rb"(\d{1,9})" + _GAP + rb"(\d{1,9})" + _GAP + rb"(\d{1,9})(?=\s|#|$)"
)
_COMMENT = re.compile(rb"#[^\n]*")
_TEXT = b"0123456789 \t\n\v\f\r"
LARGEST_TEXT = 32 << 20
"""Of the pixels of a P2 picture [bytes]; reading takes several times as much."""
MOST_DIGITS = 6
"""Of a number in a P2 picture; more is no shade."""


def parse_pgm(path: Path, raw: bytes) -> Image:
    """Read the bytes of a picture file; shades of any depth are scaled to 0 to 255.

    Raises:
        ConfigError: It is none, or cut off.
    """
    header = _HEADER.match(raw)
    if header is None:
        raise bad_image(path, "header", "expected P2 or P5, width, height and largest shade")
    kind, width, height, largest = (int(number) for number in header.groups())
    check_size(path, width, height)
    if not 1 <= largest <= 65535:
        raise bad_image(path, "largest shade", f"{largest} is not in 1 to 65535")
    body = raw[header.end() :]
    read = _plain if kind == 2 else _binary
    values = read(path, body, width * height, largest)
    if values.max() > largest:
        raise bad_image(path, "pixels", f"{values.max()} is above the largest shade {largest}")
    if largest != 255:
        values = (values.astype(np.uint32) * 255 + largest // 2) // largest
    return Image(values.astype(np.uint8).reshape(height, width))


def to_pgm(shades: Bytes) -> bytes:
    """Return `shades` (H, W), row 0 the top, as an 8-bit binary picture."""
    height, width = shades.shape
    return b"P5\n%d %d\n255\n" % (width, height) + shades.tobytes()


def _binary(
    path: Path, body: bytes, count: int, largest: int
) -> NDArray[np.uint8] | NDArray[np.uint16] | NDArray[np.uint32]:
    size = 1 if largest < 256 else 2
    # one blank parts the header from the pixels
    pixels = body[1 : 1 + count * size]
    if len(pixels) < count * size:
        there = len(pixels) // size
        raise bad_image(path, "pixels", f"{there} of {count} are there; the file is cut off")
    if size == 1:
        return np.frombuffer(pixels, dtype=np.uint8)
    return np.frombuffer(pixels, dtype=">u2").astype(np.uint16)


def _plain(
    path: Path, body: bytes, count: int, largest: int
) -> NDArray[np.uint8] | NDArray[np.uint16] | NDArray[np.uint32]:
    if len(body) > LARGEST_TEXT:
        most = f"{LARGEST_TEXT >> 20} MB"
        raise bad_image(path, "pixels", f"more than {most} of text; save it as P5, or PNG")
    text = _COMMENT.sub(b"", body)
    if text.translate(None, _TEXT):
        raise bad_image(path, "pixels", "not all are whole numbers")
    if re.search(rb"\d{%d}" % (MOST_DIGITS + 1), text):
        raise bad_image(path, "pixels", f"a number is above the largest shade {largest}")
    values = np.fromstring(text.decode("ascii"), dtype=np.uint32, sep=" ")
    if len(values) < count:
        raise bad_image(path, "pixels", f"{len(values)} of {count} are there; the file is cut off")
    return values[:count]
