"""Ways down a field of costs."""

from math import floor, hypot, inf

from pioneer3.arrays import Float, Float32
from pioneer3.jit import inlined, kernel


@inlined
def lower(values: Float32, row: int, column: int, row_step: int, column_step: int) -> float:
    """Return how much lower the neighbour on either side is [per cell], signed towards it."""
    height, width = values.shape
    here = values[row, column]
    after, before = inf, inf
    if 0 <= row + row_step < height and 0 <= column + column_step < width:
        after = values[row + row_step, column + column_step]
    if 0 <= row - row_step < height and 0 <= column - column_step < width:
        before = values[row - row_step, column - column_step]
    if after < here and after <= before:
        return float(here - after)
    if before < here:
        return float(before - here)
    return 0.0


@inlined
def direction(values: Float32, x: float, y: float) -> tuple[float, float]:
    """Return where the values fall from a place [cells]: a vector no longer than 1.

    It is the mean over the four cells around the place, of upwind differences, as the values were
    made; those know nothing of places without a way.
    """
    height, width = values.shape
    left, low = floor(x - 0.5), floor(y - 0.5)
    u, v = x - 0.5 - left, y - 0.5 - low
    to_x, to_y = 0.0, 0.0
    for corner in range(4):
        right, above = corner % 2, corner // 2
        column, row = left + right, low + above
        if not (0 <= column < width and 0 <= row < height) or values[row, column] == inf:
            continue
        share = (u if right else 1.0 - u) * (v if above else 1.0 - v)
        dx, dy = lower(values, row, column, 0, 1), lower(values, row, column, 1, 0)
        steep = hypot(dx, dy)
        if steep > 0.0:
            to_x += share * dx / steep
            to_y += share * dy / steep
    return to_x, to_y


@inlined
def downhill(values: Float32, x: float, y: float, step: float) -> tuple[float, float]:
    """Return the place one step [cells] down from another; the same place if none is lower."""
    height, width = values.shape
    to_x, to_y = direction(values, x, y)
    steep = hypot(to_x, to_y)
    next_x, next_y = x, y
    if steep > 1e-3:
        next_x, next_y = x + step * to_x / steep, y + step * to_y / steep
    column, row = floor(next_x), floor(next_y)
    inside = 0 <= column < width and 0 <= row < height
    if steep <= 1e-3 or not inside or values[row, column] == inf:
        # between two ways, or beside a wall: to the middle of the lowest cell near
        best = inf
        column, row = floor(x), floor(y)
        next_x, next_y = x, y
        for r in range(max(0, row - 1), min(height, row + 2)):
            for c in range(max(0, column - 1), min(width, column + 2)):
                if values[r, c] < best:
                    best, next_x, next_y = values[r, c], c + 0.5, r + 0.5
    return next_x, next_y


@kernel
def descend(values: Float32, start: Float, goal: Float, step: float, out: Float) -> int:
    """Walk down `values` (H, W) from `start` to `goal`; return how many points of `out` are filled.

    The points of `out` (N, 2) are in cells, the first one `start`, the last one `goal`; none is
    filled if no way is found within its room.
    """
    x, y = start[0], start[1]
    out[0, 0], out[0, 1] = x, y
    for count in range(1, len(out) - 1):
        if hypot(x - goal[0], y - goal[1]) < 1.5:
            out[count, 0], out[count, 1] = goal[0], goal[1]
            return count + 1
        next_x, next_y = downhill(values, x, y, step)
        if next_x == x and next_y == y:
            return 0
        x, y = next_x, next_y
        out[count, 0], out[count, 1] = x, y
    return 0
