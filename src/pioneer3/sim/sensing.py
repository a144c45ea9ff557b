"""Measurements of robots' sensors, without errors: on a plane, or in three dimensions."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import cos
from typing import Literal, Protocol

import numpy as np

from pioneer3.arrays import Bool, Float, Int32
from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap
from pioneer3.maps.materials import GLASS, GLASS_ANGLE, PLAIN, Codes, Material, codes_of
from pioneer3.sim.body import Body, Bumpers
from pioneer3.sim.collision import REACH, pressed_segments
from pioneer3.sim.kernels import Fan, Grid, Kernels, Mounts, Reflectors, RobotArrays, build_grid
from pioneer3.sim.kernels.drives import TOUCHED
from pioneer3.sim.obstacles import Obstacle, at_laser_height
from pioneer3.sim.raycast import ranges_reference
from pioneer3.sim.realism import SonarErrors
from pioneer3.sim.relief import Relief
from pioneer3.sim.sensors import SONAR_RANGE
from pioneer3.sim.worldfile import Box

SAME = 1e-5
"""A range this close to that of a wall is its range; above the error of the kernels [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class Surfaces:
    """Walls that are not plain, (S, 4) [m]: of other materials, or of glass.

    There are few of them, so each ray is compared with each: kernels know of no materials. They
    cast rays among all that is not glass; then the glass that a ray meets nearly at a right angle
    is put in front, and rays that end on a black wall or a reflector are found by their range.
    """

    walls: Float
    codes: Codes

    @classmethod
    def among(cls, walls: Float, codes: Codes) -> "Surfaces":
        """Return those of `walls` (W, 4) with `codes` (W,) that are not plain."""
        special = codes != PLAIN
        return cls(walls[special], codes[special])

    @property
    def has_glass(self) -> bool:
        """Whether any wall is of glass."""
        return bool((self.codes == GLASS).any())

    def joined(self, others: "Surfaces") -> "Surfaces":
        """Return these walls and then the others."""
        walls = np.concatenate([self.walls, others.walls])
        return Surfaces(walls, np.concatenate([self.codes, others.codes]))

    def seen(self, origin: Float, angles: Float, ranges: Float) -> tuple[Float, Codes]:
        """Return range [m], glass included, and material at the end of each ray, both (B,).

        Rays start at `origin` (2,) [m] at `angles` (B,) [rad]; `ranges` (B,) are those to the
        nearest wall or robot that is not of glass [m].
        """
        codes = np.full(len(angles), PLAIN, dtype=np.uint8)
        limit = float(ranges.max(initial=0.0)) + 1.0
        alone = ranges_reference(origin, angles, self.walls, limit)
        glass = self.codes == GLASS
        if glass.any():
            alone[:, glass] = np.where(self._in_front(angles, glass), alone[:, glass], limit)
        nearest = alone.argmin(axis=1)
        first = alone[np.arange(len(angles)), nearest]
        met = first <= ranges + SAME
        codes[met] = self.codes[nearest[met]]
        return np.minimum(ranges, first), codes

    def _in_front(self, angles: Float, some: Bool) -> Bool:
        """Return whether each ray looks at `some` of the walls nearly at a right angle."""
        extents = self.walls[some, 2:] - self.walls[some, :2]
        along = np.arctan2(extents[:, 1], extents[:, 0])
        # the sine of the angle between ray and wall is the cosine of that to the normal
        near: Bool = abs(np.sin(angles[:, None] - along)) >= cos(GLASS_ANGLE)
        return near


People = Literal["legs", "bodies"]
"""The part of people that light meets: at the height of a laser, or of an eye."""


@dataclass(frozen=True, slots=True, eq=False)
class SensedWalls:
    """Walls as the kernels sense them: all, those not of glass, those not plain, and echoes."""

    grid: Grid
    opaque: Grid
    surfaces: Surfaces
    echoes: Reflectors

    @classmethod
    def of(cls, walls: Float, codes: Codes, grid: Grid, sonar: SonarErrors) -> "SensedWalls":
        """Return those of `walls` (W, 4) with the materials `codes` (W,), which `grid` is of."""
        surfaces, clear = Surfaces.among(walls, codes), grid
        if surfaces.has_glass:
            clear = build_grid(walls[codes != GLASS])
        return cls(grid=grid, opaque=clear, surfaces=surfaces, echoes=sonar.echoes(grid))


class Sensing(Protocol):
    """Measures for the robots of a world, exactly and without random numbers.

    A world calls :meth:`change_map` before all others, :meth:`change_bodies` whenever its arrays
    are laid out anew, and :meth:`forget` whenever anything may have moved.
    """

    def change_map(self, line_map: LineMap, grid: Grid, relief: Relief) -> None:
        """Replace what stands still; `grid` is of all walls."""

    def change_bodies(
        self, robots: Sequence[Body], obstacles: Sequence[Obstacle], outlines: RobotArrays
    ) -> None:
        """Replace robots and obstacles; `outlines` are of these, in this order."""

    def forget(self) -> None:
        """Discard all that depends on places."""

    def sonar(self, kernels: Kernels, mounts: Mounts, owners: Int32 | None) -> Float:
        """Return ranges of the transducers of some robots or all [m], shape (F, mounts.most)."""

    def fans(
        self, kernels: Kernels, fan: Fan, limit: float, owners: Int32, people: People = "legs"
    ) -> Float:
        """Return the ranges of a laser on each of the F robots `owners` [m], shape (F, B)."""

    def look(
        self, kernels: Kernels, fan: Fan, limit: float, number: int, people: People = "legs"
    ) -> tuple[Float, Codes]:
        """Return range [m] and material at the end of each beam of robot `number`, both (B,).

        Light goes through glass that it does not meet nearly at a right angle. The code of nothing
        is that of a plain wall.
        """

    def bumpers(self, number: int) -> Bumpers:
        """Return the segments of the bumpers of robot `number` that something presses."""


MOST_SEEN = 64
"""Fans of lasers whose ranges are kept while nothing moves."""


class PlanarSensing:
    """`Sensing` on a plane: everything reaches from the floor to the ceiling."""

    def __init__(self, sonar: SonarErrors) -> None:
        self._errors = sonar
        self._places: tuple[bytes, bytes] | None = None
        self._heard: dict[int, tuple[Mounts, Float]] = {}
        self._seen: dict[tuple[Fan, float, int, People], tuple[Float, Codes]] = {}
        self._pressed: dict[int, Bumpers] = {}
        self._met: RobotArrays | None = None

    def change_map(self, line_map: LineMap, grid: Grid, relief: Relief) -> None:
        self._walls = SensedWalls.of(line_map.walls, line_map.materials, grid, self._errors)
        self._places = None

    def change_bodies(
        self, robots: Sequence[Body], obstacles: Sequence[Obstacle], outlines: RobotArrays
    ) -> None:
        self._robots, self._obstacles, self._outlines = robots, obstacles, outlines
        self._boxes = [
            o
            for o in obstacles
            if isinstance(o.kind, Box) and o.kind.material is not Material.PLAIN
        ]
        self._has_walkers = any(each.walks for each in obstacles)
        self._places = None
        self.forget()

    def forget(self) -> None:
        touched = self._robots[0].drives.flags[TOUCHED].tobytes() if self._robots else b""
        places = self._outlines.state.tobytes(), touched
        if places != self._places or self._has_walkers:  # their legs move
            self._places, self._met = places, None
            self._heard.clear()
            self._seen.clear()
            self._pressed.clear()

    def sonar(self, kernels: Kernels, mounts: Mounts, owners: Int32 | None) -> Float:
        if owners is None and id(mounts) in self._heard:
            return self._heard[id(mounts)][1]
        walls = self._walls
        heard = kernels.sonar(
            walls.grid, self._outlines, mounts, SONAR_RANGE, echoes=walls.echoes, owners=owners
        )
        if owners is None:
            self._heard[id(mounts)] = mounts, heard
        return heard

    def fans(
        self, kernels: Kernels, fan: Fan, limit: float, owners: Int32, people: People = "legs"
    ) -> Float:
        met = self._outlines if people == "bodies" else self._met_by_lasers(kernels)
        ranges = kernels.cast_fans(self._walls.opaque, met, fan, limit, owners=owners)
        if self._walls.surfaces.has_glass:
            for row, number in enumerate(owners.tolist()):
                ranges[row] = self._through_glass(number, fan, ranges[row])[0]
        return ranges

    def look(
        self, kernels: Kernels, fan: Fan, limit: float, number: int, people: People = "legs"
    ) -> tuple[Float, Codes]:
        asked = fan, limit, number, people
        if asked not in self._seen:
            met = self._outlines if people == "bodies" else self._met_by_lasers(kernels)
            owner = np.array([number], dtype=np.int32)
            ranges: Float = kernels.cast_fans(self._walls.opaque, met, fan, limit, owners=owner)[0]
            if len(self._seen) >= MOST_SEEN:
                self._seen.clear()
            self._seen[asked] = self._through_glass(number, fan, ranges)
        return self._seen[asked]

    def bumpers(self, number: int) -> Bumpers:
        if number not in self._pressed:
            self._pressed[number] = self._touching(self._robots[number])
        return self._pressed[number]

    def _touching(self, body: Body) -> Bumpers:
        """Work it out: a robot that has met nothing may still be met by another."""
        model, hit = body.model, body.drives.flags.item(TOUCHED, body.number)
        if not (model.front_bumpers or model.rear_bumpers):
            return 0, 0
        x, y, theta = self._outlines.poses[:, body.number].tolist()
        reach = model.corner + REACH
        middle_x, middle_y, radius = self._outlines.shapes[:, :3].T
        near = np.hypot(middle_x - x, middle_y - y) <= radius + reach
        near[body.number] = False
        if not (hit or near.any()):
            return 0, 0
        outlines = self._outlines.shapes[near, 3:]
        corners = np.stack([outlines[:, ::2], outlines[:, 1::2]], axis=2)
        sides = np.concatenate([corners, np.roll(corners, -1, axis=1)], axis=2).reshape(-1, 4)
        if hit:
            _, walls = self._walls.grid.near(np.array([[x, y]]), reach)
            sides = np.concatenate([self._walls.grid.walls[walls], sides])
        return pressed_segments(model, Pose2(x, y, theta), sides)

    def _through_glass(self, number: int, fan: Fan, ranges: Float) -> tuple[Float, Codes]:
        """Return ranges and materials for the `ranges` of what is not glass, shape (B,)."""
        if not (self._boxes or len(self._walls.surfaces.walls)):
            return ranges, np.full(len(ranges), PLAIN, dtype=np.uint8)
        surfaces = self._walls.surfaces.joined(_movable_surfaces(self._boxes))
        at, angles = beams_of(self._robots[number], fan)
        return surfaces.seen(np.array([at.x, at.y]), angles, ranges)

    def _met_by_lasers(self, kernels: Kernels) -> RobotArrays:
        """Return the outlines of all that moves, at the height of lasers."""
        if self._met is None:
            self._met = at_laser_height(self._outlines, self._obstacles, kernels)
        return self._met


def beams_of(body: Body, fan: Fan) -> tuple[Pose2, Float]:
    """Return where the laser is in the world, and the directions of its beams [rad], (B,)."""
    mount_x, mount_y, turned, start, step = fan.frame.tolist()
    at = body.robot_in_world @ Pose2(mount_x, mount_y, turned)
    return at, at.theta + start + step * np.arange(fan.headings.shape[1])


def _movable_surfaces(obstacles: Sequence[Obstacle]) -> Surfaces:
    """Return the sides of movable boxes."""
    boxes = [replace(o.kind, pose=o.pose) for o in obstacles if isinstance(o.kind, Box)]
    codes = codes_of(box.material for box in boxes for _ in box.corners)
    return Surfaces(np.concatenate([np.empty((0, 4)), *(box.outline for box in boxes)]), codes)
