"""The last check of a velocity command: it moves no outline into walls or echoes.

Farther than a margin from everything a robot drives as it likes, as long as it can brake before
that. Nearer to something it may only get farther from that, also by a turn.
"""

from dataclasses import astuple, dataclass, field
from itertools import product
from math import hypot, inf
from typing import Self

import numpy as np
from scipy.spatial import cKDTree

from pioneer3.arrays import Float
from pioneer3.geometry import STILL, Twist2
from pioneer3.jit import fast
from pioneer3.limits import Limits
from pioneer3.models import RobotModel
from pioneer3.nav.kernels import CACHE
from pioneer3.nav.kernels.arcs import ROUNDING
from pioneer3.nav.kernels.clearance import room_along, rooms

REACTION = 0.15
"""Longest time from the sensors' readings until the robot obeys [s]."""
HOLD = 0.2
"""Time for which a command may stay without another one: two reports [s]."""
STEP = 0.05
"""Step of the prediction [s]."""
SHARES = 5
"""Number of shares of the speed, and of the turn rate, that are tried in place of the whole."""
PIECE = 1.0
"""Length of the pieces of walls at most [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class Walls:
    """The walls of a map, arranged by their places.

    Attributes:
        pieces: Segments [m], shape (P, 4).
    """

    pieces: Float
    _middles: cKDTree

    @classmethod
    def of(cls, walls: Float) -> Self:
        """Return walls (W, 4) [m], cut into pieces."""
        lengths = np.hypot(walls[:, 2] - walls[:, 0], walls[:, 3] - walls[:, 1])
        counts = np.maximum(np.ceil(lengths / PIECE).astype(np.int64), 1)
        owners = np.repeat(np.arange(len(walls)), counts)
        number = np.arange(len(owners)) - np.repeat(np.cumsum(counts) - counts, counts)
        step = (walls[:, 2:] - walls[:, :2])[owners] / counts[owners, None]
        begin = walls[owners, :2]
        pieces = np.hstack([begin + number[:, None] * step, begin + (number[:, None] + 1) * step])
        return cls(pieces, cKDTree((pieces[:, :2] + pieces[:, 2:]) / 2))

    def near(self, x: float, y: float, within: float) -> Float:
        """Return all pieces that come so near to a place [m], and a few more, shape (N, 4)."""
        near: Float = self.pieces[self._middles.query_ball_point((x, y), within + PIECE / 2)]
        return near


@dataclass(slots=True, kw_only=True)
class Clearance:
    """Keeps the outline of one robot out of what is around it, whatever it is told.

    Attributes:
        margin: Distance within which it only gets farther [m].
    """

    model: RobotModel
    limits: Limits
    margin: float
    _passed: Twist2 = field(default=STILL, init=False)
    _passed_at: float = field(default=-inf, init=False)

    def horizon(self, twist: Twist2, asked: Twist2) -> tuple[float, float]:
        """Return the distance [m] and the time [s] within which something matters to a motion."""
        v = max(abs(twist.v), abs(asked.v), abs(self._passed.v))
        time = REACTION + HOLD + v / self.limits.deceleration
        return self.model.corner + self.margin + v * (time + STEP), time

    def limit(self, asked: Twist2, twist: Twist2, around: Float, now: float) -> Twist2:
        """Return the nearest motion to the one `asked` for that comes too near to nothing.

        Where all do, as something has just come, it is the one that leaves the most room.

        Args:
            asked: For the next moment.
            twist: As measured.
            around: Segments in the robot's frame [m], and the room around each that is taken [m],
                shape (N, 5); points are segments without a length.
            now: [s, monotonic].
        """
        before = self._passed if now - self._passed_at < self.limits.expiry else STILL
        passed = asked
        if len(around):
            passed = self._nearest(asked, np.array([twist.v, twist.w, before.v, before.w]), around)
        self._passed, self._passed_at = passed, now
        return passed

    def _nearest(self, asked: Twist2, before: Float, around: Float) -> Twist2:
        model, found = self.model, np.empty((len(around), 2))
        motion = np.array([*astuple(self.limits.accelerations), REACTION, HOLD, STEP])
        sides = np.array([model.length_front, model.length_rear, model.width / 2])
        fast(rooms, CACHE)(around, sides, found)
        order = found[:, 1].argsort()
        kept = np.minimum(found[:, 0], self.margin + around[:, 4])[order]
        outline = np.array([*sides, kept.max(), -ROUNDING])
        walls = np.column_stack([around[:, :4], found[:, 1]])[order]

        def room(*commands: tuple[float, float]) -> Float:
            out = np.empty(len(commands))
            fast(room_along, CACHE)(np.array(commands), before, motion, outline, walls, kept, out)
            return out

        shares = np.linspace(0.0, 1.0, SHARES).tolist()
        tries = sorted(product(shares, repeat=2), key=lambda each: hypot(1 - each[0], 1 - each[1]))
        commands = list(dict.fromkeys((v * asked.v, w * asked.w) for v, w in tries))
        for command in commands:
            if room(command)[0] >= -ROUNDING:
                return Twist2(*command)
        outline[4] = -inf  # all come too near: each to its end
        left = room(*commands)
        return Twist2(*commands[np.flatnonzero(left >= left.max() - ROUNDING)[-1]])
