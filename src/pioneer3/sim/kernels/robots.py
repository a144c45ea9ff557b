# ruff: noqa: PLR0917 (compiled functions take no keywords without a cost)
"""All that moves, as arrays: poses, sizes, outlines, and a table of robots by cell.

As in all kernels, a loop runs over robots `first` to `last`, so threads can share. Names: a ray
starts at (ox, oy) and runs along the unit vector (dx, dy); (ax, ay) and (bx, by) are the ends of a
segment; lattice units are cells. Arrays are those of Grid, Robots, Mounts, Fan and Drives.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import cos, floor, inf, sin, sqrt

import numpy as np

from pioneer3.arrays import Bool, Float, Int32
from pioneer3.errors import ConfigError
from pioneer3.jit import inlined, kernel
from pioneer3.sim.kernels.walls import SLACK

Walls = tuple[Float, Int32, Float]
"""Arrays of a grid: frame, cell_start, pieces."""

Others = tuple[Float, Float, Int32, Int32]
"""Arrays of robots: box, shapes, cell_start, cell_items."""

CELL = 4.0
"""Side of a cell of the table [m]: a sensor's surroundings are a few cells."""

LEAST_SIDE = 4

FAR = 1e9
"""From further away a ray does not find the grid [cells]; rounding would lose its way."""

NOWHERE = 1e8
"""Coordinate of hidden robots [m]."""


class RobotArrays:
    """N robots, or other things that move: obstacles come after the robots.

    Write into `x`, `y`, `theta`, then let `Kernels.place` bring the rest up to date. An outline is
    a rectangle, or an octagon where its corners are cut off.

    A table says which robots are in which square cell. It repeats without end in both directions,
    so it needs no borders and robots may be anywhere; two far apart may share a place in it.

    Attributes:
        state: Rows x, y [m], theta [rad], from the pose to the front edge, to the rear one, to
            either side, how much of each side a cut corner takes [m], and whether it is hidden (1:
            neither seen nor touched), shape (8, N); the attributes of these names are views of it.
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
        self._view()
        side = 1 if len(front) == 1 else LEAST_SIDE
        while side * side < len(front):
            side *= 2
        radius = np.hypot((self.front + self.rear) / 2, self.half_width)
        largest = radius.max(initial=0.0)
        self.box = np.array([0.0, 0.0, 0.0, 0.0, largest, side, 1 / CELL])
        corners = 8 if self.cut.any() else 4
        self.shapes = np.zeros((len(front), 3 + 2 * corners))
        self.shapes[:, 2] = radius
        self.cell_start = np.zeros(side * side + 1, dtype=np.int32)
        self.cell_items = np.zeros(len(front), dtype=np.int32)
        self.stale = True
        self.everyone = np.arange(len(front), dtype=np.int32)

    def __len__(self) -> int:
        return self.state.shape[1]

    def __setstate__(self, attributes: Mapping[str, object]) -> None:
        """Take the attributes of another one: in a copy the views are those of its own state."""
        self.__dict__.update(attributes)
        self._view()

    def _view(self) -> None:
        self.x, self.y, self.theta, self.front, self.rear, self.half_width = self.state[:6]
        self.cut, self.hidden = self.state[6:]

    @property
    def arrays(self) -> tuple[Float, Float, Int32, Int32]:
        """Arguments of kernels: box, shapes, cell_start, cell_items."""
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


@inlined
def cells(low: float, high: float, edge: float, per_metre: float) -> tuple[int, int]:
    """Return the first and last column (or row) of an interval; far away, merely outside."""
    first = floor(min(max((low - edge) * per_metre, -FAR), FAR))
    return first, floor(min(max((high - edge) * per_metre, -FAR), FAR))


@inlined
def _place(x: float, y: float, per_metre: float, mask: int) -> int:
    """Return where a point's cell is in the table."""
    column, _ = cells(x, x, 0.0, per_metre)
    row, _ = cells(y, y, 0.0, per_metre)
    return (row & mask) * (mask + 1) + (column & mask)


@kernel
def neighbours(x: float, y: float, reach: float, skip: int, others: Others, found: Int32) -> int:
    """Fill `found` with the robots, but not `skip`, within `reach`; return how many."""
    box, shapes, places, items = others
    side, per_metre, wide, count = int(box[5]), box[6], reach + box[4] + SLACK, 0
    west, east = cells(max(x - wide, box[0]), min(x + wide, box[2]), 0.0, per_metre)
    south, north = cells(max(y - wide, box[1]), min(y + wide, box[3]), 0.0, per_metre)
    if east - west >= side or north - south >= side:
        west, east, south, north = 0, side - 1, 0, side - 1
    for row in range(south, north + 1):
        for column in range(west, east + 1):
            place = (row & (side - 1)) * side + (column & (side - 1))
            for k in range(places[place], places[place + 1]):
                n = items[k]
                dx, dy, near = shapes[n, 0] - x, shapes[n, 1] - y, reach + shapes[n, 2] + SLACK
                found[count] = n
                count += n != skip and dx * dx + dy * dy <= near * near
    return count


@kernel
def outline(n: int, state: Float, shapes: Float) -> None:
    """Compute the middle, the radius and the corners of one robot."""
    x, y, c, s = state[0, n], state[1, n], cos(state[2, n]), sin(state[2, n])
    front, rear, half, cut = state[3, n], state[4, n], state[5, n], state[6, n]
    if state[7, n] != 0.0:
        x = y = NOWHERE
    middle, corners = (front - rear) / 2, (shapes.shape[1] - 3) // 2
    shapes[n, 0], shapes[n, 1] = x + c * middle, y + s * middle
    length = (front + rear) / 2
    shapes[n, 2] = sqrt(length * length + half * half)
    for k in range(corners):
        quarter = k * 4 // corners
        ahead = front if quarter % 3 == 0 else -rear
        left = half if quarter < 2 else -half
        if corners == 8:  # a cut corner is two: counter-clockwise first one then the other
            if (k + quarter) % 2 == 0:
                left -= cut if left > 0 else -cut
            else:
                ahead -= cut if ahead > 0 else -cut
        shapes[n, 3 + 2 * k] = x + c * ahead - s * left
        shapes[n, 4 + 2 * k] = y + s * ahead + c * left


