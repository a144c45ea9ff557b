"""How well the pings of sonars fit the walls of a map."""

from math import cos, exp, floor, log, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from pioneer3.jit import kernel
from pioneer3.nav.kernels.scans import way_to_wall

Float = NDArray[np.float64]
Float32 = NDArray[np.float32]
Int32 = NDArray[np.int32]


@kernel
def expected_ranges(
    walls: Float,
    distances: Float32,
    numbers: Int32,
    frame: tuple[float, float, float],
    pings: Float,
    rays: Float,
    poses: Float,
    limits: tuple[float, float],
    out: Float,
) -> None:
    """Fill `out` (P, N) with the ranges that pings are expected to have at each of `poses`.

    The nearest echo among the rays of a beam counts. A wall echoes a ray that meets it nearly at a
    right angle.

    Args:
        walls: Segments [m], shape (W, 4).
        distances: To the nearest wall [m], shape (H, W).
        numbers: The wall nearest to each cell, shape (H, W).
        frame: Left and lower edge of the raster, and the side of a cell [m].
        pings: Places of the transducers in the robot's frame, x, y, axis [m, rad], shape (N, 3+).
        rays: Angles off the axis [rad], shape (R,).
        poses: Of the robot on the map [m, rad], shape (P, 3).
        limits: Longest range [m]; least cosine between a ray and a wall's normal.
        out: For the ranges [m]; twice the longest where no echo is expected.
    """
    x0, y0, cell = frame
    longest, steep = limits
    height, width = numbers.shape
    for p in range(len(poses)):
        c, s = cos(poses[p, 2]), sin(poses[p, 2])
        for i in range(len(pings)):
            x = poses[p, 0] + c * pings[i, 0] - s * pings[i, 1]
            y = poses[p, 1] + s * pings[i, 0] + c * pings[i, 1]
            best = 2.0 * longest
            for ray in range(len(rays)):
                angle = poses[p, 2] + pings[i, 2] + rays[ray]
                dx, dy = cos(angle), sin(angle)
                u, v = (x - x0) / cell, (y - y0) / cell
                most = min(best, longest) / cell
                gone = way_to_wall(distances, u, v, dx, dy, most, 1.0 / cell)
                if gone >= most:
                    continue
                row, column = floor(v + gone * dy), floor(u + gone * dx)
                if not (0 <= row < height and 0 <= column < width):
                    continue
                wall = numbers[row, column]
                if wall < 0:
                    continue
                wx, wy = walls[wall, 2] - walls[wall, 0], walls[wall, 3] - walls[wall, 1]
                length = sqrt(wx * wx + wy * wy)
                if length <= 0.0 or abs(wx * dy - wy * dx) < steep * length:
                    continue
                # to the wall itself: the way along the ray ends up to a cell before it
                across = (wx * (walls[wall, 1] - y) - wy * (walls[wall, 0] - x)) / (
                    wx * dy - wy * dx
                )
                if abs(across - gone * cell) > 2.0 * cell:
                    across = gone * cell
                best = min(best, across)
            out[p, i] = best


@kernel
def weigh_ranges(ranges: Float, expected: Float, shape: Float, out: Float) -> None:
    """Fill `out` (P,) with the negative logarithm of the likelihood of `ranges` (N,).

    Args:
        ranges: Measured [m]; above the longest where nothing echoed.
        expected: The same as expected at each pose, shape (P, N).
        shape: Longest range [m]; standard deviation [m], and as a share of the range; chances that
            a reading is right, that something nearer echoes, and that it is none of the two.
        out: For the sums.
    """
    longest, sigma, share, right, nearer, other = (
        shape[0],
        shape[1],
        shape[2],
        shape[3],
        shape[4],
        shape[5],
    )
    for p in range(len(expected)):
        total = 0.0
        for i in range(len(ranges)):
            measured, wanted = ranges[i], expected[p, i]
            chance = other
            if measured > longest:
                chance += right if wanted > longest else 0.5 * nearer
            else:
                if wanted <= longest:
                    spread = sigma + share * wanted
                    off = (measured - wanted) / spread
                    chance += right * exp(-0.5 * off * off)
                if measured < wanted:
                    chance += nearer
            total -= log(chance)
        out[p] = total
