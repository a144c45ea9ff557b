"""How well the pings of sonars fit the walls of a map."""

from math import cos, exp, floor, log, pi, sin, sqrt

from pioneer3.arrays import Float, UInt16
from pioneer3.jit import kernel
from pioneer3.nav.kernels.scans import Surface, way_to_wall

Cone = tuple[Float, float, float]
"""Angles of the rays of a beam off its axis [rad], shape (R,); longest range [m]; least cosine
between a ray and the normal of a wall that echoes."""


@kernel
def echo_range(surface: Surface, cone: Cone, x: float, y: float, axis: float) -> float:
    """Return the range that a transducer is expected to have [m]; twice the longest for no echo.

    The nearest echo among the rays of its beam counts. A wall echoes a ray that meets it nearly at
    a right angle. The transducer is at `x`, `y` on the map [m] and looks along `axis` [rad].
    """
    walls, distances, numbers, frame = surface
    x0, y0, cell, _ = frame
    rays, longest, steep = cone
    height, width = numbers.shape
    at = (x - x0) / cell, (y - y0) / cell
    best = 2.0 * longest
    for ray in range(len(rays)):
        dx, dy = cos(axis + rays[ray]), sin(axis + rays[ray])
        most = min(best, longest) / cell
        gone = way_to_wall(distances, at, (dx, dy), most, frame)
        column, row = floor(at[0] + gone * dx), floor(at[1] + gone * dy)
        if gone >= most or not (0 <= row < height and 0 <= column < width):
            continue
        wall = numbers[row, column] - 1
        if wall < 0:
            continue
        wx, wy = walls[wall, 2] - walls[wall, 0], walls[wall, 3] - walls[wall, 1]
        length = sqrt(wx * wx + wy * wy)
        sine = wx * dy - wy * dx
        if length <= 0.0 or abs(sine) < steep * length:
            continue
        # the search ends up to a cell before the wall
        exact = (wx * (walls[wall, 1] - y) - wy * (walls[wall, 0] - x)) / sine
        if abs(exact - gone * cell) > 2.0 * cell:
            exact = gone * cell
        best = min(best, exact)
    return best


@kernel
def expected_ranges(
    surface: Surface,
    cone: Cone,
    memory: tuple[UInt16, float],
    guesses: tuple[Float, Float],
    out: Float,
) -> None:
    """Fill `out` (P, N) with the ranges that pings are expected to have at some poses.

    A range is that of the middle of the transducer's place and of its sector, moved along the axis.
    It is computed once for each place and sector.

    Args:
        surface: The map.
        cone: The beam of all transducers.
        memory: Ranges computed so far [mm], 0 for the others, shape (rows, columns, sectors); the
            side of a place [m].
        guesses: Places of the transducers in the robot's frame, x, y, axis [m, rad], shape (N, 3+);
            poses of the robot on the map [m, rad], shape (P, 3).
        out: For the ranges [m]; above the longest where no echo is expected.
    """
    x0, y0, _, _ = surface[3]
    longest = cone[1]
    known, place = memory
    pings, poses = guesses
    rows, columns, sectors = known.shape
    sector = 2.0 * pi / sectors
    for p in range(len(poses)):
        c, s = cos(poses[p, 2]), sin(poses[p, 2])
        for i in range(len(pings)):
            x = poses[p, 0] + c * pings[i, 0] - s * pings[i, 1]
            y = poses[p, 1] + s * pings[i, 0] + c * pings[i, 1]
            axis = poses[p, 2] + pings[i, 2]
            column, row = floor((x - x0) / place), floor((y - y0) / place)
            if not (0 <= row < rows and 0 <= column < columns):
                out[p, i] = 2.0 * longest
                continue
            number = floor(axis / sector) % sectors
            middle_x, middle_y = x0 + (column + 0.5) * place, y0 + (row + 0.5) * place
            if known[row, column, number] == 0:
                looks = (number + 0.5) * sector
                millimeters = 1000.0 * echo_range(surface, cone, middle_x, middle_y, looks)
                known[row, column, number] = max(1, floor(millimeters))
            expected = float(known[row, column, number]) / 1000.0
            if expected < longest:
                expected -= (x - middle_x) * cos(axis) + (y - middle_y) * sin(axis)
            out[p, i] = expected


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
    longest, sigma, share = shape[0], shape[1], shape[2]
    right, nearer, other = shape[3], shape[4], shape[5]
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
