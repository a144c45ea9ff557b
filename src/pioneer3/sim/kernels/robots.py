"""Many robots as arrays: poses, sizes, outlines, and the table of who is in which cell."""

import numpy as np
from numpy.typing import NDArray

Float = NDArray[np.float64]
Int32 = NDArray[np.int32]

CELL = 4.0
"""Side of a cell of the table [m]: a sensor's surroundings are a few cells."""

LEAST_SIDE = 4


class Robots:
    """N robots. Write into `x`, `y`, `theta`, then let `Kernels.place` bring the rest up to date.

    A table says which robots are in which square cell. It repeats without end in both directions,
    so it needs no borders and robots may be anywhere; two far apart may share a place in it.

    Args:
        front: From the pose to the front edge [m], shape (N,).
        rear: From the pose to the rear edge [m], positive, shape (N,).
        half_width: From the pose to either side [m], shape (N,).

    Attributes:
        state: Rows x, y [m], theta [rad], front, rear, half width [m], shape (6, N); the six
            attributes of these names are views of it.
        shapes: Middle x, y and radius of the circle around the outline, then its corners
            x, y counter-clockwise from the front left [m], shape (N, 11).
        box: Least x, y, greatest x, y of their middles, largest radius [m], side of the table in
            cells, cells per metre, shape (7,).
        cell_start: Where the items of each place in the table start, shape (side * side + 1,).
        cell_items: The robots, sorted by the place of their middles, shape (N,).
        everyone: 0 to N - 1, shape (N,).
    """

    def __init__(self, front: Float, rear: Float, half_width: Float) -> None:
        self.state = np.zeros((6, len(front)))
        self.state[3:] = front, rear, half_width
        self.x, self.y, self.theta, self.front, self.rear, self.half_width = self.state
        side = LEAST_SIDE
        while side * side < len(front):
            side *= 2
        radius = np.hypot((self.front + self.rear) / 2, self.half_width).max(initial=0.0)
        self.box = np.array([0.0, 0.0, 0.0, 0.0, radius, side, 1 / CELL])
        self.shapes = np.zeros((len(front), 11))
        self.cell_start = np.zeros(side * side + 1, dtype=np.int32)
        self.cell_items = np.zeros(len(front), dtype=np.int32)
        self.everyone = np.arange(len(front), dtype=np.int32)

    def __len__(self) -> int:
        return self.state.shape[1]

    @property
    def arrays(self) -> tuple[Float, Float, Int32, Int32]:
        """What kernels walk: box, shapes, cell_start, cell_items."""
        return self.box, self.shapes, self.cell_start, self.cell_items

    @property
    def poses(self) -> Float:
        """Rows x, y [m], theta [rad], shape (3, N); a view."""
        return self.state[:3]

    @property
    def outlines(self) -> Float:
        """The four sides of each robot [m], shape (N, 4, 4), as they were placed."""
        corners = self.shapes[:, 3:].reshape(-1, 4, 2)
        return np.concatenate([corners, np.roll(corners, -1, axis=1)], axis=2)
