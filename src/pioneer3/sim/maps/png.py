"""Reads and writes PNG pictures (ISO/IEC 15948): all colour types and depths, no interlacing."""

import zlib
from dataclasses import dataclass
from pathlib import Path
from struct import pack, unpack

import numpy as np

from pioneer3.sim.maps.image import Bytes, Image, bad_image, check_size

SIGNATURE = b"\x89PNG\r\n\x1a\n"
LARGEST_UNPACKED = 64 << 20
"""Of the pixels [bytes]: a small file may hold gigabytes."""
_CHANNELS = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}
"""Of each colour type."""
_DEPTHS = {0: (1, 2, 4, 8, 16), 2: (8, 16), 3: (1, 2, 4, 8), 4: (8, 16), 6: (8, 16)}
_GRAY, _PALETTE = (0, 4), 3
_NONE, _SUB, _UP, _AVERAGE, _PAETH = range(5)


@dataclass(frozen=True, slots=True)
class _Header:
    width: int
    height: int
    depth: int
    colour: int

    @property
    def channels(self) -> int:
        return _CHANNELS[self.colour]

    @property
    def stride(self) -> int:
        """Bytes of a row, its filter left out."""
        return (self.width * self.channels * self.depth + 7) // 8

    @property
    def step(self) -> int:
        """Bytes from a pixel to the next, at least one."""
        return max(1, self.channels * self.depth // 8)


def parse_png(path: Path, raw: bytes) -> Image:
    """Read the bytes of a picture file; colours are averaged, depths scaled to 8 bit.

    Raises:
        ConfigError: It is none, damaged, interlaced or too large.
    """
    chunks = _chunks(path, raw)
    if not chunks or chunks[0][0] != b"IHDR" or len(chunks[0][1]) != 13:
        raise bad_image(path, "IHDR", "a PNG starts with its size")
    header = _header(path, chunks[0][1])
    palette = next((data for name, data in chunks if name == b"PLTE"), b"")
    packed = b"".join(data for name, data in chunks if name == b"IDAT")
    pixels = _pixels(header, _unfiltered(path, header, _unpacked(path, header, packed)))
    if header.colour == _PALETTE:
        pixels = _coloured(path, pixels[:, :, 0], palette)
    alpha = pixels[:, :, -1] if header.channels in (2, 4) else None
    colours = pixels[:, :, : 1 if header.colour in _GRAY else 3]
    if colours.shape[2] == 1:
        return Image(colours[:, :, 0], alpha)
    total = colours[:, :, 0].astype(np.uint16) + colours[:, :, 1] + colours[:, :, 2]
    return Image(((total + 1) // 3).astype(np.uint8), alpha)


def to_png(pixels: Bytes) -> bytes:
    """Return 8-bit `pixels`, row 0 the top, as a picture file.

    Shape (H, W, 3) is red, green, blue; shape (H, W) is grey.
    """
    height, width = pixels.shape[:2]
    grey = pixels.ndim == 2
    rows = np.zeros((height, 1 + (1 if grey else 3) * width), dtype=np.uint8)
    rows[:, 1:] = pixels.reshape(height, -1)
    parts = (
        (b"IHDR", pack(">IIBBBBB", width, height, 8, 0 if grey else 2, 0, 0, 0)),
        (b"IDAT", zlib.compress(rows.tobytes(), 9)),
        (b"IEND", b""),
    )
    return SIGNATURE + b"".join(
        pack(">I", len(data)) + name + data + pack(">I", zlib.crc32(name + data))
        for name, data in parts
    )


def _chunks(path: Path, raw: bytes) -> list[tuple[bytes, bytes]]:
    found: list[tuple[bytes, bytes]] = []
    at = len(SIGNATURE)
    while at + 12 <= len(raw):
        (length,) = unpack(">I", raw[at : at + 4])
        name, data = raw[at + 4 : at + 8], raw[at + 8 : at + 8 + length]
        check = raw[at + 8 + length : at + 12 + length]
        if check != pack(">I", zlib.crc32(name + data)):
            raise bad_image(path, ascii(name.decode("latin-1")), "damaged or cut off")
        found.append((name, data))
        at += 12 + length
        if name == b"IEND":
            return found
    raise bad_image(path, "IEND", "missing; the file is cut off")


def _header(path: Path, data: bytes) -> _Header:
    width, height, depth, colour, compression, filters, interlace = unpack(">IIBBBBB", data)
    check_size(path, width, height)
    if depth not in _DEPTHS.get(colour, ()):
        raise bad_image(path, "IHDR", f"colour type {colour} with {depth} bits does not exist")
    if compression or filters:
        raise bad_image(path, "IHDR", "unknown compression or filter method")
    if interlace:
        raise bad_image(path, "IHDR", "interlaced; save it without interlacing")
    header = _Header(width, height, depth, colour)
    if height * header.stride > LARGEST_UNPACKED:
        most = f"{LARGEST_UNPACKED >> 20} MB"
        raise bad_image(path, "IHDR", f"more than {most} unpacked; save it with 8 bit grey")
    return header


def _unpacked(path: Path, header: _Header, packed: bytes) -> Bytes:
    """Return the rows, each behind its filter, shape (H, 1 + stride)."""
    size = header.height * (1 + header.stride)
    try:
        # no more than a picture of this size has, whatever the stream holds
        data = zlib.decompressobj().decompress(packed, size)
    except zlib.error as error:
        raise bad_image(path, "IDAT", f"damaged: {error}") from None
    if len(data) < size:
        raise bad_image(path, "IDAT", f"{len(data)} of {size} bytes are there; it is cut off")
    return np.frombuffer(data, dtype=np.uint8).reshape(header.height, -1)


def _unfiltered(path: Path, header: _Header, rows: Bytes) -> Bytes:
    """Undo the five filters (section 9): each byte adds up with those left, above and above left.

    Along an anti-diagonal nothing depends on each other, so whole ones are computed at once.

    Returns:
        The bytes of the pixels, shape (H, stride).
    """
    filters = rows[:, 0]
    if filters.max() > _PAETH:
        raise bad_image(path, "IDAT", f"unknown filter {filters.max()}")
    height, step = header.height, header.step
    width = header.stride // step
    if not filters.any():
        return rows[:, 1:]
    given = np.ascontiguousarray(rows[:, 1:]).reshape(height * width, step)
    # a row and a column of zeros before the first
    out = np.zeros((height + 1, width + 1, step), dtype=np.uint8)
    flat = out.reshape(-1, step)
    for diagonal in range(height + width - 1):
        first, last = max(0, diagonal - width + 1), min(height - 1, diagonal)
        count = last - first + 1
        at = (first + 1) * (width + 1) + diagonal - first + 1
        here = _along(at, count, width)
        left, above = flat[_along(at - 1, count, width)], flat[_along(at - width - 1, count, width)]
        corner = flat[_along(at - width - 2, count, width)]
        kinds = filters[first : last + 1, None]
        source = first * width + diagonal - first
        flat[here] = given[_along(source, count, width - 1)] + _predicted(
            kinds, left, above, corner
        )
    return out[1:, 1:].reshape(height, header.stride)


def _along(start: int, count: int, step: int) -> slice:
    return slice(start, start + (count - 1) * step + 1, max(1, step))


def _predicted(kinds: Bytes, left: Bytes, above: Bytes, corner: Bytes) -> Bytes:
    a, b, c = left.astype(np.int16), above.astype(np.int16), corner.astype(np.int16)
    p = a + b - c
    pa, pb, pc = abs(p - a), abs(p - b), abs(p - c)
    paeth = np.where((pa <= pb) & (pa <= pc), a, np.where(pb <= pc, b, c))
    chosen = np.select(
        [kinds == _SUB, kinds == _UP, kinds == _AVERAGE, kinds == _PAETH],
        [a, b, (a + b) // 2, paeth],
        np.int16(0),
    )
    return chosen.astype(np.uint8)


def _pixels(header: _Header, rows: Bytes) -> Bytes:
    """Return samples of 8 bit, shape (H, W, channels); of a palette the indices."""
    shape = (header.height, header.width, header.channels)
    if header.depth == 8:
        return rows.reshape(shape)
    if header.depth == 16:
        return np.ascontiguousarray(rows.reshape(header.height, -1)[:, ::2]).reshape(shape)
    bits = np.unpackbits(rows, axis=1)[:, : header.width * header.depth]
    parts = bits.reshape(header.height, header.width, header.depth)
    weights = (1 << np.arange(header.depth)[::-1]).astype(np.uint8)
    values = (parts * weights).sum(axis=2, dtype=np.uint8)
    scale = 1 if header.colour == _PALETTE else 255 // ((1 << header.depth) - 1)
    scaled: Bytes = (values * np.uint8(scale)).reshape(shape)
    return scaled


def _coloured(path: Path, indices: Bytes, palette: bytes) -> Bytes:
    if not palette or len(palette) % 3 or len(palette) > 768:
        raise bad_image(path, "PLTE", "missing or of a wrong length")
    colours = np.frombuffer(palette, dtype=np.uint8).reshape(-1, 3)
    if indices.max() >= len(colours):
        raise bad_image(path, "PLTE", f"has no colour {indices.max()}")
    return colours[indices]
