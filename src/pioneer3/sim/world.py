"""The simulated world: walls, robots, time. `step(dt)` and nothing else moves it."""

from collections.abc import Iterable
from math import ceil, hypot

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.sim.body import Body
from pioneer3.sim.collision import footprint_hits
from pioneer3.sim.grid import WallGrid
from pioneer3.sim.maps import LineMap, empty_map
from pioneer3.sim.motion import SUBSTEP
from pioneer3.sim.sensors import LASER_RANGE, SONAR_RANGE, laser_ranges, sonar_ranges

Float = NDArray[np.float64]

MANY_WALLS = 2000
"""In maps with more of them, laser beams walk the grid instead of meeting every wall."""
NO_WALLS = np.empty((0, 4))
BISECTIONS = 6
"""How finely the free part of a blocked step is sought: to 1/64 of it."""


class World:
    """Robots among walls.

    Attributes:
        map: What stands still.
        robots: What moves.
        time: Since the beginning [s].
    """

    def __init__(self, line_map: LineMap | None = None, robots: Iterable[Body] = ()) -> None:
        self.map = line_map or empty_map()
        self.robots = list(robots)
        self.time = 0.0
        self._grid = WallGrid(self.map.walls)

    def step(self, dt: float) -> None:
        """Let `dt` [s] pass. Same steps, same result, to the last bit."""
        pieces = max(1, ceil(dt / SUBSTEP - 1e-9))
        for _ in range(pieces):
            for body in self.robots:
                self._move(body, dt / pieces)
        self.time += dt

    def sonar(self, body: Body) -> Float:
        """Return the ranges that `body`'s transducers measure now [m], shape (M,)."""
        reach = SONAR_RANGE + body.model.radius
        return sonar_ranges(body.robot_in_world, body.model.sonars, self._seen(body, reach))

    def laser(self, body: Body, mount: Pose2, angles: Float) -> Float:
        """Return the ranges [m], shape (B,), of a laser at `mount` on `body`.

        `angles` [rad], shape (B,), count from straight ahead of the laser.
        """
        pose = body.robot_in_world @ mount
        near = self._others(pose, LASER_RANGE, body)
        if len(self.map.walls) < MANY_WALLS:
            return laser_ranges(pose, angles, np.concatenate((self.map.walls, *near)))
        origins = np.broadcast_to((pose.x, pose.y), (len(angles), 2))
        ranges = self._grid.cast(origins, angles + pose.theta, LASER_RANGE)
        return np.minimum(ranges, laser_ranges(pose, angles, np.concatenate((NO_WALLS, *near))))

    def is_free(self, body: Body, pose: Pose2) -> bool:
        """Whether `body` would touch nothing at `pose`."""
        model = body.model
        reach = hypot(max(model.length_front, model.length_rear), model.width / 2)
        walls = self._around(pose, reach, body)
        return not footprint_hits(
            pose, model.length_front, model.length_rear, model.width / 2, walls
        )

    def _move(self, body: Body, dt: float) -> None:
        drive = body.drive
        body.battery.drain(drive.linear.velocity, dt)
        if not drive.moves:
            body.stalled = False
            return
        motion = drive.step(dt)
        free = self._free_part(body, motion)
        body.advance(free)
        body.stalled = free is not motion
        if body.stalled:
            drive.halt()

    def _free_part(self, body: Body, motion: Pose2) -> Pose2:
        """Return as much of `motion` as touches nothing; the very same object if all of it."""
        if self.is_free(body, body.robot_in_world @ motion):
            return motion
        low, high, best = 0.0, 1.0, Pose2()
        for _ in range(BISECTIONS):
            share = (low + high) / 2
            part = Pose2(motion.x * share, motion.y * share, motion.theta * share)
            if self.is_free(body, body.robot_in_world @ part):
                low, best = share, part
            else:
                high = share
        return best

    def _seen(self, body: Body, reach: float) -> Float:
        return self._around(body.robot_in_world, reach, body)

    def _around(self, pose: Pose2, reach: float, body: Body) -> Float:
        """Return walls and outlines of other robots that come within `reach` [m] of `pose`."""
        walls = self._grid.near(pose.x, pose.y, reach)
        others = self._others(pose, reach, body)
        return np.concatenate((walls, *others)) if others else walls

    def _others(self, pose: Pose2, reach: float, body: Body) -> list[Float]:
        """Return the outlines of the other robots that come within `reach` [m] of `pose`."""
        return [
            outline(other)
            for other in self.robots
            if other is not body
            and hypot(other.robot_in_world.x - pose.x, other.robot_in_world.y - pose.y)
            < reach + other.model.radius + other.model.length_rear
        ]


def outline(body: Body) -> Float:
    """Return the four sides of a robot's footprint in the world [m], shape (4, 4)."""
    model, pose = body.model, body.robot_in_world
    front, rear, half = model.length_front, -model.length_rear, model.width / 2
    corners = [
        pose @ Pose2(x, y) for x, y in ((front, half), (rear, half), (rear, -half), (front, -half))
    ]
    return np.array(
        [(a.x, a.y, b.x, b.y) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]
    )
