"""All that moves as arrays: poses, sizes, outlines, and the table of who is in which cell."""

import numpy as np
from numpy.typing import NDArray

Float = NDArray[np.float64]
Complex = NDArray[np.complex128]
Int32 = NDArray[np.int32]

CELL = 4.0
"""Side of a cell of the table [m]: a sensor's surroundings are a few cells."""

LEAST_SIDE = 4

AHEAD = np.array([1, -1, -1, 1])
LEFT = np.array([1, 1, -1, -1])
"""Signs of the corners, counter-clockwise from the front left."""


class Robots:
    """N robots, or other things that move: obstacles come after the robots.

    Write into `x`, `y`, `theta`, then let `Kernels.place` bring the rest up to date. An outline is
    a rectangle, or an octagon where its corners are cut off.

    A table says which robots are in which square cell. It repeats without end in both directions,
    so it needs no borders and robots may be anywhere; two far apart may share a place in it.

    Args:
        front: From the pose to the front edge [m], shape (N,).
        rear: From the pose to the rear edge [m], positive, shape (N,).
        half_width: From the pose to either side [m], shape (N,).
        cut: How much of each side a cut corner takes [m], shape (N,); without it 0.

    Attributes:
        state: Rows x, y [m], theta [rad], front, rear, half width, cut [m], and whether it is
            hidden (1: neither seen nor touched), shape (8, N); the attributes of these names are
            views of it.
        points: Middle and corners of each as it sees them itself, as complex numbers x + i y [m],
            shape (N, 5), or (N, 9) where any corner is cut.
        shapes: Middle x, y and radius of the circle around the outline, then its corners
            x, y counter-clockwise from the front left [m], shape (N, 11), or (N, 19) where any
            is cut.
        box: Least x, y, greatest x, y of their middles, largest radius [m], side of the table in
            cells, cells per metre, shape (7,).
        cell_start: Where the items of each place in the table start, shape (side * side + 1,).
        cell_items: The robots, sorted by the place of their middles, shape (N,).
        everyone: 0 to N - 1, shape (N,).
        stale: Poses have changed and wait for `Kernels.place`; whoever sets them says so.
    """

    def __init__(
        self, front: Float, rear: Float, half_width: Float, cut: Float | None = None
    ) -> None:
        self.state = np.zeros((8, len(front)))
        self.state[3:6] = front, rear, half_width
        self.state[6] = 0.0 if cut is None else cut
        self.x, self.y, self.theta, self.front, self.rear, self.half_width = self.state[:6]
        self.cut, self.hidden = self.state[6:]
        side = LEAST_SIDE
        while side * side < len(front):
            side *= 2
        radius = np.hypot((self.front + self.rear) / 2, self.half_width)
        largest = radius.max(initial=0.0)
        self.box = np.array([0.0, 0.0, 0.0, 0.0, largest, side, 1 / CELL])
        corners = 8 if self.cut.any() else 4
        self.points = _points(corners, self.state[3:7])
        self.shapes = np.zeros((len(front), 3 + 2 * corners))
        self.shapes[:, 2] = radius
        self.cell_start = np.zeros(side * side + 1, dtype=np.int32)
        self.cell_items = np.zeros(len(front), dtype=np.int32)
        self.stale = True
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
        """The four (or eight) sides of each robot [m], shape (N, 4, 4), as they were placed."""
        corners = self.shapes[:, 3:].reshape(len(self), self.shapes.shape[1] // 2 - 1, 2)
        return np.concatenate([corners, np.roll(corners, -1, axis=1)], axis=2)


def _points(count: int, sizes: Float) -> Complex:
    """Return middle and corners (N, 1 + 4 or 8) [m], given front, rear, half width, cut (4, N)."""
    points = np.empty((sizes.shape[1], 1 + count), dtype=np.complex128)
    points[:, 0] = (sizes[0] - sizes[1]) / 2
    _corners(points[:, 1:].real.T, points[:, 1:].imag.T, sizes)
    return points


def _corners(ahead: Float, left: Float, sizes: Float) -> None:
    """Fill in corners (4 or 8, N) [m], given front, rear, half width and cut, shape (4, N)."""
    front, rear, half, cut = sizes
    k = len(ahead) // 4
    ahead[:k] = ahead[3 * k :] = front
    ahead[k : 3 * k] = -rear
    left[: 2 * k], left[2 * k :] = half, -half
    if k == 2:
        # a cut corner is two: counter-clockwise the side that is walked along comes first
        left[::4] -= LEFT[::2, None] * cut
        left[3::4] -= LEFT[1::2, None] * cut
        ahead[1::4] -= AHEAD[::2, None] * cut
        ahead[2::4] -= AHEAD[1::2, None] * cut