@kernel
def place(state: Float, others: Others) -> None:
    """Compute outlines, and sort the robots into the table."""
    for n in range(len(others[1])):
        outline(n, state, others[1])
    sort(others)


@kernel
def sort(others: Others) -> None:
    """Sort the robots into the table by counting; their outlines are computed."""
    box, shapes, places, items = others
    mask, per_metre = int(box[5]) - 1, box[6]
    box[0], box[1], box[2], box[3] = inf, inf, -inf, -inf
    for k in range(len(places)):
        places[k] = 0
    for n in range(len(shapes)):
        mx, my = shapes[n, 0], shapes[n, 1]
        box[0], box[1] = min(box[0], mx), min(box[1], my)
        box[2], box[3] = max(box[2], mx), max(box[3], my)
        places[_place(mx, my, per_metre, mask)] += 1
    total = 0
    for k in range(len(places)):
        total += places[k]
        places[k] = total
    for n in range(len(shapes) - 1, -1, -1):
        k = _place(shapes[n, 0], shapes[n, 1], per_metre, mask)
        places[k] -= 1
        items[places[k]] = n


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Mounts:
    """Transducers of every robot type, and which robot is of which type.

    Attributes:
        table: Of each transducer x, y [m] on the robot, then cosine and sine of each of its k
            rays there, shape (T, 2 + 2 k); one type after another.
        offsets: Where each type starts in the table, shape (types + 1,).
        kinds: Type of each robot, shape (N,).
        most: Transducers of the type that has most: the width of the output.
        reach: No transducer is further from its robot's pose than this [m].
    """

    table: Float
    offsets: Int32
    kinds: Int32
    most: int
    reach: float

    @property
    def arrays(self) -> tuple[Float, Int32, Int32]:
        """Arguments of kernels: table, offsets, kinds."""
        return self.table, self.offsets, self.kinds

    @property
    def absent(self) -> Bool:
        """Whether a robot lacks a transducer of the output, shape (N, most)."""
        absent: Bool = np.arange(self.most) >= np.diff(self.offsets)[self.kinds, None]
        return absent

    def only(self, some: Sequence[Sequence[int]]) -> "Mounts":
        """Return some transducers of each type, by their numbers and in this order."""
        counts = [*map(len, some)]
        rows = np.concatenate([[], *some]).astype(np.int64)
        rows += np.repeat(self.offsets[:-1], counts)
        offsets = np.cumsum([0, *counts], dtype=np.int32)
        most = max(counts, default=0)
        return replace(self, table=self.table[rows], offsets=offsets, most=most)


def sonar_mounts(
    types: Sequence[Float], kinds: Sequence[int], *, rays: int = 1, width: float = 0.0
) -> Mounts:
    """Lay out transducers for a kernel.

    `types` are of each robot type x, y [m], theta [rad] of its transducers, shape (M, 3), and
    `kinds` each robot's index into them. The rays of a transducer are spread evenly from edge to
    edge of its beam, whose full angle is `width` [rad]; the nearest counts.

    Raises:
        ConfigError: Fewer than one ray, or a robot of a type that is not there.
    """
    if rays < 1:
        raise ConfigError(f"rays per sonar: {rays}, but it takes at least 1")
    if kinds and not 0 <= min(kinds) <= max(kinds) < len(types):
        raise ConfigError(f"robot types: {min(kinds)}..{max(kinds)}, but there are {len(types)}")
    mounts = np.concatenate([np.empty((0, 3)), *types])
    spread = np.linspace(-width / 2, width / 2, rays) if rays > 1 else np.zeros(1)
    angles = mounts[:, 2:] + spread
    headings = np.stack([np.cos(angles), np.sin(angles)], axis=2).reshape(len(mounts), 2 * rays)
    return Mounts(
        table=np.ascontiguousarray(np.concatenate([mounts[:, :2], headings], axis=1)),
        offsets=np.cumsum([0, *map(len, types)], dtype=np.int32),
        kinds=np.array(kinds, dtype=np.int32),
        most=max(map(len, types), default=0),
        reach=float(np.hypot(mounts[:, 0], mounts[:, 1]).max(initial=0.0)),
    )


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Fan:
    """The beams of a laser, and where it sits on the robot.

    Attributes:
        frame: Mount x, y [m], theta [rad]; angle of the first beam from straight ahead of the
            laser, angle from one to the next [rad], shape (5,).
        headings: Cosines and sines of the beams, seen from the laser, shape (2, B).
    """

    frame: Float
    headings: Float


def laser_fan(mount: tuple[float, float, float], start: float, step: float, count: int) -> Fan:
    """Lay out a laser for a kernel.

    `mount` is x, y [m], theta [rad] on the robot; `start` is the first beam, from straight ahead of
    the laser, and `step` leads to the next, counter-clockwise [rad].

    Raises:
        ConfigError: The step is not positive, or there is no beam.
    """
    if not step > 0 or count < 1:
        raise ConfigError(f"laser: {count} beams {step} rad apart; both must be positive")
    angles = start + step * np.arange(count)
    return Fan(np.array([*mount, start, step]), np.stack([np.cos(angles), np.sin(angles)]))
