"""Maps on which robots may be wrong about their places: identical rooms, moved furniture.

They are named `rooms`, `furnished:SEED` and `moved:SEED`; of the last two a robot has the former
and is in the latter.
"""

from math import pi

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap
from pioneer3.maps.line_map import distances

Float = NDArray[np.float64]

ROOMS = "rooms"
FURNISHED = "furnished"
MOVED = "moved"
SIDE = 4.0
"""Length of the sides of each room [m]."""
ACROSS = 2.0
"""Width of the corridor between the rooms [m]."""
DOOR = 1.0, 1.9
"""Begin and end of the doorway of each room, along its wall [m]."""
PER_SIDE = 12
"""Rooms on each side of the corridor."""
FURNISHED_PER_SIDE = 3
"""Rooms on each side where there is furniture."""
PIECES = 20
"""Pieces of furniture."""
MOVED_SHARE = 0.3
"""Share of the furniture that was moved."""
CLEAR = 0.7
"""Room that a piece of furniture leaves to walls, besides its own half width [m]."""


def twin_rooms(per_side: int = PER_SIDE) -> LineMap:
    """Return a corridor of identical rooms; seen from the other end it differs by a niche."""
    walls, length = list[list[float]](), per_side * SIDE
    low, high = -ACROSS / 2, ACROSS / 2
    for number in range(per_side):
        x = number * SIDE
        begin, end = x + DOOR[0], x + DOOR[1]
        room = _room(x, begin, end, high)
        walls += [*room, *([length - a, -b, length - c, -d] for a, b, c, d in room)]
    walls += [[0, low, 0, high], [length, low, length, -0.4], [length, 0.4, length, high]]
    walls += [[length, -0.4, length + 1, -0.4], [length, 0.4, length + 1, 0.4]]
    walls += [[length + 1, -0.4, length + 1, 0.4]]
    return LineMap(name=ROOMS, walls=np.array(walls))


def _room(x: float, begin: float, end: float, y: float) -> list[list[float]]:
    """Return the walls of a room above the corridor, with a cupboard."""
    right, top = x + SIDE, y + SIDE
    cupboard = [[x, top - 1.2, x + 0.5, top - 1.2], [x + 0.5, top - 1.2, x + 0.5, top]]
    sides = [[x, y, x, top], [x, top, right, top], [right, top, right, y]]
    return [*sides, [x, y, begin, y], [end, y, right, y], *cupboard]


def furnished(seed: int, *, moved: bool) -> LineMap:
    """Return a few identical rooms with furniture, or with a share of that elsewhere."""
    walls = twin_rooms(FURNISHED_PER_SIDE).walls
    rng = np.random.default_rng((seed, 30))
    pieces = list[Float]()
    for _ in range(PIECES):
        pieces.append(_piece(rng, walls, pieces))
    if moved:
        for number in rng.choice(PIECES, round(MOVED_SHARE * PIECES), replace=False).tolist():
            others = [piece for at, piece in enumerate(pieces) if at != number]
            pieces[number] = _piece(rng, walls, others)
    name = f"{MOVED if moved else FURNISHED}:{seed}"
    return LineMap(name=name, walls=np.vstack([walls, *pieces]))


def _piece(rng: np.random.Generator, walls: Float, others: list[Float]) -> Float:
    """Return the sides of a box with room around it [m], shape (4, 4)."""
    taken = np.vstack([walls, *others])
    x_min, x_max = walls[:, ::2].min(), walls[:, ::2].max()
    y_min, y_max = walls[:, 1::2].min(), walls[:, 1::2].max()
    while True:
        at = rng.uniform((x_min, y_min), (x_max, y_max))
        half = rng.uniform(0.15, 0.6, 2)
        if distances(at, taken).min() > CLEAR / 2 + float(np.hypot(*half)):
            break
    pose = Pose2(float(at[0]), float(at[1]), float(rng.choice([0.0, rng.uniform(-pi, pi)])))
    signs = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    corners = [pose @ Pose2(a * half[0], b * half[1]) for a, b in signs]
    ends = np.array([(corner.x, corner.y) for corner in corners])
    return np.hstack([ends, np.roll(ends, -1, axis=0)])


def doubtful_map(name: str) -> LineMap | None:
    """Return the map of a name, `None` if that is none of these."""
    kind, _, seed = name.partition(":")
    if kind == ROOMS:
        return twin_rooms()
    return furnished(int(seed), moved=kind == MOVED) if kind in {FURNISHED, MOVED} else None
