# ruff: noqa: PLR0917 (compiled functions take no keywords without a cost)
"""Spots of a laser: the reading that three rays give, and its errors."""

from math import inf, sqrt

import numpy as np

from pioneer3.arrays import Bool, Float, UInt8
from pioneer3.jit import kernel

EDGE = 0.05
"""The three ranges of a spot are of one surface if they fit a straight wall this well [m]."""
SLANT_NOISE = 1 / 8
"""Standard deviation of a reading, as a share of the depth of a slanted surface in the spot."""
TOUCHING = 1e-3
"""No range that something is divided by is shorter [m]."""


@kernel
def spots(
    rays: tuple[Float, UInt8],
    layout: tuple[int, int, float, float, float],
    light: tuple[float, float, float],
    surfaces: tuple[Float, Bool],
    errors: tuple[Float, float, float],
    chance: tuple[Float, Float],
    out: Float,
) -> None:
    """Fill the rows of `out` with a turn's readings: range [m] and intensity, `inf` and 0 if none.

    `rays` are ranges and materials at all rays of the turn; `layout` is how many rays a reading has
    to itself and how many there are aside of the first one, the angle between two [rad], and the
    divergence [rad] and size at the laser [m] of the light. `light` are the longest range, that to
    dark surfaces, and their remission; `surfaces` the remission of each material, and whether it is
    matt. `errors` are the bands of the laser's model, shape (4, K), the unit's share of the
    systematic error, and the share of the noise; `chance` are a uniform and a normal number for
    each reading.

    The inverse range along a straight wall is nearly linear in the angle. Where two surfaces share
    a spot, the nearer one wins if it fills half of it, or if there is nothing behind; else the
    reading is anywhere between the two. Slants are of a surface; between two there is none.
    """
    ranges, codes = rays
    per_step, most, apart, divergence, size = layout
    far, dark, reference = light
    remission, matt = surfaces
    bands, lasting, noise = errors
    shares, normals = chance
    for i in range(out.shape[1]):
        middle = most + per_step * i
        found = middle_range = ranges[middle]
        code, spread, lit = codes[middle], 0.0, 1.0
        if most:
            half = (divergence + size / max(middle_range, TOUCHING)) / 2
            aside = min(max(int(np.rint(half / apart)), 1), most)
            right, left = ranges[middle - aside], ranges[middle + aside]
            misfit = 2 / max(middle_range, TOUCHING) - 1 / max(right, TOUCHING)
            misfit -= 1 / max(left, TOUCHING)
            if abs(misfit) * (middle_range * middle_range) > EDGE:
                near = min(middle_range, right, left)
                behind = max(middle_range, right, left)
                half = (behind - near) / 2
                filled = (right - near <= half) + (left - near <= half)
                if middle_range - near <= half:
                    near, filled = middle_range, filled + 1
                elif right <= left:
                    code = codes[middle - aside]
                else:
                    code = codes[middle + aside]
                found = near
                if filled == 1 and behind < far:
                    found = near + shares[i] * (behind - near)
            else:
                spread = abs(left - right)
                tangent = (left - right) / (2 * aside * apart * max(middle_range, TOUCHING))
                lit = 1 / sqrt(1.0 + tangent * tangent)
        intensity = remission[code] * (lit if matt[code] else 1.0)
        if found >= far or found > dark * sqrt(intensity / reference):
            out[0, i], out[1, i] = inf, 0.0
            continue
        band = 0
        while band < bands.shape[1] - 1 and bands[0, band] < found:
            band += 1
        systematic = lasting * (bands[1, band] + bands[2, band] * found)
        if noise:
            sigma, slanted = bands[3, band] * noise, SLANT_NOISE * spread
            found += sqrt(sigma * sigma + slanted * slanted) * normals[i]
        out[0, i], out[1, i] = max(found + systematic, 0.0), intensity
