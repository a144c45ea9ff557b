"""The materials of walls and boxes, as lasers see them; sonars and bodies meet all of them alike.

Remission is the share of its light that a laser gets back, 1 for a perfect matt white surface. The
values are typical ones of SICK's tables (docs/explanation/realism.md, "Range finders").
"""

from collections.abc import Iterable
from enum import StrEnum
from math import radians

import numpy as np

from pioneer3.arrays import Float, UInt8

Codes = UInt8


class Material(StrEnum):
    """The material of a wall."""

    PLAIN = "plain"
    BLACK = "black"
    GLASS = "glass"
    REFLECTOR = "reflector"


MATERIALS = tuple(Material)
"""A material's code is its place here; 0 is plain."""
PLAIN, BLACK, GLASS, REFLECTOR = range(len(MATERIALS))

REMISSION: Float = np.array([0.8, 0.024, 0.5, 10.0])
"""By code: white paper, black foam rubber, a pane seen from in front, reflective tape."""
MATT = np.array([True, True, False, False])
"""By code: whether oblique light comes back weaker, by the cosine (Lambert's law)."""
REFERENCE = 0.1
"""The remission that makers give the range to dark surfaces for."""

GLASS_ANGLE = radians(5)
"""Glass returns light to a laser within this of its normal, and lets the rest through [rad]."""


def codes_of(materials: Iterable[Material]) -> Codes:
    """Return the codes of materials, shape (N,)."""
    return np.array([MATERIALS.index(material) for material in materials], dtype=np.uint8)
