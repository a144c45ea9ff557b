"""Sensors as arrays: where rays start on a robot and where they point."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pioneer3.errors import ConfigError

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]
Int32 = NDArray[np.int32]


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

    Args:
        types: Of each robot type x, y [m], theta [rad] of its transducers, shape (M, 3).
        kinds: Index into `types` of each robot.
        rays: Of each transducer, spread evenly from edge to edge of its beam; the nearest counts.
        width: Full angle of the beam [rad].

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
