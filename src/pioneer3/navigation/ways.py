"""Ways to places of a map around all that a robot has seen, and the reasons that there are none."""

import logging
from collections.abc import Callable
from math import hypot

import numpy as np

from pioneer3.arrays import Float
from pioneer3.errors import MotionError
from pioneer3.geometry import Pose2
from pioneer3.nav.costs import CostMap
from pioneer3.nav.places import Destination
from pioneer3.nav.planner import NoWay, Way, plan
from pioneer3.nav.sightings import Sightings
from pioneer3.navigation.localization import InThread

log = logging.getLogger(__name__)

HELD_UP_WAY = 1.0
"""Way within which the place is that holds a robot up [m]."""
AVOIDED = 120.0
"""Time for which ways keep out of that place [s]."""

NOWHERE: Float = np.empty((0, 2))


def to_drive(found: Way | NoWay) -> Way:
    """Return the way to set out on: doors open, and people go on, before they are met.

    Raises:
        MotionError: There is none; see the message.
    """
    if isinstance(found, Way):
        return found
    if found.free is None:
        raise MotionError(found.why)
    return found.free


class Ways:
    """Plans the ways of one robot."""

    def __init__(
        self,
        costs: CostMap,
        sightings: Sightings,
        clock: Callable[[], float],
        in_thread: InThread,
    ) -> None:
        self._costs, self._sightings, self._clock = costs, sightings, clock
        self._in_thread = in_thread
        self._avoided: list[tuple[float, float, float]] = []

    def forget(self) -> None:
        """Forget all things that are not on the map; the robot sees them again."""
        self._sightings.forget()
        self._avoided.clear()

    def avoid(self, way: Way, here: Pose2) -> None:
        """Keep out of the narrowest place of the next stretch: the robot does not get through.

        A way for a disk may bend too sharply for a robot that is longer than it is wide.
        """
        now = self._clock()
        if any(now - when < self._costs.settings.held_up for *_, when in self._avoided):
            return
        rest = way.rest_from(here.x, here.y)
        near = rest.points[rest.to_go[0] - rest.to_go < HELD_UP_WAY]
        x, y = near[int(self._costs.clearance_at(near).argmin())].tolist()
        log.info("keeps out of (%.1f, %.1f): it does not get through there", x, y)
        self._avoided.append((x, y, now))

    async def to(self, place: Destination, here: Pose2, robots: Float) -> Way | NoWay:
        """Return a way around all that was seen, and `robots` that stay: points (N, 2) [m]."""
        now = self._clock()
        self._avoided = [each for each in self._avoided if now - each[2] < AVOIDED]
        seen, things = (self._sightings.points(now, people=people) for people in (True, False))
        avoided = np.array(self._avoided).reshape(-1, 3)[:, :2]
        # without another way: where it was held up before, through robots and people, who may go on
        tries = [
            np.concatenate([seen, robots, avoided]),
            np.concatenate([seen, robots]),
            seen,
            things,
        ]
        way: Way | NoWay = NoWay("")
        for number, obstacles in enumerate(tries):
            if number and len(obstacles) == len(tries[number - 1]):
                continue  # the same once more
            around = self._costs.with_obstacles(obstacles).with_lines(self._sightings.lines(now))
            way = await self._in_thread(plan, around, (here.x, here.y), (place.x, place.y))
            if isinstance(way, Way):
                return way
        if not len(seen):
            return way
        free = await self._in_thread(plan, self._costs, (here.x, here.y), (place.x, place.y))
        return self._closed(free, place) if isinstance(free, Way) else free

    def _closed(self, way: Way, place: Destination) -> NoWay:
        """Return the reason that a way of the map cannot be driven: where, and when it was seen."""
        now, needed = self._clock(), self._costs.needed
        for x, y in way.points.tolist():
            seen = self._sightings.seen_at(x, y, needed)
            if seen is not None:
                left = hypot(place.x - x, place.y - y)
                words = f"the way to {place} is closed {left:.1f} m from it, at ({x:.1f}, {y:.1f})"
                return NoWay(f"{words}: seen {max(0.0, now - seen):.0f} s ago", (x, y), way)
        return NoWay(f"things in the way leave none to {place}", free=way)
