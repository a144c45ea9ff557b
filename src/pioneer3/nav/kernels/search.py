"""The likelihood of a scan at all places of a map and at all headings."""

import numpy as np
from numpy.typing import NDArray

from pioneer3.jit import kernel

UInt8 = NDArray[np.uint8]
UInt16 = NDArray[np.uint16]
Int32 = NDArray[np.int32]


@kernel
def score_places(field: UInt8, cells: Int32, offsets: Int32, out: UInt16) -> None:
    """Fill `out` (C, H) with the sums of `field` at the ends of beams.

    Args:
        field: Score of an end in each cell, 255 at a wall, shape (rows, columns).
        cells: Row and column of the robot, shape (C, 2).
        offsets: Rows and columns from there to the ends of B beams at H headings, shape (H, B, 2).
        out: Of up to 257 beams.
    """
    rows, columns = field.shape
    for i in range(len(cells)):
        row, column = cells[i, 0], cells[i, 1]
        for heading in range(offsets.shape[0]):
            total = 0
            for beam in range(offsets.shape[1]):
                r, c = row + offsets[heading, beam, 0], column + offsets[heading, beam, 1]
                if 0 <= r < rows and 0 <= c < columns:
                    total += int(field[r, c])
            out[i, heading] = total
