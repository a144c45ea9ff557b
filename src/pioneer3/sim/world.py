"""The simulated world: walls, robots, obstacles, time. `step(dt)` and nothing else lets time pass.

A world keeps its robots' numbers side by side in arrays, so that a step costs little for one robot
and little more for a thousand. A :class:`~pioneer3.sim.body.Body` is a view of one of them.
"""

from collections.abc import Iterable, Sequence
from concurrent.futures import Future
from functools import lru_cache, partial
from math import ceil, radians

import numpy as np
from numpy.random import Generator, SeedSequence, default_rng

from pioneer3.arrays import Float, Int, Int32
from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap, empty_map
from pioneer3.maps.materials import Codes
from pioneer3.sim.body import Body, Bumpers, outline_of
from pioneer3.sim.dynamics import Dynamics, PlanarDynamics
from pioneer3.sim.kernels import (
    DriveArrays,
    Fan,
    Kernels,
    Mounts,
    RobotArrays,
    build_grid,
    laser_fan,
)
from pioneer3.sim.kernels.drives import LONGEST, SUPPLY
from pioneer3.sim.obstacles import Obstacle
from pioneer3.sim.realism import Realism
from pioneer3.sim.relief import FLAT, Relief
from pioneer3.sim.sensors import LASER_RANGE, Firing, ImuReading
from pioneer3.sim.sonar import SequentialSonars, SimultaneousSonars, Sonars
from pioneer3.sim.worldfile import Box, Person

NOISE_STEPS = 64
"""Random numbers are drawn for so many steps at once."""
CHARGE_POWER = 60.0
"""Power of a charging station [W]."""
DOCKED = 0.15
"""Distance from a dock within which a robot is charged [m]."""
DOCKED_ANGLE = radians(20)
"""Angle from a dock's pose within which it is charged [rad]."""


