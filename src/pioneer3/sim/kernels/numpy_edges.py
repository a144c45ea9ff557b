"""Edges that transducers hear, with numpy alone."""

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.kernels.echoes import SHADE, Echoes
from pioneer3.sim.kernels.numpy_around import Around
from pioneer3.sim.kernels.numpy_rays import measured
from pioneer3.sim.kernels.walls import Grid, ranges
from pioneer3.sim.raycast import TOUCH

Float = NDArray[np.float64]


def hear_edges(
    around: Around, grid: Grid, echoes: Echoes, *, frames: Float, table: Float, out: Float
) -> None:
    """Shorten ranges by the edges that lie in a beam and in sight.

    Args:
        around: Keeps what is near.
        grid: What hides edges.
        echoes: Which edges, and from how near.
        frames: Of the robots, shape (4, F).
        table: Of their transducers, as of `Rays`, shape (M, 2 + 2 k).
        out: The ranges [m], shape (F, M).
    """
    if echoes.edges is None or echoes.edge_range <= 0 or len(table) == 0:
        return
    reach = echoes.edge_range + float(np.hypot(table[:, 0], table[:, 1]).max())
    whose, seen = around.walls(echoes.edges, frames, reach)
    axis = table[:, 2:4] + table[:, -2:]
    wide = (axis * table[:, 2:4]).sum(axis=1)
    x, y = seen[0] - table[:, :1], seen[1] - table[:, 1:2]
    away, heard = np.hypot(x, y), np.minimum(out, echoes.edge_range)[whose].T
    inside = (away < heard) & (axis[:, :1] * x + axis[:, 1:] * y >= wide[:, None] * away)
    mount, edge = np.nonzero(inside)
    if len(edge) == 0:
        return
    ways, away, owner = np.stack([x, y])[:, mount, edge], away[mount, edge], whose[edge]
    whose, walls = around.walls(grid, frames, reach)
    counts = np.bincount(whose, minlength=frames.shape[1])
    pair = np.repeat(np.arange(len(edge)), counts[owner])
    wall = ranges((np.cumsum(counts) - counts)[owner], counts[owner])
    ends = walls[:, wall] - np.tile(table[mount, :2].T, (2, 1))[:, pair]
    clear = np.full(len(edge), np.inf)
    np.minimum.at(clear, pair, measured((ways / np.maximum(away, TOUCH))[:, pair], ends))
    in_sight = clear >= away - SHADE
    np.minimum.at(out, (owner[in_sight], mount[in_sight]), away[in_sight])
