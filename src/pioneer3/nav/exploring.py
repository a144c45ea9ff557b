"""Chooses the edge of a map that a robot looks at next, until none is left."""

from dataclasses import dataclass, field
from math import inf

import numpy as np

from pioneer3.geometry import Pose2
from pioneer3.maps import OccupancyGrid
from pioneer3.maps.line_map import FREE
from pioneer3.nav.costs import CostMap
from pioneer3.nav.frontiers import Frontier, find_frontiers
from pioneer3.nav.planner import Way, plan
from pioneer3.nav.settings import AS_SHIPPED, MapperSettings

SAME_EDGE = 0.5
"""Distance within which two edges, seen one after the other, are the same [m]."""
GROWTH = 0.3
"""New ground below which the map has not grown [m^2]."""
MOST_TRIED = 8
"""Edges to which ways are planned at once; the others come next time."""


@dataclass(frozen=True, slots=True, eq=False)
class FrontierTarget:
    """An edge, and the way to where the robot sees it from."""

    frontier: Frontier
    way: Way


@dataclass(frozen=True, slots=True, eq=False)
class GivenUp:
    """An edge that the robot could not look behind, and the reason for people.

    That is empty where it was seen from near and stayed as it was.
    """

    frontier: Frontier
    why: str


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Outlook:
    """The edge to drive to, `None` where none is left; and the number of edges that are left."""

    target: FrontierTarget | None
    left: int


@dataclass(slots=True, eq=False)
class Exploration:
    """The edges of a map that a robot has been to, and those that it gave up, in their order."""

    settings: MapperSettings = AS_SHIPPED.mapper
    given_up: list[GivenUp] = field(default_factory=list)
    _target: Frontier | None = field(default=None, init=False)
    _tried_again: bool = field(default=False, init=False)
    _area: float = field(default=-inf, init=False)
    _grew: float = field(default=-inf, init=False)

    @property
    def unreachable(self) -> tuple[GivenUp, ...]:
        """The edges that no way led to, or that the robot did not get to."""
        return tuple(each for each in self.given_up if each.why)

    def give_up(self, why: str) -> None:
        """Give up the present target: for the reason `why`, or because it was seen from near."""
        if self._target is not None:
            self.given_up.append(GivenUp(self._target, why))
            self._target = None

    def choose(
        self, grid: OccupancyGrid, costs: CostMap, robot_in_map: Pose2, now: float
    ) -> Outlook:
        """Return the edge to drive to: the present one as long as it is there, or the next.

        The `costs` are those of the map with all that is in the way.
        """
        self._watch(grid, now)
        left = self._find(grid, costs, robot_in_map)
        if not left and self.unreachable and not self._tried_again:
            # somebody who stood in a door may have gone
            self._tried_again = True
            self.given_up = [each for each in self.given_up if not each.why]
            left = self._find(grid, costs, robot_in_map)
        present = self._target
        if present is not None:
            left.sort(key=lambda each: not _same(each, present))
        start = robot_in_map.x, robot_in_map.y
        for tried, frontier in enumerate(left):
            way = plan(costs, start, (frontier.view.x, frontier.view.y))
            if isinstance(way, Way):
                if present is None or not _same(frontier, present):
                    self._grew = now
                self._target = frontier
                return Outlook(target=FrontierTarget(frontier, way), left=len(left) - tried)
            self._target = frontier
            self.give_up(way.why.replace("the goal", "the place to see it from"))
            if tried == MOST_TRIED:
                return Outlook(target=None, left=len(left) - tried)
        self._target = None
        return Outlook(target=None, left=0)

    def _find(self, grid: OccupancyGrid, costs: CostMap, robot_in_map: Pose2) -> list[Frontier]:
        old = np.array([each.frontier.end for each in self.given_up]).reshape(-1, 2)
        turning = costs.turning + costs.raster.cell
        return list(find_frontiers(grid, robot_in_map, turning, costs.needed, old))

    def wait(self, now: float) -> None:
        """Note that the robot does not drive to its target, as hands drive it elsewhere."""
        self._grew = now

    def _watch(self, grid: OccupancyGrid, now: float) -> None:
        """Give up a target that the robot learns nothing from."""
        area = float((grid.states == FREE).sum()) * grid.resolution**2
        if area > self._area + GROWTH:
            self._area, self._grew = area, now
        elif self._target is not None and now - self._grew > self.settings.patience:
            self.give_up("the robot did not get there")


def _same(a: Frontier, b: Frontier) -> bool:
    off = a.points[:, None, :] - b.points[None, :, :]
    return bool((np.hypot(off[..., 0], off[..., 1]) < SAME_EDGE).any())
