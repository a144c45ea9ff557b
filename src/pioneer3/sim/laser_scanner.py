"""A laser range finder on a robot: its mirror turns while the robot drives.

Each reading is of the place where the robot is at that reading's time, so a robot that turns gets a
bent scan. A robot's poses are known at the ends of steps of the world and taken to be a straight
line between them. Rays are cast in pieces: over a piece the laser turns, but does not move.

A reading looks at a spot, not at a point: three rays, at the spot's middle and both of its edges,
tell how the surface slants and whether an edge divides the spot (docs/explanation/realism.md,
"Range finders").
"""

from collections import deque
from dataclasses import dataclass
from functools import lru_cache
from math import ceil, floor, hypot, inf

import numpy as np

from pioneer3.arrays import Float
from pioneer3.geometry import ORIGIN, Pose2, wrap
from pioneer3.maps.materials import MATT, REFERENCE, REMISSION
from pioneer3.models.lasers import LaserModel
from pioneer3.sim.body import Body
from pioneer3.sim.kernels import Fan
from pioneer3.sim.sensing import MOST_SEEN
from pioneer3.sim.world import World

PIECE = 2.5e-3
"""Rays of so much time start at one place [s]: at 1 m/s within 1.25 mm of the true one."""
JUMP = 0.5
"""A robot that is this far away after a step was put there by hand [m]."""
MOST_RAYS = 8
"""From one reading to the next, and from the middle of a spot to its edge, there are at most so
many rays."""
CLOSEST = 1.0
"""Nearer spots are no wider, seen from the laser, than one at this range [m]."""
DARK_SHARE = 1 / 3
"""Range to dark surfaces over the longest one, where the maker does not say: light fades with the
square of the range, and 90 % of remission give the longest."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Arc:
    """The readings that a turn of the mirror takes.

    The direction of the first one is from straight ahead of the laser, the step counter-clockwise
    [rad]; from one to the next it takes `beam_time` [s].
    """

    first: float
    step: float
    count: int
    beam_time: float

    @property
    def duration(self) -> float:
        """From the first reading to the last [s]."""
        return (self.count - 1) * self.beam_time


class LaserScanner:
    """One laser on a robot.

    It is where the model of `body` says, or at its pose; its errors are those of the world's
    realism. Readings that a host stamps too late by the model's delay are of where the robot was
    so long before their time.
    """

    def __init__(self, world: World, body: Body, model: LaserModel) -> None:
        self.model = model
        self._world, self._body = world, body
        at = body.model.laser
        self._mount = Pose2(at.x, at.y, at.theta) if at else ORIGIN
        self._delay = max(at.delay, 0.0) if at else 0.0
        self._rng = world.generator(body)
        self._errors = world.realism.range_finder
        bands = [(each.up_to, each.systematic, each.share, each.sigma) for each in model.errors]
        self._bands = np.array(bands).T.copy()
        self._lasting = self._rng.uniform(-1.0, 1.0) * self._errors.systematic
        self._since = self._time = world.time
        self._before = self._pose = body.robot_in_world
        self._poses = deque([(world.time, self._pose)])
        self._lay_out(Arc(first=0.0, step=model.step, count=1, beam_time=0.0))
        self._began, self._cast = inf, 0

    def begin(self, arc: Arc, began: float) -> None:
        """Begin a turn whose first reading is at `began` [s], not before the last but one `now`."""
        if arc != self._arc:
            self._lay_out(arc)
        self._began, self._cast = began, 0

    def _lay_out(self, arc: Arc) -> None:
        """Make room for the rays of a turn."""
        self._arc = arc
        self._per_step, self._aside = self._rays_of_spots() if self._errors.spot else (1, 0)
        self._apart = arc.step / self._per_step
        rays = (arc.count - 1) * self._per_step + 1 + 2 * self._aside
        self._ranges, self._codes = np.empty(rays), np.zeros(rays, dtype=np.uint8)
        angles = arc.first + self._apart * np.arange(-self._aside, rays - self._aside)
        self._headings = np.stack([np.cos(angles), np.sin(angles)])
        self._fan_at_rest = lru_cache(maxsize=MOST_SEEN)(self._fan)

    def look(self, now: float) -> bool:
        """Take the readings up to `now`, the world's time [s]; return whether all are taken.

        It must be called after every step of the world, and may be called again.
        """
        if now > self._time:
            self._since, self._before = self._time, self._pose
            self._poses.append((now, self._body.robot_in_world))
            while len(self._poses) > 1 and self._poses[1][0] <= now - self._delay:
                self._poses.popleft()
            self._time, self._pose = now, self._poses[0][1]
            if len(self._poses) > 1:
                self._pose = _Motion(*self._poses[0], *self._poses[1]).pose_at(now - self._delay)
            if hypot(self._pose.x - self._before.x, self._pose.y - self._before.y) > JUMP:
                self._before = self._pose
        due = self._rays_until(now)
        if due > self._cast:
            motion = _Motion(self._since, self._before, now, self._pose)
            for first, end in self._pieces(due, moving=self._before != self._pose):
                self._look_along(first, end, motion)
            self._cast = due
        return self._cast == len(self._ranges)

    def readings(self) -> tuple[Float, Float]:
        """Return the readings of a turn of which all are taken, with the errors of the laser.

        They are ranges [m], `inf` where nothing came back, and intensities: the share of the light
        of a perfect matt white wall, 0 for nothing; both of shape (count,).
        """
        model, errors, count = self.model, self._errors, self._arc.count
        read = np.empty((2, count))
        self._world.kernels.spots(
            (self._ranges, self._codes),
            (self._per_step, self._aside, self._apart, model.divergence, model.spot),
            (model.far, model.far_dark or DARK_SHARE * model.far, REFERENCE),
            (REMISSION, MATT),
            (self._bands, self._lasting, errors.noise),
            (
                self._rng.random(count) if errors.spot else np.zeros(count),
                self._rng.standard_normal(count) if errors.noise else np.zeros(count),
            ),
            read,
        )
        return read[0], read[1]

    def _rays_of_spots(self) -> tuple[int, int]:
        """Return the number of rays for each reading, and at most aside of a spot's middle."""
        step, smallest = self._arc.step, self.model.divergence / 2
        per_step = min(max(ceil(step / smallest), 2), MOST_RAYS)
        widest = smallest + self.model.spot / CLOSEST / 2
        return per_step, min(max(ceil(widest * per_step / step), 1), MOST_RAYS)

    def _rays_until(self, now: float) -> int:
        """Return how many rays are due at `now` [s]."""
        if now < self._began:
            return 0
        total = len(self._ranges)
        if now >= self._began + self._arc.duration:
            return total
        passed = (now - self._began) / self._arc.beam_time * self._per_step
        return min(floor(passed) + 1 + self._aside, total)

    def _pieces(self, due: int, *, moving: bool) -> list[tuple[int, int]]:
        """Return the first ray, and the one after the last, of each piece of those to cast."""
        most = due - self._cast
        if moving and self._arc.beam_time:
            most = max(1, int(PIECE / self._arc.beam_time * self._per_step))
        return [(first, min(first + most, due)) for first in range(self._cast, due, most)]

    def _look_along(self, first: int, end: int, motion: "_Motion") -> None:
        """Cast the rays `first` to `end`, without `end`, from where the robot was then."""
        moves = motion.begin != motion.end or self._poses[-1][1] != motion.end
        fan = self._fan(first, end, motion) if moves else self._fan_at_rest(first, end)
        self._ranges[first:end], self._codes[first:end] = self._world.look(
            self._body, fan, self.model.far
        )

    def _fan(self, first: int, end: int, motion: "_Motion | None" = None) -> Fan:
        """Return the rays `first` to `end`, without `end`, of a robot in motion or at rest."""
        mount, headings = self._mount, self._headings[:, first:end]
        start, apart = self._arc.first + (first - self._aside) * self._apart, self._apart
        if motion is not None:
            each = self._arc.beam_time / self._per_step
            half = (end - 1 - first) / 2
            turned = motion.rate * each  # by the robot, from one ray to the next
            at = motion.pose_at(self._began + (first - self._aside + half) * each)
            # World looks from the present pose of the robot; seen from there the laser was here
            mount = self._poses[-1][1].inverse() @ at @ mount
            start, apart = start - turned * half, apart + turned
            if turned:
                angles = start + apart * np.arange(end - first)
                headings = np.stack([np.cos(angles), np.sin(angles)])
        return Fan(
            np.array([mount.x, mount.y, mount.theta, start, apart]), np.ascontiguousarray(headings)
        )


@dataclass(frozen=True, slots=True)
class _Motion:
    """A robot's way from one pose to another, in a straight line and at a constant rate."""

    since: float
    begin: Pose2
    until: float
    end: Pose2

    @property
    def rate(self) -> float:
        """Rate of turn [rad/s]."""
        passed = self.until - self.since
        return wrap(self.end.theta - self.begin.theta) / passed if passed > 0 else 0.0

    def pose_at(self, time: float) -> Pose2:
        """Return the pose at `time` [s]; before and after as it was then."""
        passed = self.until - self.since
        share = min(max((time - self.since) / passed, 0.0), 1.0) if passed > 0 else 1.0
        return Pose2(
            self.begin.x + share * (self.end.x - self.begin.x),
            self.begin.y + share * (self.end.y - self.begin.y),
            wrap(self.begin.theta + share * wrap(self.end.theta - self.begin.theta)),
        )
