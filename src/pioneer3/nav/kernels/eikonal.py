"""The cost of the cheapest way from every cell to a goal: fast marching with a heap of cells.

Sethian's method solves |gradient| = cost, so that ways may have any direction; a graph of cells
would make slanted ways up to 8 % too long.
"""

from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray

from pioneer3.jit import inlined, kernel

Float32 = NDArray[np.float32]
Int32 = NDArray[np.int32]


@inlined
def _lift(heap: Int32, places: Int32, keys: Float32, at: int) -> None:
    """Move the cell at place `at` of the heap towards its top as far as it belongs."""
    cell = heap[at]
    key = keys[cell]
    while at > 0:
        above = (at - 1) // 2
        other = heap[above]
        if keys[other] <= key:
            break
        heap[at] = other
        places[other] = at
        at = above
    heap[at] = cell
    places[cell] = at


@inlined
def _sink(heap: Int32, places: Int32, keys: Float32, size: int) -> None:
    """Move the cell at the top of the heap down as far as it belongs."""
    cell = heap[0]
    key = keys[cell]
    at = 0
    while True:
        below = 2 * at + 1
        if below >= size:
            break
        if below + 1 < size and keys[heap[below + 1]] < keys[heap[below]]:
            below += 1
        other = heap[below]
        if keys[other] >= key:
            break
        heap[at] = other
        places[other] = at
        at = below
    heap[at] = cell
    places[cell] = at


@kernel
def march(costs: Float32, goals: Int32, heap: Int32, places: Int32, out: Float32) -> int:
    """Fill `out` with the cost of the cheapest way to any goal; return how many cells have one.

    Args:
        costs: Of crossing each cell from side to side, shape (H, W); `inf` where there is no way.
        goals: Indices of cells in the flattened raster, shape (G,).
        heap: Room for every cell, shape (H * W,).
        places: As large, filled with -1; in the end -2 for each cell that was reached.
        out: Shape (H, W), filled with `inf`.
    """
    height, width = costs.shape
    cost, values = costs.ravel(), out.ravel()
    size, reached = 0, 0
    for i in range(len(goals)):
        cell = goals[i]
        if places[cell] == -1:
            values[cell] = 0.0
            heap[size] = cell
            places[cell] = size
            size += 1
            _lift(heap, places, values, size - 1)
    while size > 0:
        cell = heap[0]
        places[cell] = -2
        reached += 1
        size -= 1
        if size > 0:
            heap[0] = heap[size]
            places[heap[0]] = 0
            _sink(heap, places, values, size)
        row, column = cell // width, cell % width
        for side in range(4):
            r = row + (side == 0) - (side == 1)
            c = column + (side == 2) - (side == 3)
            if r < 0 or r >= height or c < 0 or c >= width:
                continue
            near = r * width + c
            step = cost[near]
            if places[near] == -2 or step == inf:
                continue
            across = inf  # the lower neighbour in the row, then in the column
            if c > 0 and places[near - 1] == -2:
                across = values[near - 1]
            if c < width - 1 and places[near + 1] == -2 and values[near + 1] < across:
                across = values[near + 1]
            along = inf
            if r > 0 and places[near - width] == -2:
                along = values[near - width]
            if r < height - 1 and places[near + width] == -2 and values[near + width] < along:
                along = values[near + width]
            apart = across - along
            if abs(apart) < step:
                value = (across + along + sqrt(2.0 * step * step - apart * apart)) / 2.0
            else:
                value = min(across, along) + step
            if value < values[near]:
                values[near] = value
                if places[near] == -1:
                    heap[size] = near
                    places[near] = size
                    size += 1
                _lift(heap, places, values, places[near])
    return reached
