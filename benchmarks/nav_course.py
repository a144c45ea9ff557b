"""Drives of simulated robots that do not depend on where anything thinks they are.

A robot drives to random places by its true pose, so that all localizers are given the same sensors.
Its odometry, its sonars and its laser err as by default.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from math import atan2, hypot, inf, pi, radians
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.nav_doubtful import doubtful_map
from pioneer3.geometry import Pose2, wrap
from pioneer3.maps import Extent, LineMap, read_map, shipped_map
from pioneer3.models import RobotModel, load_model
from pioneer3.sim.body import Body
from pioneer3.sim.free_space import FreeGrid
from pioneer3.sim.kernels import Kernels
from pioneer3.sim.realism import Realism
from pioneer3.sim.sensors import SONAR_RANGE
from pioneer3.sim.world import World
from pioneer3.sim.worldfile import Person
from pioneer3.state import Scan

Float = NDArray[np.float64]
Int = NDArray[np.int64]

SHARED = Path(__file__).resolve().parents[2] / "shared" / "maps"
BOXES = {
    "AMROffice": Extent(-11.4, -4.1, 3.8, 22.0),
    "columbia": Extent(-4.7, -26.8, 19.4, 19.4),
}
"""The insides of maps that are open outside [m]."""
BESIDE = {"flat": 0.03}
"""Room beside a robot on its ways [m], where doors leave less than 0.1 m."""
MAPS = ("shipped", "office", "AMROffice", "columbia")
FLAT_WIDE, FLAT_DEEP, CORRIDOR, FLAT_DOOR, FLAT_ROOM = 12.0, 9.0, 1.2, 0.75, 4.0
"""Of a flat, of the corridor along its middle, of the doors to it and of its rooms [m]."""
STEP, COARSE = 0.0125, 0.05
"""Of the world where scans take time, and else [s]."""
PERIOD = 0.1
"""From one scan to the next, and from one report to the next [s]."""
SPEED, TURN_RATE = 0.5, 1.0
"""Of the drive [m/s, rad/s]."""
AHEAD = 0.5
"""Robots head for the point of their way that is so far ahead [m]."""
BEAMS, VIEW = 181, pi
"""Of the laser."""
SCAN_TIME = 0.025
"""Of a scan that takes time [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Hardship:
    """Errors beyond the default ones.

    Attributes:
        people: That walk about.
        noise: Standard deviation of the laser's ranges, besides its own [m].
        short: Share of beams that meet nothing of the map.
        late: Age of the odometry that comes with a scan [s].
        scan_time: From the first reading of a scan to the last one [s].
        askew: The laser is mounted so much to the left of what is known [rad].
        far: Longest range of the laser [m].
    """

    people: int = 0
    noise: float = 0.0
    short: float = 0.0
    late: float = 0.0
    scan_time: float = 0.0
    askew: float = 0.0
    far: float = 32.0


EASY = Hardship()
HARD = Hardship(people=5, noise=0.02, short=0.01, late=0.05, scan_time=SCAN_TIME, askew=radians(2))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Moment:
    """What is known at a time, and the truth.

    Attributes:
        time: [s].
        truth: Pose of the robot on the map at `time`.
        odom: Pose by odometry.
        scan: The scan whose last reading is now.
        fresh: Numbers of the transducers that fired since the last moment, shape (F,).
        ranges: Their ranges [m], `inf` where nothing echoed, shape (F,).
    """

    time: float
    truth: Pose2
    odom: Pose2
    scan: Scan
    fresh: Int
    ranges: Float


def flat() -> LineMap:
    """Return a narrow flat: three rooms on either side of a corridor, and doors between some."""
    low, high = (FLAT_DEEP - CORRIDOR) / 2, (FLAT_DEEP + CORRIDOR) / 2
    walls = [[0, 0, FLAT_WIDE, 0], [FLAT_WIDE, 0, FLAT_WIDE, FLAT_DEEP]]
    walls += [[FLAT_WIDE, FLAT_DEEP, 0, FLAT_DEEP], [0, FLAT_DEEP, 0, 0]]
    for number, left in enumerate(np.arange(0.0, FLAT_WIDE, FLAT_ROOM).tolist()):
        for side, y in ((0, low), (1, high)):
            door = left + (1.0 if (number + side) % 2 else 2.4)
            walls += [[left, y, door, y], [door + FLAT_DOOR, y, left + FLAT_ROOM, y]]
            outer = (0.0, FLAT_DEEP)[side]
            if left and side:
                walls.append([left, y, left, outer])
            elif left:  # the lower rooms have doors to each other as well
                middle = y / 2
                walls.append([left, y, left, middle + FLAT_DOOR / 2])
                walls.append([left, middle - FLAT_DOOR / 2, left, outer])
    return LineMap(name="flat", walls=np.array(walls))


@cache
def map_of(name: str) -> LineMap:
    """Return one of :data:`MAPS`, the flat, or one of :mod:`benchmarks.nav_doubtful`."""
    if name == "flat":
        return flat()
    if (doubtful := doubtful_map(name)) is not None:
        return doubtful
    return shipped_map("office") if name == "shipped" else read_map(SHARED / f"{name}.map")


def maps() -> tuple[str, ...]:
    """Return the maps that are there."""
    return tuple(n for n in MAPS if n == "shipped" or (SHARED / f"{n}.map").exists())


class Ways:
    """Places where a robot fits, and shortest ways between them, on a grid.

    Args:
        name: Of the map.
        model: Of the robot.
    """

    def __init__(self, name: str, model: RobotModel) -> None:
        line_map = map_of(name)
        bounds = BOXES.get(name, line_map.bounds)
        half = model.width / 2
        # a robot that follows a way turns on it, except where it is narrow
        self._grid = FreeGrid(line_map.walls, line_map.bounds, half + BESIDE.get(name, 0.1))
        free = self._grid.free.copy()
        centres = self._grid.centres(np.ones_like(free)).reshape(*free.shape, 2)
        low, high = np.array(bounds[:2]) + 0.4, np.array(bounds[2:]) - 0.4
        free &= ((centres > low) & (centres < high)).all(axis=2)
        self._number = np.full(free.shape, -1)
        self._number[free] = np.arange(free.sum())
        self.centres = centres[free]
        self._graph = self._links(free, FreeGrid(line_map.walls, line_map.bounds, half + 0.35).free)
        self.centres_of_turns = self._turning(line_map, model)

    def to(self, goal: int) -> Int:
        """Return for each place the next one on the way to place `goal`, -1 without a way."""
        from scipy.sparse.csgraph import dijkstra

        before: Int = dijkstra(self._graph, indices=goal, return_predecessors=True)[1]
        return before

    def nearest(self, pose: Pose2) -> int:
        """Return the place nearest to a pose."""
        return int(np.hypot(*(self.centres - (pose.x, pose.y)).T).argmin())

    def _links(self, free: NDArray[np.bool_], wide: NDArray[np.bool_]) -> "object":
        from scipy.sparse import coo_matrix

        rows, columns, costs = [], [], []
        price = np.where(wide, 1.0, 3.0)
        height, width = free.shape
        for dy, dx in ((0, 1), (1, 0), (1, 1), (1, -1)):
            a = np.s_[0 : height - dy, max(0, -dx) : width - max(0, dx)]
            b = np.s_[dy:height, max(0, dx) : width + min(0, dx)]
            both = free[a] & free[b]
            rows.append(self._number[a][both])
            columns.append(self._number[b][both])
            costs.append(hypot(dy, dx) * ((price[a] + price[b]) / 2)[both])
        count = int(free.sum())
        r, c, v = (np.concatenate(part) for part in (rows, columns, costs))
        both_ways = (np.concatenate([v, v]), (np.concatenate([r, c]), np.concatenate([c, r])))
        return coo_matrix(both_ways, shape=(count, count)).tocsr()

    def _turning(self, line_map: LineMap, model: RobotModel) -> Int:
        """Return the places of the largest connected part where the robot can turn, shape (P,)."""
        from scipy.sparse.csgraph import connected_components

        part = connected_components(self._graph)[1]
        largest = part == np.bincount(part).argmax()
        circle = FreeGrid(line_map.walls, line_map.bounds, max(model.radius, model.width / 2 + 0.2))
        return np.flatnonzero(largest & circle.are_free(self.centres))


@cache
def ways_of(name: str, model: str) -> Ways:
    """Return the ways of a map for a model."""
    return Ways(name, load_model(model))


class Course:
    """A robot that drives to one random place after the other, for ever.

    Args:
        name: Of the map.
        model: Of the robot.
        seed: Of everything random.
        hardship: Errors beyond the default ones.
    """

    def __init__(self, name: str, model: str, seed: int, hardship: Hardship = EASY) -> None:
        self.line_map, self.hardship = map_of(name), hardship
        self.body = Body(load_model(model))
        self._ways = ways_of(name, model)
        self._rng = np.random.default_rng((seed, 5))
        kernels = Kernels(compiled=True)
        self.world = World(self.line_map, [self.body], kernels, seed=seed, realism=Realism())
        self.put(self.random_pose())
        for _ in range(hardship.people):
            self.world.add_obstacle(self._person())
        self.body.drive.power(on=True)
        self._goal_map: Int | None = None
        self._stuck, self._number, self._retreat = 0.0, 0, (0.0, 0.0, 0.0)
        self._seen_at = self.body.robot_in_world
        self._poses = [(0.0, self.body.robot_in_odom)]

    def random_pose(self) -> Pose2:
        """Return a pose where the robot can turn."""
        x, y = self._ways.centres[self._rng.choice(self._ways.centres_of_turns)].tolist()
        return Pose2(x, y, float(self._rng.uniform(-pi, pi)))

    def put(self, pose: Pose2) -> None:
        """Carry the robot to a pose; its odometry does not notice."""
        self.body.robot_in_world = pose
        self._goal_map = None

    def moments(self, seconds: float) -> Iterator[Moment]:
        """Drive for some time [s]; yield each report."""
        for _ in range(round(seconds / PERIOD)):
            yield self._moment()

    def _moment(self) -> Moment:
        self._steer()
        began = PERIOD - self.hardship.scan_time
        pieces: list[Float] = []
        step = STEP if self.hardship.scan_time else COARSE
        steps = round(PERIOD / step)
        first = self.body.robot_in_odom
        cast = 0
        for number in range(1, steps + 1):
            self.world.step(step)
            self._poses.append((self.world.time, self.body.robot_in_odom))
            passed = number * step
            if self.hardship.scan_time and abs(passed - began) < step / 2:
                first = self._odom_at(self.world.time - self.hardship.late)
            if passed >= began + step / 2 or number == steps:
                share = (passed - began) / self.hardship.scan_time if self.hardship.scan_time else 1
                due = BEAMS if number == steps else round(BEAMS * share)
                pieces.append(self._look(cast, due))
                cast = due
        del self._poses[:-20]
        fresh, ranges = self.world.fresh_sonar(self.body)
        last = self._odom_at(self.world.time - self.hardship.late)
        self._number += 1
        return Moment(
            time=self.world.time,
            truth=self.body.robot_in_world,
            odom=last,
            scan=self._scan(np.concatenate(pieces), first, last),
            fresh=fresh,
            ranges=np.where(ranges >= SONAR_RANGE, inf, ranges),
        )

    def _odom_at(self, time: float) -> Pose2:
        return min(self._poses, key=lambda each: abs(each[0] - time))[1]

    def _look(self, first: int, last: int) -> Float:
        laser, step = self.body.model.laser, VIEW / (BEAMS - 1)
        assert laser is not None
        mount = Pose2(laser.x, laser.y, laser.theta + self.hardship.askew)
        if last <= first:
            return np.empty(0)
        return self.world.laser(self.body, mount, -VIEW / 2 + first * step, step, last - first)

    def _scan(self, ranges: Float, first: Pose2, last: Pose2) -> Scan:
        hardship, rng = self.hardship, self._rng
        if hardship.noise:
            ranges = ranges + hardship.noise * rng.standard_normal(BEAMS)
        if hardship.short:
            ranges = np.where(rng.random(BEAMS) < hardship.short, ranges * rng.random(), ranges)
        laser = self.body.model.laser
        assert laser is not None
        measured = np.where(ranges >= hardship.far - 0.1, inf, ranges)
        takes_time = hardship.scan_time > 0
        return Scan(
            stamp=self.world.time - hardship.scan_time,
            sequence=self._number,
            robot_in_odom=first if takes_time else last,
            last_in_odom=last if takes_time else None,
            sensor_in_robot=Pose2(laser.x, laser.y, laser.theta),
            angles=tuple(np.linspace(-VIEW / 2, VIEW / 2, BEAMS).tolist()),
            ranges=tuple(measured.tolist()),
            beam_time=hardship.scan_time / (BEAMS - 1),
            far=hardship.far,
        )

    def _steer(self) -> None:
        """Set the velocities for the next moment."""
        here, drive = self.body.robot_in_world, self.body.drive
        at = self._ways.nearest(here)
        last = self._seen_at
        if hypot(here.x - last.x, here.y - last.y) + abs(wrap(here.theta - last.theta)) > 0.05:
            self._seen_at, self._stuck = here, 0.0
        self._stuck += PERIOD
        if self._stuck > 1.0:
            speed, turn = 0.2 * self._rng.choice([-1, 1]), self._rng.uniform(-0.7, 0.7)
            self._retreat, self._goal_map, self._stuck = (1.5, float(speed), float(turn)), None, 0.0
        if self._goal_map is None:
            goal = int(self._rng.choice(self._ways.centres_of_turns))
            self._goal_map = self._ways.to(goal)
        x, y = self._ahead(at)
        if hypot(x - here.x, y - here.y) < 0.2 or self._goal_map[at] < 0:
            self._goal_map = None
        off = wrap(atan2(y - here.y, x - here.x) - here.theta)
        turn = float(np.clip(2.0 * off, -TURN_RATE, TURN_RATE))
        speed = SPEED * max(0.0, 1 - abs(off) / 0.8)
        if self._retreat[0] > 0:
            left, speed, turn = self._retreat
            self._retreat = left - PERIOD, speed, turn
        drive.linear.go(speed)
        drive.angular.go(turn)

    def _ahead(self, at: int) -> tuple[float, float]:
        assert self._goal_map is not None
        start = self._ways.centres[at]
        while self._goal_map[at] >= 0 and np.hypot(*(self._ways.centres[at] - start)) < AHEAD:
            at = int(self._goal_map[at])
        x, y = self._ways.centres[at].tolist()
        return x, y

    def _person(self) -> Person:
        """Return somebody who walks to and fro between two places, by a shortest way."""
        a, b = self._rng.choice(self._ways.centres_of_turns, 2).tolist()
        before = self._ways.to(b)
        path = [tuple(self._ways.centres[a].tolist())]
        while before[a] >= 0:
            a = int(before[a])
            path.append(tuple(self._ways.centres[a].tolist()))
        return Person(path=tuple(path[::5]) or tuple(path), loop=False, speed=0.8)


def known_start(truth: Pose2, rng: np.random.Generator, off: float, turned: float) -> Pose2:
    """Return a pose within `off` [m] and `turned` [rad] of the truth."""
    away, bearing = off * float(np.sqrt(rng.random())), float(rng.uniform(-pi, pi))
    x, y = away * np.cos(bearing), away * np.sin(bearing)
    return Pose2(truth.x + x, truth.y + y, wrap(truth.theta + float(rng.uniform(-turned, turned))))
