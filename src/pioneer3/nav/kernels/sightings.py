"""Cells in which things were seen that are not on the map, and cells that were seen to be free."""

from math import floor, hypot

import numpy as np
from numpy.typing import NDArray

from pioneer3.jit import kernel

Float = NDArray[np.float64]
Float32 = NDArray[np.float32]
UInt8 = NDArray[np.uint8]


@kernel
def clear_beams(origin: Float, ends: Float, short: float, seen: Float, counts: UInt8) -> None:
    """Forget what was seen in the cells that beams pass.

    Args:
        origin: Where all beams begin [cells], shape (2,).
        ends: Where they end [cells], shape (N, 2).
        short: The last part of each, which is not looked at [cells].
        seen: Time of the last sighting in each cell, 0 for none, shape (H, W).
        counts: How often something was seen there since it was free, shape (H, W).
    """
    height, width = seen.shape
    for i in range(len(ends)):
        dx, dy = ends[i, 0] - origin[0], ends[i, 1] - origin[1]
        length = hypot(dx, dy)
        if length <= short:
            continue
        dx, dy = dx / length, dy / length
        for step in range(floor(2.0 * (length - short))):
            column, row = floor(origin[0] + dx * step / 2), floor(origin[1] + dy * step / 2)
            if 0 <= column < width and 0 <= row < height:
                seen[row, column], counts[row, column] = 0.0, 0


@kernel
def mark_echoes(
    echoes: Float, clearance: Float32, known: Float, now: float, seen: Float, counts: UInt8
) -> None:
    """Note the cells of echoes that no wall of the map explains.

    Args:
        echoes: [cells], shape (N, 2).
        clearance: Distance of each cell to the nearest wall [m], shape (H, W).
        known: An echo nearer to a wall than this is of that wall [m], shape (N,).
        now: The time to note.
        seen: As `clear_beams` has it, shape (H, W).
        counts: As `clear_beams` has it, shape (H, W).
    """
    height, width = seen.shape
    for i in range(len(echoes)):
        column, row = floor(echoes[i, 0]), floor(echoes[i, 1])
        inside = 0 <= column < width and 0 <= row < height
        if inside and clearance[row, column] > known[i]:
            if seen[row, column] != now:  # several echoes of one scan count once
                counts[row, column] = min(counts[row, column], 200) + 1
            seen[row, column] = now
