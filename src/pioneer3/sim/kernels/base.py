"""The seam between the simulated world and what computes it fast."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.kernels.drives import Drives
from pioneer3.sim.kernels.echoes import ALL, Echoes
from pioneer3.sim.kernels.mounts import Fan, Mounts
from pioneer3.sim.kernels.robots import Robots
from pioneer3.sim.kernels.walls import Grid

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]
Int32 = NDArray[np.int32]


class Kernels(Protocol):
    """What a world asks of its walls and robots. Arrays in, arrays out.

    Ranges agree with :func:`pioneer3.sim.raycast.cast_reference` within 1e-6 m. `out`, where given,
    is C-contiguous, is filled and returned; where not, the answer is a new array. After robots
    moved, :meth:`place` comes first: the other methods see them where they were placed.

    Attributes:
        name: `numba` or `numpy`.
    """

    name: str

    def place(self, robots: Robots) -> None:
        """Bring the outlines and the table of `robots` up to date with their poses."""
        ...

    def cast_rays(
        self,
        grid: Grid,
        robots: Robots,
        origins: Float,
        angles: Float,
        *,
        owner: Int32,
        limit: float,
        out: Float | None = None,
    ) -> Float:
        """Return the range to the nearest wall or robot along each ray [m], shape (R,).

        Args:
            grid: The walls.
            robots: Seen where they were placed.
            origins: Where rays start [m], shape (R, 2).
            angles: Their directions [rad], shape (R,).
            owner: The robot that each ray does not see, or -1, shape (R,).
            limit: Longest range [m]; a ray that hits nothing returns this.
            out: For the ranges, shape (R,).
        """
        ...

    def sonar(
        self,
        grid: Grid,
        robots: Robots,
        mounts: Mounts,
        limit: float,
        *,
        echoes: Echoes = ALL,
        owners: Int32 | None = None,
        out: Float | None = None,
    ) -> Float:
        """Return the range per robot and transducer [m], shape (F, mounts.most).

        The nearest echo counts, of a transducer's rays or of an edge between them. No robot hears
        itself. Columns that a robot's type does not have read `limit`.

        Args:
            grid: The walls.
            robots: Heard where they were placed.
            mounts: The transducers of the robots, which may be the first few of `robots`.
            limit: Longest range [m].
            echoes: What walls and edges send back. What a ray meets first hides what is behind,
                echo or not.
            owners: The F robots that listen; `None` means all that `mounts` has.
            out: For the ranges, shape (F, mounts.most).
        """
        ...

    def cast_fans(
        self,
        grid: Grid,
        robots: Robots,
        fan: Fan,
        limit: float,
        *,
        owners: Int32 | None = None,
        out: Float | None = None,
    ) -> Float:
        """Return the range per laser and beam [m], shape (F, B).

        Args:
            grid: The walls.
            robots: Seen where they were placed.
            fan: The beams, and where the laser sits on its robot.
            limit: Longest range [m].
            owners: The F robots that carry this laser; `None` means all N.
            out: For the ranges, shape (F, B).
        """
        ...

    def blocked(self, grid: Grid, robots: Robots, poses: Float, out: Bool | None = None) -> Bool:
        """Return whether each robot would stand on something, shape (N,).

        `poses` are the proposed ones, rows x, y [m], theta [rad], shape (3, N), C-contiguous.

        Touching is free, as in :func:`pioneer3.sim.collision.footprint_hits`. The other robots
        count where they were placed, not where they propose to go.
        """
        ...

    def step(
        self, grid: Grid, robots: Robots, drives: Drives, dt: float, noise: Float | None = None
    ) -> None:
        """Let every drive run for `dt` [s], at most `LONGEST`, as far as nothing is in the way.

        Robots move one after the other, so the earlier takes the room. One that something stops
        goes as far as is free, stands, and has its flag `STALLED` set. Poses, drives and outlines
        are those after the step.

        Args:
            grid: The walls.
            robots: The robots, in the order of `drives`, then what else may be in the way.
            drives: Of the robots.
            dt: [s].
            noise: Standard normal numbers, shape (3, N): for the way, for the turn, and for the
                drift while driving; `None` without random errors.
        """
        ...
