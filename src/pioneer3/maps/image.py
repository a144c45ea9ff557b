"""Pictures of maps: reads the formats of map_server, writes PGM and PNG, with Pillow."""

import re
import struct
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from io import BytesIO
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from pioneer3.arrays import UInt8
from pioneer3.errors import ConfigError
from pioneer3.maps.grid import MOST_CELLS
from pioneer3.text import one_line, read_bytes, wrong

if TYPE_CHECKING:
    from PIL.ImageFile import ImageFile

PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"
PGM_SIGNATURES = (b"P2", b"P5")
SIGNATURES: Mapping[bytes, str] = MappingProxyType(
    {
        PNG_SIGNATURE: "Png",
        **dict.fromkeys((*PGM_SIGNATURES, b"P1", b"P3", b"P4", b"P6"), "Ppm"),
        b"BM": "Bmp",
        b"\xff\xd8\xff": "Jpeg",
        b"II*\0": "Tiff",
        b"MM\0*": "Tiff",
        b"GIF8": "Gif",
    }
)
"""Pillow's names of the formats that map_server reads, by the first bytes of a file; PGM is Ppm."""
LARGEST_IMAGE = 128 << 20
"""Larger picture files are not read [bytes]."""
LARGEST_JPEG = 8 << 20
"""Larger ones are not read [bytes]: Pillow walks over what stands before the picture."""
LONGEST_HEADER = 1 << 16
"""Bytes of a PGM or PPM within which its size is told; Pillow goes over them one by one."""
_PPM_HEADER = re.compile(rb"P\d(?:(?:\s|#[^\n]*\n)+\d+){2}(?:\s|#)")
LARGEST_UNPACKED = 64 << 20
"""Most memory for pixels [bytes]: a small file may hold gigabytes."""
MOST_SLOW_PIXELS = 1 << 22
"""Most pixels of a PGM as text, or with an odd largest shade: Pillow reads a million a second.

Three colours count as three pixels.
"""
_DAMAGED = (
    *(ArithmeticError, AssertionError, EOFError, LookupError, OSError, SyntaxError),
    *(TypeError, ValueError, struct.error),
)
"""Errors of Pillow about bad files."""


@dataclass(frozen=True, slots=True, eq=False)
class ShadeImage:
    """Pixels (H, W), row 0 the top: 0 black to 255 white, colours averaged.

    Their alpha is 0 transparent to 255 opaque; `None` where all are opaque.
    """

    shades: UInt8
    alpha: UInt8 | None = None


def read_image(path: Path, *, reds: bool = False) -> ShadeImage:
    """Read a picture of a format that map_server reads; shades are scaled to 0 to 255.

    With `reds` the shade of a pixel is the red of its colours, not their average.

    Raises:
        ConfigError: The file is no such picture, is damaged, or is too large.
    """
    return parse_image(path, read_bytes(path, LARGEST_IMAGE, "picture"), reds=reds)


def parse_image(path: Path, raw: bytes, *, reds: bool = False) -> ShadeImage:
    """Read the bytes of a picture file; `path` is for messages."""
    kind = next((name for start, name in SIGNATURES.items() if raw.startswith(start)), None)
    if kind is None:
        names = ", ".join(dict.fromkeys(SIGNATURES.values())).upper()
        raise wrong(path, f" header: no picture; PGM, {names} are read")
    if kind == "Jpeg" and len(raw) > LARGEST_JPEG:
        raise wrong(path, f" size: a JPEG of more than {LARGEST_JPEG >> 20} MB; save it as PNG")
    plain = _without_comments(raw)
    if kind == "Ppm" and not _PPM_HEADER.match(plain[:LONGEST_HEADER]):
        raise wrong(path, " header: it does not tell the size of the picture")
    # Pillow's own way to open a file refuses large ones in words of its own
    opened = getattr(import_module(f"PIL.{kind}ImagePlugin"), f"{kind}ImageFile")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # a picture with oddities is read or refused
            if kind == "Png":
                opened(BytesIO(raw)).verify()  # reading alone ignores checksums
            picture: ImageFile = opened(BytesIO(plain))
            _check_size(path, picture)
            picture.load()
            if picture.mode == "F" or (picture.mode == "I" and kind == "Tiff"):
                raise wrong(path, " picture: 32 bit for each pixel; save it with 8 bit grey")
            return _gray(picture, _red if reds else _mean)
    except ConfigError:
        raise
    except _DAMAGED as error:
        raise wrong(path, f" picture: damaged or cut off: {one_line(error)}") from None