class World:
    """Robots among walls; without a map on an empty plane.

    The same seed and the same steps give the same world to the last bit; `None` takes another seed
    each time. Wheels and sensors are as wrong as the realism says, not at all if not given; robots
    and boxes move on a plane, which does not look at the relief, unless other dynamics are given.
    Kernels may be replaced at any time: all compute the same; if not given, Python runs them.

    `time` is that since the beginning [s]. The robots are in the order of the arrays: of their
    `drives`, (.., N), and of `outlines`, poses and sizes of the N robots, then of the obstacles.
    Who writes poses into it sets its `stale`.
    """

    def __init__(
        self,
        line_map: LineMap | None = None,
        robots: Iterable[Body] = (),
        kernels: Kernels | None = None,
        *,
        seed: int | None = 0,
        realism: Realism | None = None,
        dynamics: Dynamics | None = None,
        relief: Relief = FLAT,
    ) -> None:
        self.kernels = kernels or Kernels(compiled=False)
        self.dynamics = dynamics or PlanarDynamics()
        self.realism = realism or Realism.ideal()
        self.time = 0.0
        self.robots: tuple[Body, ...] = ()
        self.obstacles: tuple[Obstacle, ...] = ()
        self._seeds = SeedSequence(seed)
        self._rng, self._own = default_rng(self._seeds.spawn(1)[0]), dict[Body, Generator]()
        self._noise = np.empty((0, 3, 0))
        self._noise_at = 0
        self._working: Future[None] | None = None
        self._sensing = self.dynamics.new_sensing(self.realism.sonar)
        self._sonars = self._new_sonars(self.realism)
        self.change_map(line_map or empty_map(), relief)
        self._rearrange((*robots,), ())

    def step(self, dt: float) -> None:
        """Let `dt` [s] pass; nothing happens if that is not above 0."""
        if not dt > 0:
            return
        pieces = max(1, ceil(dt / LONGEST - 1e-9))
        for _ in range(pieces):
            self._step(dt / pieces)
        self.time += dt

    @property
    def is_still(self) -> bool:
        """Whether nothing moves, or is about to, unless somebody tells it to."""
        return self.dynamics.is_still and not any(each.walks for each in self.obstacles)

    def start(self, dt: float) -> Future[None] | None:
        """Begin to let `dt` [s] pass on another thread; :meth:`finish` ends that.

        Meanwhile robots and obstacles may be put elsewhere, come and go. `dt` is at most
        :data:`~pioneer3.sim.kernels.drives.LONGEST`. Return `None` if it takes so little time that
        :meth:`step` is better.
        """
        self._place()
        self._working = self.dynamics.start(self.kernels, dt)
        return self._working

    def finish(self, dt: float) -> None:
        """End the step that :meth:`start` has begun."""
        self._settle()
        self._passed(dt)
        self.time += dt

    def sonar(self, body: Body) -> Float:
        """Return what `body`'s transducers have measured last [m], shape (M,).

        That is now, unless they fire in turn (`SonarErrors.cycle`).
        """
        self._place()
        return self._sonars.ranges(body)

    def sonars(self) -> Float:
        """Return the same of all robots, shape (N, M).

        M is the number of transducers of the robot that has most; others' last columns read the
        longest range.
        """
        self._place()
        return self._sonars.all_ranges()

    def fresh_sonar(self, body: Body) -> tuple[Int, Float]:
        """Return number, ascending, and range of each transducer that fired since the last call.

        Both are of shape (F,) [m]; where all fire at once, those of all that do.
        """
        self._place()
        return self._sonars.new_ranges(body)

    def fire(self, body: Body, firing: Firing) -> None:
        """Let `body`'s transducers fire in another order; those that are not in it are off."""
        if body.firing != firing:
            body.firing = firing
            if body in self._own:
                self._sonars.change_firing(body)

    def expect(self, bodies: Iterable[Body]) -> None:
        """Be told whose sonars are asked for until the next step: one cast then does for all."""
        self._sonars.expect(bodies)

    def laser(self, body: Body, mount: Pose2, start: float, step: float, count: int) -> Float:
        """Return the ranges [m], shape (count,), of a laser at `mount` on `body`.

        Beams lie `step` [rad] apart, counter-clockwise from `start`, from straight ahead of it.
        """
        owner = np.array([body.number], dtype=np.int32)
        ranges = self._seen(_fan(mount, start, step, count), LASER_RANGE, owner, self._own[body])
        first: Float = ranges[0]
        return first

    def lasers(self, fan: Fan, limit: float = LASER_RANGE) -> Float:
        """Return what a laser on every robot measures now [m], shape (N, beams)."""
        return self._seen(fan, limit, self._everyone, self._rng)

    def sight(self, body: Body, mount: Pose2, start: float, step: float, count: int) -> Float:
        """Return the exact ranges [m] as an eye sees, which meets the bodies of people.

        The arguments are those of :meth:`laser`. It takes no random numbers.
        """
        self._place()
        fan, owner = _fan(mount, start, step, count), np.array([body.number], dtype=np.int32)
        ranges: Float = self._sensing.fans(self.kernels, fan, LASER_RANGE, owner, "bodies")[0]
        return ranges

    def look(self, body: Body, fan: Fan, limit: float) -> tuple[Float, Codes]:
        """Return the exact range [m], at most `limit`, and the material at the end of each beam.

        Light goes through glass that it does not meet nearly at a right angle. It takes no random
        numbers. The code of nothing is that of a plain wall.
        """
        self._place()
        return self._sensing.look(self.kernels, fan, limit, body.number)

    def imu(self, body: Body) -> ImuReading:
        """Return the reading of an exact gyro and accelerometer on `body`."""
        self._place()
        return self.dynamics.imu(body.number)

    def generator(self, body: Body) -> Generator:
        """Return a new random generator for a sensor of `body`; no other numbers change."""
        return self._own[body].spawn(1)[0]

    def is_free(self, body: Body, pose: Pose2) -> bool:
        """Whether `body` would touch nothing at `pose`."""
        self._place()
        proposed = self.outlines.poses.copy()
        proposed[:, body.number] = pose.x, pose.y, pose.theta
        hits = self.kernels.blocked(self._grid, self.outlines, proposed)
        return not hits[body.number]

    def add(self, body: Body) -> None:
        """Put one more robot into the world, after the others."""
        self._rearrange((*self.robots, body), self.obstacles)

    def remove(self, body: Body) -> None:
        """Take a robot away; it goes on alone, in no world."""
        robots = tuple(other for other in self.robots if other is not body)
        self._rearrange(robots, self.obstacles)
        outlines = outline_of(body.model)
        outlines.state[:, 0] = body.outlines.state[:, body.number]
        body.bind(body.drives.only(slice(body.number, body.number + 1)), outlines, 0)
        del self._own[body]

    def add_obstacle(self, kind: Box | Person) -> Obstacle:
        """Put a box or a person into the world."""
        return self.add_obstacles([kind])[0]

    def add_obstacles(self, kinds: Iterable[Box | Person]) -> tuple[Obstacle, ...]:
        """Put several at once, which takes no longer than one."""
        added = tuple(Obstacle(kind) for kind in kinds)
        if added:
            self._rearrange(self.robots, (*self.obstacles, *added))
        return added

    def remove_obstacle(self, obstacle: Obstacle) -> None:
        """Take an obstacle away."""
        self._rearrange(self.robots, tuple(o for o in self.obstacles if o is not obstacle))

    def move_obstacle(self, obstacle: Obstacle, pose: Pose2) -> None:
        """Put an obstacle somewhere else; a person goes on walking from there."""
        obstacle.move(pose)
        self._show(obstacle)

    def change_map(self, line_map: LineMap, relief: Relief = FLAT) -> None:
        """Replace what stands still; robots and obstacles stay where they are, on the new ground.

        Raises:
            ConfigError: Physics cannot have a part of it; then all stays as it was.
        """
        self._settle()
        grid = build_grid(line_map.walls)
        self.dynamics.change_map(line_map, grid, relief)
        self.map, self.relief, self._grid = line_map, relief, grid
        docks = [item.pose for item in line_map.objects if item.kind.startswith("Dock")]
        self._docks = np.array([(dock.x, dock.y, dock.theta) for dock in docks]).reshape(-1, 3)
        for body in self.robots:
            body.set_wheel(SUPPLY, 0.0)
        self._sensing.change_map(line_map, self._grid, relief)
        self._sonars.invalidate()
        if self.robots:
            self.outlines.stale = True

    def _step(self, dt: float) -> None:
        """Let at most `LONGEST` pass."""
        self._place()
        noise = self._next_noise() if self._noisy else None
        self.dynamics.step(self.kernels, dt, noise)
        self._passed(dt)

    def _passed(self, dt: float) -> None:
        """Let people walk and sensors measure after the robots have moved for `dt` [s]."""
        if self.obstacles:
            self._walk(dt)
        self._sensing.forget()
        if len(self._docks):
            self._charge()
        self._sonars.advance(dt, self.outlines.poses[:, : len(self.robots)])

    def _walk(self, dt: float) -> None:
        """Let people walk."""
        bodies = self.outlines.state[:, : len(self.robots)]
        for obstacle in self.obstacles:
            if obstacle.walk(dt, bodies):
                self._show(obstacle)

    def _show(self, obstacle: Obstacle) -> None:
        n, pose = len(self.robots) + self.obstacles.index(obstacle), obstacle.pose
        self.outlines.poses[:, n] = pose.x, pose.y, pose.theta
        self.outlines.stale = True

    def _charge(self) -> None:
        """Supply who stands in a dock."""
        self.drives.wheels[SUPPLY] = 0.0
        west, south, east, north, wide, *_ = self.outlines.box.tolist()
        wide, docks = wide + DOCKED, self._docks.tolist()
        if not any(
            west <= x + wide and x <= east + wide and south <= y + wide and y <= north + wide
            for x, y, _ in docks
        ):
            return
        x, y, theta = self.outlines.poses[:, : len(self.robots), None]
        docked = np.hypot(x - self._docks[:, 0], y - self._docks[:, 1]) < DOCKED
        if docked.any():
            docked &= np.cos(theta - self._docks[:, 2]) >= np.cos(DOCKED_ANGLE)
        self.drives.wheels[SUPPLY] = CHARGE_POWER * docked.any(axis=1)

    def _new_sonars(self, realism: Realism) -> Sonars:
        rng = self._rng.spawn(1)[0]
        if realism.sonar.cycle:
            return SequentialSonars(realism.sonar, self._cast, rng)
        return SimultaneousSonars(realism.sonar, self._cast, self._own, rng)

    def _cast(self, mounts: Mounts, owners: Int32 | None) -> Float:
        """Return exact ranges of transducers of some robots or all, shape (F, mounts.most)."""
        if self.outlines.stale:
            self._place()
        return self._sensing.sonar(self.kernels, mounts, owners)

    def _seen(self, fan: Fan, limit: float, owners: Int32, rng: Generator) -> Float:
        self._place()
        ranges = self._sensing.fans(self.kernels, fan, limit, owners)
        sigma = self.realism.laser_noise
        if not sigma:
            return ranges
        noisy = ranges + sigma * rng.standard_normal(ranges.shape)
        return np.where(ranges < limit, noisy.clip(0.0, limit), limit)

    def _settle(self) -> None:
        """Wait for the other thread, if it works, and take over its results."""
        if self._working is not None:
            work, self._working = self._working, None
            work.result()
            self.dynamics.finish(self.kernels)

    def _place(self) -> None:
        self._settle()
        if self.outlines.stale:
            self._sonars.move(self.outlines.poses[:, : len(self.robots)])
            self.dynamics.place()
            self.kernels.place(self.outlines)
            self.outlines.stale = False
            self._sensing.forget()

    def _next_noise(self) -> Float:
        if self._noise_at == len(self._noise):
            self._noise = self._rng.standard_normal((NOISE_STEPS, 3, len(self.robots)))
            self._noise_at = 0
        self._noise_at += 1
        row: Float = self._noise[self._noise_at - 1]
        return row

    def _bumpers(self, body: Body) -> Bumpers:
        """Return the segments of `body`'s bumpers that something presses."""
        self._place()
        return self._sensing.bumpers(body.number)

    def _rearrange(self, robots: tuple[Body, ...], obstacles: Sequence[Obstacle]) -> None:
        """Lay out the arrays anew; everything keeps its state."""
        self._settle()
        models = [body.model for body in robots]
        before = [body.number if body in self._own else -1 for body in robots]
        sizes = [(m.length_front, m.length_rear, m.width / 2, 0.0) for m in models]
        sizes += [obstacle.sizes for obstacle in obstacles]
        self.outlines = RobotArrays(*np.array(sizes).reshape(-1, 4).T)
        drives = DriveArrays.at_rest(0)
        for number, body in enumerate(robots):
            drives = drives.joined(body.drives.only(slice(body.number, body.number + 1)))
            self.outlines.state[:, number] = body.outlines.state[:, body.number]
        for number, obstacle in enumerate(obstacles, len(robots)):
            pose = obstacle.pose
            self.outlines.poses[:, number] = pose.x, pose.y, pose.theta
        self.drives, self.obstacles = drives, tuple(obstacles)
        for number, body in enumerate(robots):
            if body not in self._own:
                self._own[body] = default_rng(self._seeds.spawn(1)[0])
                errors = self.realism.odometry
                if self.dynamics.has_slip:
                    errors = errors.of_wheels
                drives.errors[:, number] = errors.column(body.model, self._own[body])
            body.bind(
                drives,
                self.outlines,
                number,
                bumpers=partial(self._bumpers, body),
                speeds=partial(self.dynamics.speeds, number),
            )
        self.robots = robots
        self._sonars.set_robots(robots, before)
        self._noisy, self._noise, self._noise_at = drives.noisy, np.empty((0, 3, 0)), 0
        self._everyone = self.outlines.everyone[: len(robots)]
        self.dynamics.change_bodies(robots, self.obstacles, drives, self.outlines)
        self._sensing.change_bodies(robots, self.obstacles, self.outlines)


@lru_cache(maxsize=64)
def _fan(mount: Pose2, start: float, step: float, count: int) -> Fan:
    return laser_fan((mount.x, mount.y, mount.theta), start, step, count)
