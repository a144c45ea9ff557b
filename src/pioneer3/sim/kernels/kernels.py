"""Motion, rays, fans and collisions of all robots at once. Arrays in, arrays out.

Ranges agree with :func:`pioneer3.sim.raycast.cast_reference` within 1e-6 m. `out`, where given, is
C-contiguous, is filled and returned; where not, the answer is a new array. After robots moved,
:meth:`Kernels.place` comes first: the other methods see them where they were placed.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

import numpy as np

from pioneer3.arrays import Bool, Float, Int32
from pioneer3.jit import KernelCache, fast, numba_version, plain
from pioneer3.sim.kernels import fans, motion, rays, spots
from pioneer3.sim.kernels.drives import DriveArrays
from pioneer3.sim.kernels.echoes import ALL, Reflectors
from pioneer3.sim.kernels.robots import Fan, Mounts, RobotArrays, laser_fan, place, sonar_mounts
from pioneer3.sim.kernels.walls import Grid, build_grid

_HERE = Path(__file__).parent
CACHE = KernelCache(_HERE, [_HERE.parent / "collision.py", _HERE.parent / "raycast.py"])
WORTH_COMPILING = 6
"""Robots from which on compiled kernels pay in real time: they take a second and 130 MB, and half
of the processor."""

WORTH_THREADS = 50
"""Robots from which on sharing the work among threads pays."""

NO_NOISE = np.empty((3, 0))


class Kernels:
    """The functions of this folder, and the threads that share their work.

    Whatever is chosen, the results are the same to the last bit.

    Args:
        threads: That share the work of 50 robots and more. They only pay with numba.
        compiled: Where numba is installed, compile each function at its first call ever, in
            seconds, and load it from the cache later; else Python runs it.
    """

    def __init__(self, threads: int = 1, *, compiled: bool = True) -> None:
        self.compiled = compiled and bool(numba_version())
        by = partial(fast, kept=CACHE) if self.compiled else partial(plain, scalar=True)
        self._place, self._sonar, self._fans = by(place), by(rays.sonar), by(fans.fans)
        self.spots = by(spots.spots)
        self._blocked, self._step = by(motion.blocked), by(motion.step)
        self._ramp, self._count = by(motion.ramp), by(motion.count)
        self._threads = threads
        self._pool = ThreadPoolExecutor(threads - 1, "kernels") if threads > 1 else None

    def __reduce__(self) -> tuple[Callable[[], "Kernels"], tuple[()]]:
        """Copy what was chosen: each process compiles or loads functions of its own."""
        return partial(Kernels, self._threads, compiled=self.compiled), ()

    def place(self, robots: RobotArrays) -> None:
        """Bring the outlines and the table of `robots` up to date with their poses."""
        self._place(robots.state, robots.arrays)

    def sonar(
        self,
        grid: Grid,
        robots: RobotArrays,
        mounts: Mounts,
        limit: float,
        *,
        echoes: Reflectors = ALL,
        owners: Int32 | None = None,
        out: Float | None = None,
    ) -> Float:
        """Return the range per robot and transducer [m], shape (F, mounts.most).

        The nearest echo counts, of a transducer's rays or of an edge between them; what a ray meets
        first hides what is behind, echo or not. No robot hears itself. Columns that a robot's type
        does not have read `limit`. `mounts` are the transducers of the first robots, and `owners`
        the F robots that listen; `None` means all that `mounts` has.
        """
        poses, layout = robots.poses, mounts.arrays
        if owners is None:
            owners = robots.everyone[: len(mounts.kinds)]
        else:
            # poses[:, owners] would be F-contiguous, and compiled anew in the middle of a run
            poses, layout = poses.take(owners, axis=1), (*layout[:2], mounts.kinds[owners])
        count = len(owners)
        ranges = np.empty((count, mounts.most)) if out is None else out
        walls, others = grid.arrays, robots.arrays
        edges = walls if echoes.edges is None else echoes.edges.arrays
        heard = echoes.steep, echoes.edge_range if echoes.edges else 0.0

        def work(first: int, last: int) -> None:
            self._sonar(
                first, last, limit, heard, poses, owners, layout, walls, edges, others, ranges
            )

        self._share(count, work)
        return ranges

    def cast_fans(
        self,
        grid: Grid,
        robots: RobotArrays,
        fan: Fan,
        limit: float,
        *,
        owners: Int32 | None = None,
        out: Float | None = None,
    ) -> Float:
        """Return the range per laser and beam [m], shape (F, B).

        `owners` are the F robots that carry this laser; `None` means all N.
        """
        lasers = robots.everyone if owners is None else owners
        ranges = np.empty((len(lasers), fan.headings.shape[1])) if out is None else out
        walls, others, poses = grid.arrays, robots.arrays, robots.poses

        def work(first: int, last: int) -> None:
            self._fans(
                first, last, limit, lasers, fan.frame, fan.headings, poses, walls, others, ranges
            )

        self._share(len(lasers), work)
        return ranges

    def blocked(
        self, grid: Grid, robots: RobotArrays, poses: Float, out: Bool | None = None
    ) -> Bool:
        """Return whether each robot would stand on something, shape (N,).

        `poses` are the proposed ones, rows x, y [m], theta [rad], shape (3, N), C-contiguous.
        Touching is free, as in :func:`pioneer3.sim.collision.footprint_hits`. The other robots
        count where they were placed, not where they propose to go.
        """
        hits = np.empty(len(robots), dtype=np.bool_) if out is None else out
        walls, others, state = grid.arrays, robots.arrays, robots.state

        def work(first: int, last: int) -> None:
            self._blocked(first, last, poses, state, walls, others, hits)

        self._share(len(robots), work)
        return hits

    def step(
        self,
        grid: Grid,
        robots: RobotArrays,
        drives: DriveArrays,
        dt: float,
        noise: Float | None = None,
    ) -> None:
        """Let every drive run for `dt` [s], at most `LONGEST`, as far as nothing is in the way.

        Robots move one after the other, so the earlier takes the room. One that something stops
        goes as far as is free, stands, and has its flag `STALLED` set. Poses, drives and outlines
        are those after the step.

        `robots` are in the order of `drives`, then comes what else may be in the way. `noise` are
        standard normal numbers, shape (3, N): for the way, for the turn, and for the drift while
        driving; `None` without random errors.
        """
        errors = NO_NOISE if noise is None else noise
        self._step(dt, errors, drives.arrays, robots.state, grid.arrays, robots.arrays)

    def ramp(self, drives: DriveArrays, dt: float) -> None:
        """Let the velocities that the firmware wants follow their ramps for `dt` [s].

        Nothing moves: that is left to the physics of a world.
        """
        self._ramp(dt, drives.arrays)

    def count(self, drives: DriveArrays, left: Float, right: Float) -> None:
        """Add the ways of the left and right wheels [m], both (N,), to the odometry."""
        self._count(left, right, drives.arrays)

    def _share(self, count: int, work: Callable[[int, int], None]) -> None:
        """Call `work` on `count` rows, in parts if that pays."""
        if self._pool is None or count < WORTH_THREADS:
            work(0, count)
            return
        edges = [count * part // self._threads for part in range(self._threads + 1)]
        others = self._pool.map(work, edges[1:-1], edges[2:])
        work(0, edges[1])
        for _ in others:
            pass


def compiled_kernels(threads: int = 1, begin: Callable[[], None] = lambda: None) -> Kernels:
    """Return kernels that are compiled and loaded.

    This takes seconds the first time ever, which `begin` may tell; about half a second later. Where
    numba is not installed, they are plain.
    """
    kernels = Kernels(threads)
    grid = build_grid(np.array([[1.0, -1.0, 1.0, 1.0]]))
    size = np.array([0.2])
    robots, drives = RobotArrays(size, size, size), DriveArrays.at_rest(1)
    with CACHE.compiling(begin):
        kernels.place(robots)
        kernels.sonar(grid, robots, sonar_mounts([np.zeros((1, 3))], [0]), 2.0)
        kernels.cast_fans(grid, robots, laser_fan((0.0, 0.0, 0.0), 0.0, 1.0, 1), 2.0)
        kernels.blocked(grid, robots, robots.poses)
        surfaces = np.ones(1), np.ones(1, dtype=np.bool_)
        chance, read = (np.zeros(1), np.zeros(1)), np.empty((2, 1))
        kernels.spots(
            (np.ones(1), np.zeros(1, dtype=np.uint8)),
            (1, 0, 1.0, 0.0, 0.0),
            (2.0, 1.0, 1.0),
            surfaces,
            (np.zeros((4, 1)), 0.0, 0.0),
            chance,
            read,
        )
        for noise in (None, np.zeros((3, 1))):
            kernels.step(grid, robots, drives, 0.1, noise)
        kernels.ramp(drives, 0.1)
        kernels.count(drives, np.zeros(1), np.zeros(1))
    return kernels