def _without_comments(raw: bytes) -> bytes:
    """Return a text picture without comments: Pillow takes long over many of them."""
    if not raw.startswith(b"P2"):
        return raw
    lines = raw.replace(b"\r", b"\n").split(b"\n")
    return b"\n".join(line.partition(b"#")[0] for line in lines)


def _check_size(path: Path, picture: "ImageFile") -> None:
    """Refuse a picture that takes too much memory or time, before its pixels are read."""
    width, height = picture.size
    pixels = width * height
    if pixels > MOST_CELLS:
        most = f"{MOST_CELLS / 1e6:.0f} million"
        raise wrong(path, f" size: {width} x {height} pixels are more than {most}")
    samples = pixels * len(picture.getbands())
    if samples > LARGEST_UNPACKED:
        most = f"{LARGEST_UNPACKED >> 20} MB"
        raise wrong(path, f" size: more than {most} unpacked; save it with 8 bit grey")
    if picture.tile and picture.tile[0][0] in ("ppm", "ppm_plain") and samples > MOST_SLOW_PIXELS:
        most = f"{MOST_SLOW_PIXELS / 1e6:.0f} million"
        advice = "save it as P5 with 255 shades, or PNG"
        raise wrong(path, f" size: more than {most} pixels in this kind of PGM; {advice}")


def _gray(picture: "ImageFile", shade: Callable[[UInt8], UInt8]) -> ShadeImage:
    if picture.mode == "P":
        return ShadeImage(shade(_palette(picture))[np.asarray(picture)])
    if picture.mode in ("1", "PA", "CMYK", "YCbCr", "LAB"):
        pixels = np.asarray(picture.convert("L" if picture.mode == "1" else "RGB"))
    else:
        pixels = np.asarray(picture)
    if pixels.dtype != np.uint8:
        pixels = (pixels >> 8).astype(np.uint8)
    if pixels.ndim == 2:
        return ShadeImage(pixels)
    alpha = pixels[:, :, -1] if pixels.shape[2] in (2, 4) else None
    if pixels.shape[2] == 2:
        return ShadeImage(pixels[:, :, 0], alpha)
    return ShadeImage(shade(pixels), alpha)


def _palette(picture: "ImageFile") -> UInt8:
    """Return the colours that pixels name by number, shape (256, 3)."""
    told = picture.getpalette() or []
    colours = np.zeros(3 * 256, dtype=np.uint8)
    colours[: len(told)] = told[: colours.size]
    return colours.reshape(256, 3)


def _mean(colours: UInt8) -> UInt8:
    """Return the shades of colours, shape (..., 3 or more)."""
    total = colours[..., 0].astype(np.uint16) + colours[..., 1] + colours[..., 2]
    return ((total + 1) // 3).astype(np.uint8)


def _red(colours: UInt8) -> UInt8:
    return colours[..., 0]


def to_png(pixels: UInt8) -> bytes:
    """Return 8-bit `pixels`, row 0 the top, as a PNG file: RGB (H, W, 3), or grey (H, W)."""
    return _written(pixels, "PNG")


def to_pgm(shades: UInt8) -> bytes:
    """Return 8-bit `shades` (H, W), row 0 the top, as a binary PGM file."""
    return _written(shades, "PPM")


def _written(pixels: UInt8, kind: str) -> bytes:
    from PIL.Image import fromarray

    file = BytesIO()
    fromarray(np.ascontiguousarray(pixels)).save(file, kind, optimize=True)
    return file.getvalue()
