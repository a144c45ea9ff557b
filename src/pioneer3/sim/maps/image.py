"""A picture of a map in memory, and what both readers of picture files need."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pioneer3.errors import ConfigError
from pioneer3.sim.maps.text import wrong

Bytes = NDArray[np.uint8]

LARGEST_IMAGE = 128 * 1024 * 1024
"""Larger picture files are not read [bytes]."""
MOST_PIXELS = 1 << 25
"""Larger pictures are refused before memory is taken: 5792 x 5792, 290 m at 5 cm."""


@dataclass(frozen=True, slots=True, eq=False)
class Image:
    """Pixels; row 0 is the top.

    Attributes:
        shades: 0 black to 255 white, colours averaged, shape (H, W).
        alpha: 0 transparent to 255 opaque, same shape; `None` where all are opaque.
    """

    shades: Bytes
    alpha: Bytes | None = None


def bad_image(path: Path, field: str, problem: str) -> ConfigError:
    """Return a one-line error about a picture file."""
    return wrong(path, f" {field}: {problem}")


def check_size(path: Path, width: int, height: int) -> None:
    """Refuse a picture without pixels or with more than anybody means.

    Raises:
        ConfigError: It is one.
    """
    if not width or not height:
        raise bad_image(path, "size", f"{width} x {height} pixels is no picture")
    if width * height > MOST_PIXELS:
        most = f"{MOST_PIXELS / 1e6:.0f} million"
        raise bad_image(path, "size", f"{width} x {height} pixels are more than {most}")
