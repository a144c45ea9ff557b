"""Drives of a simulated robot to random places of a map: what its laser sees, and the truth."""

from bisect import bisect
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from math import atan2, cos, hypot, inf, pi, radians
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from pioneer3.geometry import ORIGIN, Pose2, wrap
from pioneer3.maps import Extent, LineMap, read_map, shipped_map
from pioneer3.models import load_model
from pioneer3.nav.raster import DistanceField
from pioneer3.sim.body import Body
from pioneer3.sim.kernels import Kernels
from pioneer3.sim.realism import Realism
from pioneer3.sim.world import World
from pioneer3.sim.worldfile import Person
from pioneer3.state import Scan

Float = NDArray[np.float64]

SHARED = Path(__file__).resolve().parents[2] / "shared"
BOXES = {
    "office": Extent(0.0, 0.0, 20.0, 14.0),
    "AMROffice": Extent(-11.3, -4.2, 5.0, 25.0),
    "columbia": Extent(-4.6, -26.5, 19.3, 19.0),
}
"""The maps, and what is inside of them [m]; two are open to the outside."""
CELL = 0.1
"""Of the raster in which ways are found [m]."""
PERIOD, STEP = 0.1, 0.05
"""From scan to scan, and of the world [s]."""
SLICE = 0.005
"""The robot moves in steps of this while a scan is taken [s]."""
AHEAD = 0.4
"""The robot heads for the point of its way so far ahead [m]."""
CLEAR, PATIENCE = 1.2, 30
"""The robot waits for people nearer than this [m], and goes elsewhere after so many steps."""
OVERRUN = 0.5
"""Nobody comes nearer to the middle of the robot [m]."""
SPEED, TURN_RATE = 0.5, 1.0
"""[m/s, rad/s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Conditions:
    """What a laser and the odometry are like.

    Attributes:
        model: Of the robot.
        far: Longest range of the laser [m].
        beams: Of the laser, over a half circle.
        noise: Standard deviation of a range [m].
        short: Share of the beams that end before the wall.
        late: Age of the odometry that comes with a scan [s].
        lasts: Time from the first to the last reading of a scan [s].
        turned: How wrong the laser is mounted [rad].
        people: How many walk about.
    """

    model: str = "p3at-sh"
    far: float = 30.0
    beams: int = 181
    noise: float = 0.005
    short: float = 0.0
    late: float = 0.0
    lasts: float = 0.0
    turned: float = 0.0
    people: int = 0


HARD = Conditions(noise=0.02, short=0.01, late=0.05, lasts=0.025, turned=radians(2), people=5)


@dataclass(frozen=True, slots=True, eq=False)
class Seen:
    """A scan, with the pose of the robot in the world at its last reading."""

    scan: Scan
    robot_in_world: Pose2


class Places:
    """Where a robot can drive within a box, and the ways there."""

    def __init__(self, line_map: LineMap, box: Extent, clear: float) -> None:
        field = DistanceField.of(line_map.walls, box, CELL, 1.0)
        self._raster = field.raster
        height, width = self._raster.shape
        rows = self._raster.y + (np.arange(height) + 0.5) * CELL
        columns = self._raster.x + (np.arange(width) + 0.5) * CELL
        inside = np.outer(
            (rows > box.y_min) & (rows < box.y_max), (columns > box.x_min) & (columns < box.x_max)
        )
        distances = field.reach + field.distances
        free = inside & (distances > clear)
        labels, _ = ndimage.label(free)
        sizes = np.bincount(labels.ravel())
        sizes[0] = 0
        self.free = labels == sizes.argmax()
        self._cost = 1.0 + 4.0 * (1.0 - np.minimum(distances, 0.8) / 0.8)
        self._graph = self._edges()

    def sample(self, rng: np.random.Generator) -> tuple[float, float]:
        """Return a random place [m]."""
        cells = np.argwhere(self.free)
        row, column = cells[rng.integers(len(cells))].tolist()
        return self._raster.middle_of(row, column)

    def is_free(self, x: float, y: float) -> bool:
        """Whether a robot can be at a point [m]."""
        cell = self._raster.cell_of(x, y)
        return cell is not None and bool(self.free[cell])

    def way(self, begin: tuple[float, float], end: tuple[float, float]) -> Float:
        """Return the points of a way [m], shape (N, 2)."""
        width = self.free.shape[1]
        cells = [self._cell(*point) for point in (end, begin)]
        source, at = (row * width + column for row, column in cells)
        _, before = dijkstra(self._graph, indices=source, return_predecessors=True)
        points = []
        while at >= 0:
            points.append(self._raster.middle_of(*divmod(at, width)))
            at = int(before[at])
        return np.array(points)

    def _cell(self, x: float, y: float) -> tuple[int, int]:
        """Return the free cell nearest to a point."""
        cell = self._raster.cell_of(x, y)
        if cell is not None and self.free[cell]:
            return cell
        cells = np.argwhere(self.free)
        middles = (cells[:, ::-1] + 0.5) * CELL + (self._raster.x, self._raster.y)
        row, column = cells[np.hypot(*(middles - (x, y)).T).argmin()].tolist()
        return row, column

    def _edges(self) -> coo_array:
        height, width = self.free.shape
        number = np.arange(height * width).reshape(height, width)
        rows, columns, values = [], [], []
        for dr, dc in ((0, 1), (1, 0), (1, 1), (1, -1)):
            here = slice(0, height - dr), slice(max(0, -dc), width - max(0, dc))
            there = slice(dr, height), slice(max(0, dc), width - max(0, -dc))
            both = self.free[here] & self.free[there]
            rows.append(number[here][both])
            columns.append(number[there][both])
            values.append((hypot(dr, dc) * (self._cost[here] + self._cost[there]) / 2)[both])
        i, j, v = (np.concatenate(part) for part in (rows, columns, values))
        size = height * width
        both_ways = np.concatenate([i, j]), np.concatenate([j, i])
        return coo_array((np.concatenate([v, v]), both_ways), shape=(size, size)).tocsr()


def map_of(name: str) -> LineMap | None:
    """Return a map, `None` if it is not here."""
    if name == "office":
        return shipped_map("office")
    path = SHARED / "maps" / f"{name}.map"
    return read_map(path) if path.exists() else None


def drive(
    name: str,
    line_map: LineMap,
    seconds: float,
    seed: int,
    conditions: Conditions,
    *,
    meddled: Callable[[float, Body, Places], bool] | None = None,
) -> Iterator[Seen]:
    """Yield what a robot sees that drives to random places of a map.

    While somebody has `meddled` with it, at a time [s], the robot does not steer.
    """
    rng = np.random.default_rng(seed)
    model = load_model(conditions.model)
    places = Places(line_map, BOXES[name], model.radius + 0.05)
    body = Body(model)
    realism = replace(Realism(), laser_noise=conditions.noise)
    world = World(line_map, [body], Kernels(), seed=seed, realism=realism)
    body.robot_in_world = Pose2(*places.sample(rng), float(rng.uniform(-pi, pi)))
    body.ghost = bool(conditions.people)  # else people and robot wait for each other for ever
    body.enable_motors(on=True)
    for _ in range(conditions.people):
        path = places.way(places.sample(rng), places.sample(rng))[::10]
        points = tuple((x, y) for x, y in path.tolist())
        world.add_obstacle(Person(path=points, speed=float(rng.uniform(0.4, 1.0)), loop=False))
    driver, laser = _Driver(world, body, places, rng), _Laser(world, body, conditions, rng)
    for number in range(int(seconds / PERIOD)):
        seen = laser.scan(number)
        if not driver.is_overrun():
            yield seen
        left = PERIOD - conditions.lasts
        while left > 1e-6:
            if meddled and meddled(world.time, body, places):
                driver.forget()
            else:
                driver.steer()
            laser.step(min(STEP, left))
            left -= STEP


class _Driver:
    """Steers along ways, by the truth."""

    def __init__(self, world: World, body: Body, places: Places, rng: np.random.Generator) -> None:
        self._world, self._body, self._places, self._rng = world, body, places, rng
        self._way, self._at = np.empty((0, 2)), 0
        self._waited = self._stuck = self._backing = 0
        self._before: Pose2 | None = None

    def steer(self) -> None:
        """Head for a point of the way; turn on the spot where it lies aside."""
        body, here = self._body, self._body.robot_in_world
        place = here.x, here.y
        while not len(self._way) or np.hypot(*(self._way[-1] - place)) < 0.2:
            self._way, self._at = self._places.way(place, self._places.sample(self._rng)), 0
        off = np.hypot(*(self._way[self._at : self._at + 20] - place).T)
        self._at += int(off.argmin())
        ahead = self._way[min(len(self._way) - 1, self._at + round(AHEAD / CELL))]
        turn = wrap(atan2(ahead[1] - here.y, ahead[0] - here.x) - here.theta)
        speed = SPEED * max(0.0, cos(turn)) ** 3 if abs(turn) < 1.0 else 0.0
        self._waited = self._waited + 1 if self._blocked(here) else 0
        if self._waited:
            speed = 0.0
        moved = (self._before.inverse() @ here) if self._before else here
        self._before = here
        still = abs(moved.x) + abs(moved.y) + abs(moved.theta) < 1e-4 and not self._waited
        self._stuck = self._stuck + 1 if still else 0
        if self._stuck > PATIENCE:
            self._backing = PATIENCE
        if self._backing:
            self._backing -= 1
            speed, turn = -SPEED / 2, 0.0
        if self._waited % PATIENCE == PATIENCE - 1 or self._backing == 1:
            self._way = np.empty((0, 2))
        body.drive.linear.go(speed)
        body.drive.angular.go(min(max(2.0 * turn, -TURN_RATE), TURN_RATE))

    def forget(self) -> None:
        """Choose another way from wherever the robot is then."""
        self._way = np.empty((0, 2))

    def is_overrun(self) -> bool:
        """Whether somebody walks through the robot, as nobody can."""
        here = self._body.robot_in_world
        where = [person.pose for person in self._world.obstacles]
        return any(hypot(at.x - here.x, at.y - here.y) < OVERRUN for at in where)

    def _blocked(self, here: Pose2) -> bool:
        """Whether somebody is in front."""
        seen = [here.inverse() @ person.pose for person in self._world.obstacles]
        return any(0.0 < at.x < CLEAR and abs(at.y) < CLEAR / 2 for at in seen)


class _Laser:
    """Takes scans while the world goes on, with odometry that may be late."""

    def __init__(
        self, world: World, body: Body, conditions: Conditions, rng: np.random.Generator
    ) -> None:
        self._world, self._body, self._conditions, self._rng = world, body, conditions, rng
        at = body.model.laser
        self._told = Pose2(at.x, at.y, at.theta) if at else ORIGIN
        self._true = self._told @ Pose2(0.0, 0.0, conditions.turned)
        self._odometry: deque[tuple[float, Pose2]] = deque(maxlen=100)
        self._note()

    def step(self, dt: float) -> None:
        """Let time pass."""
        self._world.step(dt)
        self._note()

    def scan(self, number: int) -> Seen:
        """Return a scan that begins now."""
        given, count = self._conditions, self._conditions.beams
        stamp, first = self._world.time, self._late()
        apart, ranges = pi / (count - 1), list[Float]()
        pieces = max(1, round(given.lasts / SLICE))
        for beams in np.array_split(np.arange(count), pieces):
            start = -pi / 2 + apart * int(beams[0])
            ranges.append(
                self._world.laser(self._body, self._true, start, apart, len(beams)).copy()
            )
            if given.lasts:
                self.step(given.lasts / pieces)
        measured = np.concatenate(ranges)
        short = self._rng.random(count) < given.short
        measured[short] *= self._rng.random(int(short.sum()))
        seen = [value if value < given.far else inf for value in measured.tolist()]
        return Seen(
            Scan(
                stamp=stamp,
                sequence=number,
                robot_in_odom=first,
                last_in_odom=self._late() if given.lasts else None,
                sensor_in_robot=self._told,
                angles=tuple((-pi / 2 + apart * np.arange(count)).tolist()),
                ranges=tuple(seen),
                beam_time=given.lasts / (count - 1),
                far=given.far,
            ),
            self._body.robot_in_world,
        )

    def _note(self) -> None:
        self._odometry.append((self._world.time, self._body.robot_in_odom))

    def _late(self) -> Pose2:
        """Return the odometry of as long ago as it is late."""
        due = self._world.time - self._conditions.late
        stamps = [stamp for stamp, _ in self._odometry]
        poses = [pose for _, pose in self._odometry]
        after = min(max(bisect(stamps, due), 1), len(stamps) - 1)
        if len(stamps) < 2 or due >= stamps[-1]:
            return self._body.robot_in_odom
        before, later = poses[after - 1], poses[after]
        passed = stamps[after] - stamps[after - 1]
        share = min(max((due - stamps[after - 1]) / passed, 0.0), 1.0)
        step = before.inverse() @ later
        return before @ Pose2(share * step.x, share * step.y, share * step.theta)
