"""How the robots and boxes of a world move: on a plane, or as bodies with mass."""

from collections.abc import Sequence
from concurrent.futures import Future
from typing import Protocol

import numpy as np

from pioneer3.arrays import Float
from pioneer3.maps import LineMap
from pioneer3.sim.body import Body, Speeds
from pioneer3.sim.kernels import DriveArrays, Grid, Kernels, RobotArrays
from pioneer3.sim.kernels.drives import ANGULAR, LINEAR, REMAINING, TARGET, VELOCITY
from pioneer3.sim.obstacles import Obstacle
from pioneer3.sim.realism import SonarErrors
from pioneer3.sim.relief import Relief
from pioneer3.sim.sensing import PlanarSensing, Sensing
from pioneer3.sim.sensors import GRAVITY, ImuReading
from pioneer3.sim.worldfile.spec import PHYSICS_STEP, Physics


class Dynamics(Protocol):
    """Moves the robots and boxes of a world.

    A world calls :meth:`change_map` before all others, and :meth:`change_bodies` whenever its
    arrays are laid out anew.
    """

    has_slip: bool
    """Whether wheels slip by themselves; of a realism's errors those of their sizes count then."""

    @property
    def is_still(self) -> bool:
        """Whether nothing moves, or is about to, unless somebody tells it to."""

    def new_sensing(self, sonar: SonarErrors) -> Sensing:
        """Return the sensors that belong to these dynamics; `sonar` has the transducers' beam."""

    def change_map(self, line_map: LineMap, grid: Grid, relief: Relief) -> None:
        """Replace all that stands still; ConfigError, and no change, if a part is impossible."""

    def change_bodies(
        self,
        robots: Sequence[Body],
        obstacles: Sequence[Obstacle],
        drives: DriveArrays,
        outlines: RobotArrays,
    ) -> None:
        """Replace robots and obstacles; those that stay keep their state.

        `robots` are in the order of `drives`; `outlines` are those of robots, then of `obstacles`.
        A step changes the drives and the poses of the outlines.
        """

    def place(self) -> None:
        """Take over the poses that others have written into the outlines."""

    def step(self, kernels: Kernels, dt: float, noise: Float | None) -> None:
        """Let `dt` [s] pass, at most `LONGEST`; then outlines and drives are up to date.

        `noise` is as for :meth:`Kernels.step <pioneer3.sim.kernels.Kernels.step>`.
        """

    def start(self, kernels: Kernels, dt: float) -> Future[None] | None:
        """Begin a step on another thread, or return `None` if it is not worth one.

        When the work is done, :meth:`finish` ends the step. Nothing else is called before, but
        poses may be written into the outlines.
        """

    def finish(self, kernels: Kernels) -> None:
        """End the step that :meth:`start` has begun."""

    def speeds(self, number: int) -> Speeds:
        """Return speed and turn rate of robot `number` by its encoders."""

    def imu(self, number: int) -> ImuReading:
        """Return exact rates and accelerations of robot `number`, averaged over a step."""


class PlanarDynamics:
    """`Dynamics` on a plane: robots do what their drives want, up to the first thing they meet."""

    has_slip = False

    def new_sensing(self, sonar: SonarErrors) -> Sensing:
        return PlanarSensing(sonar)

    def change_map(self, line_map: LineMap, grid: Grid, relief: Relief) -> None:
        self._grid = grid

    def change_bodies(
        self,
        robots: Sequence[Body],
        obstacles: Sequence[Obstacle],
        drives: DriveArrays,
        outlines: RobotArrays,
    ) -> None:
        self._drives, self._outlines = drives, outlines
        self._before, self._dt = drives.axes[VELOCITY].copy(), 1.0

    def place(self) -> None:
        pass

    @property
    def is_still(self) -> bool:
        axes = self._drives.axes
        moving = axes[VELOCITY].any() or axes[TARGET].any()
        return not moving and bool(np.isnan(axes[REMAINING]).all())

    def step(self, kernels: Kernels, dt: float, noise: Float | None) -> None:
        self._before[:], self._dt = self._drives.axes[VELOCITY], dt
        kernels.step(self._grid, self._outlines, self._drives, dt, noise)

    def start(self, kernels: Kernels, dt: float) -> Future[None] | None:
        return None

    def finish(self, kernels: Kernels) -> None:
        pass

    def speeds(self, number: int) -> Speeds:
        axes = self._drives.axes
        return axes.item(VELOCITY, LINEAR, number), axes.item(VELOCITY, ANGULAR, number)

    def imu(self, number: int) -> ImuReading:
        v, w = self.speeds(number)
        gained = (v - self._before.item(LINEAR, number)) / self._dt
        return ImuReading((0.0, 0.0, w), (gained, v * w, GRAVITY))


def dynamics_of(physics: Physics, step: float = PHYSICS_STEP) -> Dynamics:
    """Return the dynamics of a world, MuJoCo's with `step` [s]; ConfigError where it is missing."""
    if physics == "planar":
        return PlanarDynamics()
    from pioneer3.sim.physics.dynamics import MujocoDynamics

    return MujocoDynamics(step)
