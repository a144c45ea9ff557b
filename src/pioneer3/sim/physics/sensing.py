"""Sonars, lasers and bumpers in three dimensions: rays among the geoms of MuJoCo, and contacts.

Tall walls are the same at every height. For a robot that stands level, the kernels of the plane
measure them, with all the rules for their echoes, and rays are cast only where something else may
be nearer. A tilted robot casts all its rays in three dimensions; edges, which the kernels know of,
are not heard for themselves then.
"""

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from pioneer3.arrays import Float, Int32
from pioneer3.maps import LineMap
from pioneer3.maps.materials import PLAIN, Codes
from pioneer3.models import shape_of
from pioneer3.sim.body import Body, Bumpers
from pioneer3.sim.kernels import Fan, Grid, Kernels, Mounts, RobotArrays, build_grid
from pioneer3.sim.obstacles import Obstacle
from pioneer3.sim.physics.colors import BODIES, LEGS, THINGS, WALLS
from pioneer3.sim.physics.rays import ScenePoses, cast, cast_light, places_of, refresh
from pioneer3.sim.physics.scene import TALL, Scene
from pioneer3.sim.realism import SonarErrors
from pioneer3.sim.relief import Relief
from pioneer3.sim.sensing import People, SensedWalls, beams_of
from pioneer3.sim.sensors import SONAR_RANGE
from pioneer3.sim.worldfile import Person

MET = {"legs": LEGS, "bodies": BODIES}
"""The group of people's geoms that light meets."""


