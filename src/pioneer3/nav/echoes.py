"""Echoes that neither the map, nor the laser, nor people in sight explain.

Lasers look through glass and over low boxes, so that they do not clear what was heard.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from pioneer3.arrays import Float
from pioneer3.nav.costs import CostMap
from pioneer3.nav.mover import MEMORY_TIME
from pioneer3.nav.raster import cells_where

WALL_ECHO = 0.12
"""Distance to a wall of the map within which an echo is of that wall [m]."""
UNSURE_END = 0.15
"""Length before an echo of which nothing is known to be free [m]: poses are not that exact."""
HEARD_TIMES = 3
"""Echoes after which plans avoid a thing."""
ECHO_RANGE = 1.5
"""Range below which echoes count [m]."""
ECHO_AGE = 3.0
"""Time for which a robot keeps clear of an echo, and plans do where people are [s]."""
ECHO_DOUBT = 0.1
"""Distance within which echoes are of the same thing [m]."""
ARC_RANGE = 0.5
"""Range below which a thing may be anywhere on the arc of its echo [m]; farther ones close doors.
"""
AXIS = np.radians(10.0)
"""Angle off its axis within which a sonar hears all that is there [rad]."""
ARC = np.radians([-21.0, -10.0, 0.0, 10.0, 21.0])
"""Directions off the axis of a sonar from which an echo may come [rad]."""
BODY_RADIUS = 0.2
"""Radius of the body around legs, and behind a near echo of a sonar where people are [m]."""
BODY_BEAM = np.radians([-15.0, 0.0, 15.0])
"""Directions off the axis of a sonar in which it hears a body [rad]."""
NOWHERE: Float = np.empty((0, 2))


class SonarEcho(NamedTuple):
    """One echo, and when it was heard [s].

    Attributes:
        middle: Where it came from if it came along the axis [m], shape (2,).
        points: From where it may have come [m], shape (N, 2).
        bodies: Middles of bodies that may have sent it back [m], shape (B, 2).
    """

    when: float
    middle: Float
    points: Float
    bodies: Float


class Echoes:
    """The echoes of the last moments, and the cells of a map alone that they came from."""

    def __init__(self, costs: CostMap) -> None:
        self._raster, self._clearance = costs.raster, costs.clearance
        self._times: Float = np.zeros(costs.raster.shape)
        self._counts = np.zeros(costs.raster.shape, dtype=np.uint8)
        self._echoes: list[SonarEcho] = []
        self._steps = np.arange(0.1, ECHO_RANGE, costs.raster.cell)

    def take(
        self,
        transducers: Float,
        ranges: Float,
        now: float,
        is_known: Callable[[Float], bool],
        *,
        people: bool,
    ) -> None:
        """Forget the things that are no longer heard, then note the echoes that nothing explains.

        Args:
            transducers: x, y [m] and direction [rad] in the map of those that fired, shape (F, 3).
            ranges: That they measured [m]; `inf` where nothing echoed, shape (F,).
            now: [s].
            is_known: Tells whether something else explains an echo from some points (5, 2) [m].
            people: Whether they may be of people.
        """
        self._clear(transducers, np.minimum(ranges, ECHO_RANGE))
        echoed = (ranges > 0.0) & (ranges < ECHO_RANGE)
        places, ranges = transducers[echoed], ranges[echoed]
        bearings = places[:, 2:] + ARC
        arcs = places[:, None, :2] + ranges[:, None, None] * _directions(bearings)
        rows, columns, inside = self._raster.cells_of(arcs)
        by_map = self._clearance[rows, columns] < WALL_ECHO
        for n in np.flatnonzero((inside & ~by_map).all(axis=1)).tolist():
            if not is_known(arcs[n]):
                row, column = int(rows[n, 2]), int(columns[n, 2])
                self._count(row, column, now)
                bodies = NOWHERE
                if people and ranges[n] < ARC_RANGE:
                    there = _directions(places[n, 2] + BODY_BEAM)
                    bodies = places[n, :2] + (ranges[n] + BODY_RADIUS) * there
                middle = arcs[n, 2]
                points = arcs[n] if ranges[n] < ARC_RANGE else middle[None]
                self._echoes.append(SonarEcho(now, middle, points, bodies))

    def _count(self, row: int, column: int, now: float) -> None:
        around = slice(max(0, row - 1), row + 2), slice(max(0, column - 1), column + 2)
        self._counts[around] = np.minimum(self._counts[around], 200) + 1
        self._times[row, column] = now

    def _clear(self, transducers: Float, metres: Float) -> None:
        """Forget what was heard from within the beams of sonars that reach so far [m], (F,)."""
        axes = _directions(transducers[:, 2])
        free = self._steps < metres[:, None] - UNSURE_END
        beams = transducers[:, None, :2] + self._steps[:, None] * axes[:, None]
        rows, columns, inside = self._raster.cells_of(beams[free])
        rows, columns = rows[inside], columns[inside]
        self._times[rows, columns], self._counts[rows, columns] = 0.0, 0
        if not self._echoes:
            return
        off = np.array([each.middle for each in self._echoes])[:, None] - transducers[:, :2]
        along = (off * axes).sum(axis=2)
        aside = off[..., 1] * axes[:, 0] - off[..., 0] * axes[:, 1]
        anew = np.abs(np.arctan2(aside, along)) < AXIS
        anew &= np.hypot(along, aside) <= metres + ECHO_DOUBT
        gone = anew.any(axis=1).tolist()
        self._echoes = [
            each for each, is_gone in zip(self._echoes, gone, strict=True) if not is_gone
        ]

    def often(self, now: float, *, people: bool) -> Float:
        """Return the middles of cells that were heard lately, so often that plans care, (N, 2) [m].

        If they may be of `people`, who go on, those are recent ones.
        """
        rows, columns = cells_where(self._counts >= HEARD_TIMES)
        times = self._times[rows, columns]
        lately = (times > 0.0) & (times >= now - (ECHO_AGE if people else MEMORY_TIME))
        return self._raster.middles_of(rows[lately], columns[lately])

    def near(self, x: float, y: float, within: float, now: float) -> Float:
        """Return points of the echoes of the last moments around a place, (N, 2) [m]."""
        self._echoes = [each for each in self._echoes if each.when > now - ECHO_AGE]
        points = np.concatenate([NOWHERE, *(each.points for each in self._echoes)])
        return points[np.hypot(points[:, 0] - x, points[:, 1] - y) < within]

    def bodies(self, now: float) -> Float:
        """Return the middles of bodies that may be behind near echoes [m], shape (N, 2)."""
        fresh = (each.bodies for each in self._echoes if each.when > now - ECHO_AGE)
        return np.concatenate([NOWHERE, *fresh])

    def last_in(self, part: tuple[slice, slice]) -> float:
        """Return when something was heard last in some cells [s]; 0 if never."""
        return float(self._times[part].max(initial=0.0))

    def forget(self) -> None:
        """Forget everything."""
        self._times[:], self._counts[:], self._echoes = 0.0, 0, []


def _directions(bearings: Float) -> Float:
    """Return vectors of length 1, shape (..., 2)."""
    return np.stack([np.cos(bearings), np.sin(bearings)], axis=-1)
