"""Numbers and pieces of XML that all three formats of a description write in the same way."""

from collections.abc import Mapping
from math import cos, sin
from types import MappingProxyType
from typing import Final
from xml.etree import ElementTree as ET

MAKER: Final = "Drawn by pioneer3 from the robot's model."
"""In every description of ours, and in no other."""
AXES: Final[Mapping[str, str]] = MappingProxyType({"y": "0 1 0", "z": "0 0 1"})
"""Axes of joints that turn."""


def row(*numbers: float) -> str:
    """Return numbers with six digits and no more than six places, which makes the text stable."""
    return " ".join(f"{round(number, 6) + 0.0:.6g}" for number in numbers)


def document(root: ET.Element) -> str:
    """Return the text of a document, indented."""
    ET.indent(root)
    return '<?xml version="1.0"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def quaternion(roll: float, pitch: float, yaw: float) -> tuple[float, float, float, float]:
    """Return w, x, y, z of turns about the fixed axes x, y and z, in that order [rad]."""
    (cr, sr), (cp, sp), (cy, sy) = ((cos(a / 2), sin(a / 2)) for a in (roll, pitch, yaw))
    return (
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    )