class MujocoSensing:
    """`Sensing` in three dimensions.

    `scene` returns the compiled world, which the dynamics replace now and then.
    """

    def __init__(self, scene: Callable[[], Scene], sonar: SonarErrors) -> None:
        self._scene_now, self._errors = scene, sonar
        self._places: ScenePoses | None = None

    def change_map(self, line_map: LineMap, grid: Grid, relief: Relief) -> None:
        tall = relief.heights_of(line_map) >= TALL
        walls, codes = line_map.walls[tall], line_map.materials[tall]
        own = grid if tall.all() else build_grid(walls)
        self._walls = SensedWalls.of(walls, codes, own, self._errors)
        self.forget()

    def change_bodies(
        self, robots: Sequence[Body], obstacles: Sequence[Obstacle], outlines: RobotArrays
    ) -> None:
        self._robots, self._outlines = robots, outlines
        self._people = [(n, o) for n, o in enumerate(obstacles) if isinstance(o.kind, Person)]
        # the kernels of the plane see the walls alone
        self._alone = RobotArrays(*outlines.state[3:7])
        self._alone.hidden[:] = 1.0
        shapes = [shape_of(body.model) for body in robots]
        self._sonar_heights = [shape.sonar_height for shape in shapes]
        self._laser_heights = [shape.laser_height for shape in shapes]
        self.forget()

    def forget(self) -> None:
        self._places = None

    def sonar(self, kernels: Kernels, mounts: Mounts, owners: Int32 | None) -> Float:
        places = self._refreshed(kernels)
        walls = self._walls
        heard = kernels.sonar(
            walls.grid, self._alone, mounts, SONAR_RANGE, echoes=walls.echoes, owners=owners
        )
        numbers = np.arange(len(mounts.kinds)) if owners is None else owners
        for row, number in enumerate(numbers.tolist()):
            kind = mounts.kinds[number]
            table = mounts.table[mounts.offsets[kind] : mounts.offsets[kind + 1]]
            for column in self._doubtful(places, number, table, heard[row]):
                heard[row, column] = self._echo(
                    places, number, table[column], float(heard[row, column])
                )
        return heard

    def fans(
        self, kernels: Kernels, fan: Fan, limit: float, owners: Int32, people: People = "legs"
    ) -> Float:
        self._refreshed(kernels)
        ranges = kernels.cast_fans(self._walls.opaque, self._alone, fan, limit, owners=owners)
        for row, number in enumerate(owners.tolist()):
            ranges[row], _ = self._lit(number, fan, limit, ranges[row], people)
        return ranges

    def look(
        self, kernels: Kernels, fan: Fan, limit: float, number: int, people: People = "legs"
    ) -> tuple[Float, Codes]:
        self._refreshed(kernels)
        owner = np.array([number], dtype=np.int32)
        ranges: Float = kernels.cast_fans(
            self._walls.opaque, self._alone, fan, limit, owners=owner
        )[0]
        return self._lit(number, fan, limit, ranges, people)

    def bumpers(self, number: int) -> Bumpers:
        scene = self._scene_now()
        pairs = scene.data.contact.geom
        own = scene.robot[pairs] == number
        touching = own & (pairs[:, ::-1] != scene.floor)
        front, rear = np.bitwise_or.reduce(scene.bumpers[pairs[touching]], axis=0).tolist()
        return front, rear

    def _refreshed(self, kernels: Kernels) -> ScenePoses:
        """Return where everything is now."""
        if self._places is None:
            scene, circles = self._scene_now(), np.empty((len(self._people), 3))
            for row, (number, person) in enumerate(self._people):
                circles[row] = person.pose.x, person.pose.y, 2 * person.sizes[0]
                for leg, at in zip(scene.legs[number], person.legs, strict=True):
                    scene.data.mocap_pos[leg, :2] = at.x, at.y
            refresh(scene)
            self._alone.poses[:] = self._outlines.poses
            kernels.place(self._alone)
            robots = self._outlines.shapes[: len(self._robots), :3]
            self._places = places_of(scene, robots, circles)
        return self._places

    def _doubtful(
        self, places: ScenePoses, number: int, table: Float, heard: Float
    ) -> Iterator[int]:
        """Yield the transducers of a robot for which the walls of the plane may not be all.

        `table` has its transducers, as `Mounts.table`, and `heard` what they hear of tall walls
        [m], shape (M,).
        """
        if not places.level[number]:
            yield from range(len(table))
            return
        if not places.near(number, SONAR_RANGE + 1.0):
            return
        turned = places.turned[number, :2, :2]
        origins = places.at[number, :2] + table[:, :2] @ turned.T
        first, last = table[:, 2:4] @ turned.T, table[:, -2:] @ turned.T
        middle = first + last
        middle /= np.hypot(*middle.T)[:, None]
        half = np.arccos((middle * first).sum(axis=1).clip(-1.0, 1.0))
        to = places.middles - origins[:, None]
        away = np.hypot(to[..., 0], to[..., 1])
        with np.errstate(divide="ignore", invalid="ignore"):
            wide = np.where(away > places.radii, np.arcsin(places.radii / away), np.pi)
            aside = np.arccos(((to * middle[:, None]).sum(axis=2) / away).clip(-1.0, 1.0))
        near = (away - places.radii < heard[: len(table), None]) & (aside <= half[:, None] + wide)
        near[:, number] = False
        yield from np.flatnonzero(near.any(axis=1)).tolist()

    def _echo(self, places: ScenePoses, number: int, row: Float, of_walls: float) -> float:
        """Return the range that one transducer hears [m].

        `row` is that of the transducer in `Mounts.table`, and `of_walls` what it would hear if
        there were only tall walls, and it were level [m].
        """
        scene, turned = self._scene_now(), places.turned[number]
        origin = places.at[number] + turned @ (row[0], row[1], self._sonar_heights[number])
        ways = row[2:].reshape(-1, 2) @ turned[:, :2].T
        hits = cast(
            scene,
            origin,
            ways,
            SONAR_RANGE,
            groups=(WALLS, THINGS, BODIES),
            but=scene.bodies[number],
        )
        sends_back = scene.moving[hits.geoms] | (hits.facing >= self._walls.echoes.steep)
        if not places.level[number]:
            return float(hits.ranges[sends_back].min(initial=SONAR_RANGE))
        is_wall = scene.groups[hits.geoms] == WALLS
        if (~is_wall & (hits.ranges < of_walls)).all():
            of_walls = SONAR_RANGE  # hidden
        return float(hits.ranges[sends_back & ~is_wall].min(initial=of_walls))

    def _lit(
        self, number: int, fan: Fan, limit: float, of_walls: Float, people: People
    ) -> tuple[Float, Codes]:
        """Return ranges [m] and materials of the beams of a laser.

        `of_walls` are the ranges of tall walls that are not of glass, if the robot stands level
        [m], shape (B,); `limit` is the longest range [m].
        """
        places, ranges = self._places, of_walls
        assert places is not None
        level, reach = bool(places.level[number]), limit
        codes, groups = np.full(len(ranges), PLAIN, dtype=np.uint8), [THINGS, MET[people]]
        if level:
            if len(self._walls.surfaces.walls):
                at, angles = beams_of(self._robots[number], fan)
                ranges, codes = self._walls.surfaces.seen(np.array([at.x, at.y]), angles, ranges)
            reach = float(ranges.max(initial=0.0))
            if not places.near(number, reach + 1.0):
                return ranges, codes
        else:
            ranges, groups = np.full(len(ranges), limit), [WALLS, *groups]
        scene, turned = self._scene_now(), places.turned[number]
        x, y, yaw, _, _ = fan.frame.tolist()
        c, s = np.cos(yaw), np.sin(yaw)
        origin = places.at[number] + turned @ (x, y, self._laser_heights[number])
        ways = fan.headings.T @ np.array([[c, s], [-s, c]]) @ turned[:, :2].T
        hits = cast_light(scene, origin, ways, reach, groups=groups, but=scene.bodies[number])
        nearer = hits.ranges < ranges
        codes = np.where(nearer, scene.codes[hits.geoms], codes)
        return np.minimum(ranges, hits.ranges), codes
