"""Things that are not on the map: boxes, closed doors, people. Where, and when they were seen."""

from dataclasses import replace
from math import atan2, hypot, inf, pi, sqrt

import numpy as np

from pioneer3.arrays import Float
from pioneer3.geometry import Pose2
from pioneer3.jit import fast
from pioneer3.nav.beams import Beams
from pioneer3.nav.clusters import has_company
from pioneer3.nav.costs import COST_CELL, CostMap
from pioneer3.nav.echoes import BODY_RADIUS, ECHO_DOUBT, UNSURE_END, WALL_ECHO, Echoes
from pioneer3.nav.kernels import CACHE
from pioneer3.nav.kernels.rays import clear_beams, thin_points
from pioneer3.nav.mover import COASTING_TIME, OFTEN
from pioneer3.nav.moving import BESIDE, PEOPLE_TIME, PERSON_RADIUS, Movers
from pioneer3.nav.particles import moved_by, points_by
from pioneer3.nav.raster import cells_where

LOOK = 2.0
"""Distance within which things steer a robot [m]."""
SEEN_RANGE = 5.0
"""Range beyond which things are not noted, nor followed [m]."""
PASSING_TIME = 5.0
"""Time for which things stay that may be of somebody who passed [s]."""
COMING_TIME = 3.0
"""Time unseen after which somebody may have turned [s]."""
WALL_DOUBT = 0.05
"""Error of a wall's place for each metre from the laser [m/m]: odometry of turns is late."""
COMING_WAY = 4.0
"""Way that people are expected to go on for [m]."""
BENDS = np.radians([0, 20, -20, 40, -40, 60, -60, 80, -80])
"""Turns at each step that walls may bring about, the likeliest first [rad]."""
STANDING_TIME = 12.0
"""Time after which walkers who have stood are in the way of plans [s]."""


