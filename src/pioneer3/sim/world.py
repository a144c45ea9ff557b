"""The simulated world: walls, robots, time. `step(dt)` and nothing else moves it."""

from collections.abc import Iterable, Sequence
from functools import lru_cache
from math import ceil

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.sim.body import Body
from pioneer3.sim.kernels import (
    Fan,
    Kernels,
    Robots,
    build_grid,
    laser_fan,
    load_kernels,
    sonar_mounts,
)
from pioneer3.sim.maps import LineMap, empty_map
from pioneer3.sim.motion import SUBSTEP
from pioneer3.sim.sensors import LASER_RANGE, SONAR_MIN, SONAR_RANGE

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]

BISECTIONS = 6
"""How finely the free part of a blocked motion is sought: to 1/64 of it."""
NEGLIGIBLE = 1e-4
"""A blocked motion shorter than this [m and rad] is not taken at all."""


class World:
    """Robots among walls.

    Args:
        line_map: What stands still; `None` is an empty plane.
        robots: What moves.
        kernels: Cast the rays and test the footprints; numpy's if not given.

    Attributes:
        map: What stands still.
        robots: What moves.
        time: Since the beginning [s].
    """

    def __init__(
        self,
        line_map: LineMap | None = None,
        robots: Iterable[Body] = (),
        kernels: Kernels | None = None,
    ) -> None:
        self.map = line_map or empty_map()
        self.robots = tuple(robots)
        self.time = 0.0
        self._kernels = kernels or load_kernels("numpy")
        self._grid = build_grid(self.map.walls)
        models = [body.model for body in self.robots]
        self._placed = Robots(
            np.array([model.length_front for model in models]),
            np.array([model.length_rear for model in models]),
            np.array([model.width / 2 for model in models]),
        )
        types = {model.sonars: number for number, model in enumerate(models)}
        kinds = {sonars: number for number, sonars in enumerate(types)}
        self._mounts = sonar_mounts(
            [np.array([(m.x, m.y, m.theta) for m in sonars]).reshape(-1, 3) for sonars in kinds],
            [kinds[model.sonars] for model in models],
        )
        self._sonar: tuple[bytes, Float] = (b"", np.empty((0, 0)))

    def step(self, dt: float) -> None:
        """Let `dt` [s] pass. Same steps, same result, to the last bit."""
        pieces = max(1, ceil(dt / SUBSTEP - 1e-9))
        for _ in range(pieces):
            self._move(dt / pieces)
        self.time += dt

    def sonar(self, body: Body) -> Float:
        """Return the ranges that `body`'s transducers measure now [m], shape (M,)."""
        self._place(self._poses())
        where = self._placed.poses.tobytes()
        if where != self._sonar[0]:
            measured = self._kernels.sonar(self._grid, self._placed, self._mounts, SONAR_RANGE)
            self._sonar = where, np.clip(measured, SONAR_MIN, SONAR_RANGE)
        ranges: Float = self._sonar[1][self._index(body), : len(body.model.sonars)]
        return ranges

    def laser(self, body: Body, mount: Pose2, start: float, step: float, count: int) -> Float:
        """Return the ranges [m], shape (count,), of a laser at `mount` on `body`.

        Beams lie `step` [rad] apart, counter-clockwise from `start`, from straight ahead of it.
        """
        self._place(self._poses())
        owner = np.array([self._index(body)], dtype=np.int32)
        fan = _fan(mount, start, step, count)
        ranges = self._kernels.cast_fans(self._grid, self._placed, fan, LASER_RANGE, owners=owner)
        first: Float = ranges[0]
        return first

    def is_free(self, body: Body, pose: Pose2) -> bool:
        """Whether `body` would touch nothing at `pose`."""
        poses = self._poses()
        self._place(poses)
        proposed = poses.copy()
        proposed[:, self._index(body)] = pose.x, pose.y, pose.theta
        return not self._blocked(proposed)[self._index(body)]

    def _move(self, dt: float) -> None:
        """Let every robot that moves go as far as it can."""
        wishes = [_wish(body, dt) for body in self.robots]
        if not any(wishes):
            return
        before = self._poses()
        self._place(before)
        taken = self._free_parts(wishes)
        if len(self.robots) > 1:
            self._take_back_collisions(before, taken)
        for body, wish, motion in zip(self.robots, wishes, taken, strict=True):
            if wish is not None and motion is not None:
                body.advance(motion)
                body.stalled = motion is not wish
                if body.stalled:
                    body.drive.halt()

    def _free_parts(self, wishes: Sequence[Pose2 | None]) -> list[Pose2 | None]:
        """Return as much of each wish as touches nothing; the very same object if all of it."""
        blocked = self._blocked(self._reached(wishes)).tolist()
        best = [
            ORIGIN if stuck and wish else wish for stuck, wish in zip(blocked, wishes, strict=True)
        ]
        tried = [
            wish if stuck and wish and _is_worth_a_search(wish) else None
            for stuck, wish in zip(blocked, wishes, strict=True)
        ]
        low, high = [0.0] * len(tried), [1.0] * len(tried)
        for _ in range(BISECTIONS if any(tried) else 0):
            shares = [(a + b) / 2 for a, b in zip(low, high, strict=True)]
            parts = [w and _share(w, s) for w, s in zip(tried, shares, strict=True)]
            for i, stuck in enumerate(self._blocked(self._reached(parts)).tolist()):
                if parts[i] is not None and not stuck:
                    low[i], best[i] = shares[i], parts[i]
                else:
                    high[i] = shares[i]
        return best

    def _take_back_collisions(self, before: Float, taken: list[Pose2 | None]) -> None:
        """Undo motions that would leave two robots in each other, until none does."""
        while True:
            after = self._reached(taken)
            self._place(after)
            stuck = self._blocked(after).tolist()
            back = [
                i for i, motion in enumerate(taken) if stuck[i] and motion not in {None, ORIGIN}
            ]
            self._place(before)
            if not back:
                return
            for i in back:
                taken[i] = Pose2()

    def _reached(self, motions: Sequence[Pose2 | None]) -> Float:
        """Return the poses after `motions`, each given in its robot's frame, shape (3, N)."""
        poses = [
            body.robot_in_world if motion is None else body.robot_in_world @ motion
            for body, motion in zip(self.robots, motions, strict=True)
        ]
        return _as_array(poses)

    def _poses(self) -> Float:
        return _as_array([body.robot_in_world for body in self.robots])

    def _place(self, poses: Float) -> None:
        if not np.array_equal(self._placed.poses, poses) or not self._placed.box[2] >= 0:
            self._placed.poses[:] = poses
            self._kernels.place(self._placed)

    def _blocked(self, poses: Float) -> Bool:
        return self._kernels.blocked(self._grid, self._placed, poses)

    def _index(self, body: Body) -> int:
        return next(i for i, other in enumerate(self.robots) if other is body)


def _wish(body: Body, dt: float) -> Pose2 | None:
    """Return where the drive wants to go within `dt` [s], in the robot's frame; `None`: nowhere."""
    body.battery.drain(body.drive.linear.velocity, dt)
    if not body.drive.moves:
        body.stalled = False
        return None
    return body.drive.step(dt)


def _share(motion: Pose2, share: float) -> Pose2:
    return Pose2(motion.x * share, motion.y * share, motion.theta * share)


def _is_worth_a_search(motion: Pose2) -> bool:
    return max(abs(motion.x), abs(motion.y), abs(motion.theta)) > NEGLIGIBLE


def _as_array(poses: Sequence[Pose2]) -> Float:
    return np.array([(p.x, p.y, p.theta) for p in poses]).reshape(-1, 3).T.copy()


@lru_cache(maxsize=16)
def _fan(mount: Pose2, start: float, step: float, count: int) -> Fan:
    return laser_fan((mount.x, mount.y, mount.theta), start, step, count)
