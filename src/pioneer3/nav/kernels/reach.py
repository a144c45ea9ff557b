"""Ways over cells that a robot can stand on."""

import numpy as np
from numpy.typing import NDArray

from pioneer3.jit import kernel

Float = NDArray[np.float64]
Int = NDArray[np.int64]
Flags = NDArray[np.bool_]


@kernel
def ways_from(free: Flags, start: int, queue: Int, queued: Flags, out: Float) -> None:
    """Lower `out` (H * W,) to the length of the shortest way over free cells from one [cells].

    Ways go to the eight neighbours; those aslant pass no corner.

    Args:
        free: Shape (H, W); the cells at its edges are not free.
        start: Number of a cell.
        queue: Shape (H * W,).
        queued: Which cells wait in `queue`: none; shape (H * W,).
        out: Bounds: only shorter ways are written, and `start` has 0.
    """
    width, size = free.shape[1], len(queue)
    cells = free.ravel()
    out[start] = 0.0
    queue[0] = start
    queued[start] = True
    first, waiting = 0, 1
    while waiting > 0:
        at = queue[first]
        first = (first + 1) % size
        waiting -= 1
        queued[at] = False
        for row in range(-1, 2):
            for column in range(-1, 2):
                to = at + row * width + column
                if (row == 0 and column == 0) or not cells[to]:
                    continue
                way = out[at] + 1.0
                if row != 0 and column != 0:
                    if not (cells[at + column] and cells[at + row * width]):
                        continue
                    way = out[at] + 1.4142135623730951
                if way < out[to] - 1e-9:
                    out[to] = way
                    if not queued[to]:
                        queued[to] = True
                        queue[(first + waiting) % size] = to
                        waiting += 1
