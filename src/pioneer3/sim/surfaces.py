"""Walls of other materials than plain ones, and the glass among them. Arrays in, arrays out.

There are few of them, so each ray is compared with each: kernels know of no materials. They cast
rays among all that is not glass; then the glass that a ray meets nearly at a right angle is put in
front, and rays that end on a black wall or a reflector are found by their range.
"""

from dataclasses import dataclass
from math import cos

import numpy as np
from numpy.typing import NDArray

from pioneer3.maps.materials import GLASS, GLASS_ANGLE, PLAIN, Codes
from pioneer3.sim.raycast import ranges_reference

Float = NDArray[np.float64]

SAME = 1e-5
"""A range this close to that of a wall is its range; above the error of the kernels [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class Surfaces:
    """Walls that are not plain.

    Attributes:
        walls: Segments [m], shape (S, 4).
        codes: Their materials, shape (S,).
    """

    walls: Float
    codes: Codes

    @classmethod
    def among(cls, walls: Float, codes: Codes) -> "Surfaces":
        """Return those of `walls` (W, 4) with `codes` (W,) that are not plain."""
        special = codes != PLAIN
        return cls(walls[special], codes[special])

    @property
    def has_glass(self) -> bool:
        """Whether any wall is of glass."""
        return bool((self.codes == GLASS).any())

    def joined(self, others: "Surfaces") -> "Surfaces":
        """Return these walls and then the others."""
        walls = np.concatenate([self.walls, others.walls])
        return Surfaces(walls, np.concatenate([self.codes, others.codes]))

    def seen(self, origin: Float, angles: Float, ranges: Float) -> tuple[Float, Codes]:
        """Return the range and the material that each ray ends at.

        Args:
            origin: Of all rays [m], shape (2,).
            angles: Of the rays [rad], shape (B,).
            ranges: To the nearest wall or robot that is not of glass [m], shape (B,).

        Returns:
            Ranges [m], glass included, and codes of the materials, both of shape (B,).
        """
        codes = np.full(len(angles), PLAIN, dtype=np.uint8)
        if not len(self.walls):
            return ranges, codes
        limit = float(ranges.max(initial=0.0)) + 1.0
        alone = ranges_reference(origin, angles, self.walls, limit)
        glass = self.codes == GLASS
        if glass.any():
            alone[:, glass] = np.where(self._in_front(angles, glass), alone[:, glass], limit)
        nearest = alone.argmin(axis=1)
        first = alone[np.arange(len(angles)), nearest]
        met = first <= ranges + SAME
        codes[met] = self.codes[nearest[met]]
        return np.minimum(ranges, first), codes

    def _in_front(self, angles: Float, some: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Return whether each ray looks at `some` of the walls nearly at a right angle."""
        extents = self.walls[some, 2:] - self.walls[some, :2]
        along = np.arctan2(extents[:, 1], extents[:, 0])
        # the sine of the angle between ray and wall is the cosine of that to the normal
        near: NDArray[np.bool_] = abs(np.sin(angles[:, None] - along)) >= cos(GLASS_ANGLE)
        return near


def opaque(walls: Float, codes: Codes) -> Float:
    """Return those of `walls` (W, 4) with `codes` (W,) that are not of glass."""
    kept: Float = walls[codes != GLASS]
    return kept


NO_SURFACES = Surfaces(np.empty((0, 4)), np.empty(0, dtype=np.uint8))
