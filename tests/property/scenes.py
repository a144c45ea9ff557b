"""Scenes to hold the kernels against their oracles in: strategies, walls and robots."""

from dataclasses import dataclass
from math import inf, pi
from pathlib import Path

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.sim.kernels import Grid, Kernels, RobotArrays, build_grid

Float = NDArray[np.float64]

MAPS = Path(__file__).parents[3] / "shared/maps"

# whole and half numbers make corners, walls along rays and origins on walls likely
COORDINATES = st.one_of(
    st.integers(-4, 4).map(float), st.integers(-8, 8).map(lambda n: n / 2), st.floats(-12, 12)
)
ANGLES = st.one_of(st.integers(-8, 8).map(lambda n: n * np.pi / 4), st.floats(-7, 7))
WALLS = st.lists(st.tuples(*[COORDINATES] * 4), max_size=12).map(
    lambda rows: np.array(rows, dtype=float).reshape(-1, 4)
)
SIZES = st.sampled_from([0.1, 0.25, 0.5])
BODIES = st.lists(st.tuples(COORDINATES, COORDINATES, ANGLES, SIZES, SIZES, SIZES), max_size=5)
LIMITS = st.sampled_from([0.5, 3.0, 8.0, 40.0, inf])
MOUNTS = [np.array([[0.2, 0.0, 0.0], [0.1, 0.1, pi / 2], [-0.2, -0.1, 3.0]]), np.zeros((1, 3))]


# where a corner of a robot is cut off: a share of its smaller side
CUTS = st.sampled_from([0.0, 0.3, 1 - np.tan(pi / 8), 0.999])
ODD_BODIES = st.lists(
    st.tuples(COORDINATES, COORDINATES, ANGLES, SIZES, SIZES, SIZES, CUTS, st.booleans()),
    max_size=5,
)
"""Bodies of which some have cut corners, and some are hidden."""


@dataclass
class Scene:
    """Walls and robots, placed."""

    grid: Grid
    robots: RobotArrays

    def around(self, n: int) -> Float:
        """Return what robot `n` can meet; -1 meets all."""
        return np.concatenate([self.grid.walls, self.others(n)])

    def others(self, n: int) -> Float:
        """Return the sides of the robots that robot `n` can meet."""
        seen = [n != k and not self.robots.hidden[k] for k in range(len(self.robots))]
        return self.robots.outlines[seen].reshape(-1, 4)

    def pose(self, n: int) -> Pose2:
        return Pose2(*self.robots.poses[:, n].tolist())


def scene_of(kernels: Kernels, walls: Float, bodies: list[tuple[float, ...]]) -> Scene:
    """Place bodies x, y, theta, front, rear, half width, and maybe share of cut, hidden."""
    count = len(bodies)
    state = np.array(bodies, dtype=float).reshape(count, -1).T if count else np.zeros((6, 0))
    cut = None
    if len(state) > 6:
        cut = state[6] * np.minimum((state[3] + state[4]) / 2, state[5])
    front, rear, half = state[3:6]
    robots = RobotArrays(front, rear, half, cut)
    robots.state[:3] = state[:3]
    if len(state) > 6:
        robots.hidden[:] = state[7]
    kernels.place(robots)
    return Scene(build_grid(walls), robots)