class Sightings:
    """The cells of a map in which something unknown to it was seen last.

    Attributes:
        costs: Of the map alone, for its cells and clearances.
        movers: People, and all else that may move; those who walk leave no cells behind.
        echoes: What sonars alone notice.
    """

    def __init__(self, costs: CostMap) -> None:
        self.costs, self.movers, self.echoes = costs, Movers(), Echoes(costs)
        self._raster, self._clearance = costs.raster, costs.clearance
        self._seen: Float = np.zeros(costs.raster.shape)
        self._counts = np.zeros(costs.raster.shape, dtype=np.uint8)
        # half of a square within the robot
        self._under = sqrt(0.5) * (costs.needed - costs.settings.margin)
        self._echoed: Float = np.empty((0, 2))
        self._latest = -inf, self._echoed

    def take(self, beams: Beams, robot_in_map: Pose2) -> None:
        """Note the echoes of a scan, and forget the things that it sees past.

        The robot's pose is that at the scan's last reading.
        """
        raster, now = self._raster, max(beams.stamp, 1e-9)
        beams = self._without_strays(beams, robot_in_map)
        rays = np.concatenate([beams.points, beams.free, beams.origin[None]]) - beams.origin
        lengths = np.maximum(np.hypot(*rays.T), 1e-9)
        from_laser = lengths[: len(beams.points)]
        echoes = points_by(robot_in_map, beams.points)
        self._latest = beams.stamp, echoes
        rows, columns, inside = raster.cells_of(echoes)
        by_map = self._clearance[rows, columns] <= WALL_ECHO + WALL_DOUBT * from_laser
        unknown = np.flatnonzero(inside & ~by_map & (from_laser < SEEN_RANGE))
        things = unknown[has_company(echoes[unknown])]
        rays *= np.minimum(1.0, SEEN_RANGE / lengths)[:, None]
        ends = points_by(robot_in_map, beams.origin + rays)
        limit = np.array([robot_in_map.theta, pi / 2])
        walking = things[self.movers.take(echoes[things], ends[-1], limit, beams.stamp)]
        for thing in self.movers.walking():
            for x, y in thing.past:
                self._clear(x, y, PERSON_RADIUS)
        unknown = np.setdiff1d(unknown, walking)
        ends = raster.in_cells(ends)
        short = UNSURE_END / raster.cell
        fast(clear_beams, CACHE)(ends[-1], ends[:-1], short, self._seen, self._counts)
        self._clear(robot_in_map.x, robot_in_map.y, self._under)
        cells = rows[unknown], columns[unknown]
        self._seen[cells], self._counts[cells] = now, np.minimum(self._counts[cells], 200) + 1

    def latest(self, now: float) -> Float | None:
        """Return the echoes of the last scan in the map's frame [m], (N, 2); `None` if it is old.

        Strays are not among them.
        """
        stamp, echoes = self._latest
        return echoes if abs(now - stamp) < COASTING_TIME else None

    def _without_strays(self, beams: Beams, robot_in_map: Pose2) -> Beams:
        """Return a scan without the echoes that stand alone where the last scan had none.

        Lasers see edges, dust and the sun as points that are not there.
        """
        before, self._echoed = self._echoed, points_by(robot_in_map, beams.points)
        alone = np.flatnonzero(~has_company(beams.points))
        if not len(alone):
            return beams
        off = np.hypot(*(self._echoed[alone, None] - before[None]).transpose(2, 0, 1))
        strays = alone[off.min(axis=1, initial=np.inf) > ECHO_DOUBT]
        return replace(beams, points=np.delete(beams.points, strays, axis=0))

    def hear(self, mounts: Float, ranges: Float, robot_in_map: Pose2, now: float) -> None:
        """Take the ranges (F,) of sonars that fired [m], `inf` where nothing echoed.

        The `mounts` (F, 3) are x, y [m] and direction [rad] on the robot.
        """
        transducers = moved_by(robot_in_map, mounts)
        people = [each for each in self.movers.people() if now - each.seen < COASTING_TIME]
        if len(people) < len(self.movers.people()):  # somebody is out of the laser's sight
            for (x, y, theta), metres in zip(transducers.tolist(), ranges.tolist(), strict=True):
                self.movers.hear(Pose2(x, y, theta), metres, now)
        about = self.movers.are_about(now)
        since = now - COASTING_TIME if about else 0.0  # who is gone explains nothing

        def is_known(arc: Float) -> bool:
            x, y = arc[len(arc) // 2].tolist()
            if any(hypot(each.x - x, each.y - y) < PERSON_RADIUS + ECHO_DOUBT for each in people):
                return True
            # the laser sees it, and knows better where it is
            return any(
                (self._seen[self._raster.window(x, y, UNSURE_END)] > since).any()
                for x, y in arc.tolist()
            )

        self.echoes.take(transducers, ranges, now, is_known, people=about)

    def points(self, now: float, *, people: bool = True) -> Float:
        """Return the middles of cells with things that were seen, shape (N, 2) [m].

        Somebody who walks is not among them; with `people`, who has stood for a while is.
        """
        rows, columns = cells_where(self._counts > 0)
        old = self._seen[rows, columns] < now - PEOPLE_TIME
        forgotten = rows[old], columns[old]
        self._seen[forgotten], self._counts[forgotten] = 0.0, 0  # nor do they close a way
        seen = self._seen_in((slice(0, self._raster.height), slice(0, self._raster.width)), now)
        heard = self.echoes.often(now, people=self.movers.are_about(now))
        return np.concatenate([seen, heard, *([self._standing(now)] if people else [])])

    def near(self, x: float, y: float, within: float, now: float) -> Float:
        """Return those that were seen around a place [m], without walkers, shape (N, 2)."""
        return self._seen_in(self._raster.window(x, y, within), now)

    def _seen_in(self, part: tuple[slice, slice], now: float) -> Float:
        """Return the middles of the cells of a part with things that were seen, (N, 2) [m]."""
        rows, columns = cells_where(self._counts[part] > 0)
        rows, columns = rows + part[0].start, columns + part[1].start
        seen, counts = self._seen[rows, columns], self._counts[rows, columns]
        passing = (counts < OFTEN) & (seen < now - PASSING_TIME) & self.movers.are_about(now)
        there = (seen >= now - PEOPLE_TIME) & ~passing
        return self._raster.middles_of(rows[there], columns[there])

    def seen_at(self, x: float, y: float, within: float) -> float | None:
        """Return when something was last seen within a distance of a place [m], or `None`."""
        part = self._raster.window(x, y, within)
        seen = [float(self._seen[part].max(initial=0.0)), self.echoes.last_in(part)]
        reach = within + PERSON_RADIUS
        standing = (thing for thing in self.movers.walking() if thing.stands is not None)
        seen += [t.seen for t in standing if np.hypot(t.x - x, t.y - y) < reach]
        return max(seen) or None

    def _clear(self, x: float, y: float, within: float) -> None:
        """Forget what was seen within a distance of a place [m]."""
        part = self._raster.window(x, y, within)
        self._seen[part], self._counts[part] = 0.0, 0

    def _standing(self, now: float) -> Float:
        """Return points around walkers who have stood for a while [m], shape (N, 2)."""
        angles = np.linspace(-pi, pi, 12, endpoint=False)
        ring = PERSON_RADIUS * np.stack([np.cos(angles), np.sin(angles)], axis=1)
        standing = [
            ring + np.array((thing.x, thing.y))
            for thing in self.movers.walking()
            if thing.stands is not None and now - thing.stands > STANDING_TIME
        ]
        return np.concatenate([np.empty((0, 2)), *standing])

    def bodies(self, x: float, y: float, within: float, now: float) -> Float:
        """Return all that is seen or heard of people and such around a place, and may move.

        Rows are x, y [m], velocity [m/s] and radius [m], shape (N, 5).
        """
        people = self.movers.discs(now)
        return np.concatenate(
            [
                people,
                standing(self._legs(people, now), BODY_RADIUS),
                standing(self.echoes.near(x, y, within, now), 0.0),
                standing(self.echoes.bodies(now), BODY_RADIUS),
            ]
        )

    def obstacles(self, x: float, y: float, walls: Float, seen: Float, now: float) -> Float:
        """Return all that steers a robot at a place, as `bodies` does, shape (N, 5).

        Points of the map's `walls`, and those that are `seen` now, are in the map's frame [m],
        shape (any, 2).
        """
        discs = self.movers.discs(now)[:, [0, 1, 4]] + (0.0, 0.0, ECHO_DOUBT)
        side = 2 * round(LOOK / COST_CELL) + 3
        taken, out, count = np.zeros((side, side), np.uint8), np.empty((side * side, 2)), 0
        place = np.array([x, y, COST_CELL])
        for points, within in ((walls, LOOK), (self.near(x, y, LOOK, now), inf), (seen, LOOK)):
            there = np.ascontiguousarray(points), place, within, np.ascontiguousarray(discs)
            count = fast(thin_points, CACHE)(*there, taken, out, count)
        return np.concatenate([standing(out[:count], 0.0), self.bodies(x, y, LOOK, now)])

    def _legs(self, people: Float, now: float) -> Float:
        """Return echoes of the last scan that may be of legs, but of people who are alone, (N, 2).

        Of `people` there are x, y [m], velocity [m/s] and radius [m], shape (W, 5).
        """
        legs = self.movers.doubtful if self.latest(now) is not None else np.empty((0, 2))
        for x, y, _, _, radius in people.tolist():
            # echoes of people beside each other are taken for those of the wrong one
            if sum(hypot(ox - x, oy - y) < BESIDE for ox, oy in people[:, :2].tolist()) == 1:
                legs = legs[np.hypot(legs[:, 0] - x, legs[:, 1] - y) > min(radius, PERSON_RADIUS)]
        return legs

    def lines(self, now: float) -> Float:
        """Return the lines on which people come, or turn back if they are not let [m], (L, 4)."""
        rows = [
            (*thing.at(now), *thing.heading)
            for thing in self.movers.walking()
            if now - thing.seen < COMING_TIME and any(thing.heading)
        ]
        places, headings = np.hsplit(np.array(rows).reshape(-1, 4), 2)
        return np.hstack([places - COMING_WAY * headings, places + COMING_WAY * headings])

    def way_of(self, place: tuple[float, float], heading: tuple[float, float]) -> Float:
        """Return where somebody goes on from a place [m], shape (K, 2): straight, along walls."""
        way, ahead = [np.array(place)], atan2(heading[1], heading[0])
        for _ in range(round(COMING_WAY / COST_CELL)):
            turned = ahead + BENDS
            steps = way[-1] + COST_CELL * np.stack([np.cos(turned), np.sin(turned)], axis=1)
            open_ = self.costs.clearance_at(steps) > PERSON_RADIUS
            if not open_.any():
                break
            best = int(open_.argmax())
            ahead = float(turned[best])
            way.append(steps[best])
        return np.array(way)

    def forget(self) -> None:
        """Forget everything, as after the robot was found to be somewhere else."""
        self._seen[:], self._counts[:] = 0.0, 0
        self.echoes.forget()
        self._echoed = np.empty((0, 2))
        self._latest = -inf, self._echoed
        self.movers.forget()


def standing(points: Float, radius: float) -> Float:
    """Return things of a radius [m] that stand at places (N, 2) [m], as `bodies` does, (N, 5)."""
    things = np.zeros((len(points), 5))
    things[:, :2], things[:, 4] = points, radius
    return things
