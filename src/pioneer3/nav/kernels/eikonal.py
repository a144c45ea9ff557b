"""The cost of the cheapest way from every cell to a goal: fast marching with a queue of buckets.

Sethian's method solves |gradient| = cost, so that ways may have any direction; a graph of cells
would make slanted ways up to 8 % too long. Cells wait in buckets of about the same cost (Yatziv et
al., 2006): a heap, which keeps them in order, takes three times as long. A cell that becomes
cheaper after its turn gets another one, so that both find the same costs.
"""

from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray

from pioneer3.jit import kernel

Float32 = NDArray[np.float32]
Int32 = NDArray[np.int32]

NOT_WAITING = -2
"""Entry of `after` for a cell that does not wait; -1 ends a bucket."""


@kernel
def march(
    costs: Float32, goal: int, width: int, depth: float, first: Int32, after: Int32, out: Float32
) -> None:
    """Fill `out` with the cost of the cheapest way to the goal.

    Args:
        costs: Of crossing each cell from side to side, row after row, shape (N,); `inf` where there
            is no way, as in all cells at the edges of the raster.
        goal: Number of its cell, which is none of these edges.
        width: Of a row [cells].
        depth: Range of the costs in one bucket.
        first: A cell of each bucket, filled with -1, shape (B,); a bucket serves again B later, and
            `depth` times B - 2 is no less than the highest finite cost.
        after: The next cell in the same bucket, filled with `NOT_WAITING`, shape (N,).
        out: Shape (N,), filled with `inf`.
    """
    buckets, turn, waiting = len(first), 0, 1
    out[goal] = 0.0
    first[0], after[goal] = goal, -1
    while waiting > 0:
        open_ = turn % buckets
        while first[open_] >= 0:
            cell = first[open_]
            first[open_], after[cell] = after[cell], NOT_WAITING
            waiting -= 1
            here = out[cell]
            for side in range(4):
                near = cell + (side == 0) - (side == 1) + width * ((side == 2) - (side == 3))
                old, step = out[near], np.float64(costs[near])
                if old <= here or step == inf:
                    continue
                across = np.float64(min(out[near - 1], out[near + 1]))  # the lower one in the row
                along = np.float64(min(out[near - width], out[near + width]))
                apart = across - along
                if abs(apart) < step:
                    value = (across + along + sqrt(2.0 * step * step - apart * apart)) / 2.0
                else:
                    value = min(across, along) + step
                new = np.float32(value)  # else the same cost might seem lower for ever
                if new >= old:
                    continue
                out[near] = new
                if after[near] == NOT_WAITING:
                    # one that waits keeps its bucket: that is late for few cells, and by little
                    bucket = max(turn, int(new / depth)) % buckets
                    after[near] = first[bucket]
                    first[bucket] = near
                    waiting += 1
        turn += 1
