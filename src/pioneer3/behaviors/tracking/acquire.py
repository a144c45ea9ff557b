"""Whom to follow: the nearest echo in front that is neither furniture nor a wall."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import asin, hypot, inf, radians

from pioneer3.behaviors.tracking.clutter import Clutter
from pioneer3.behaviors.tracking.pings import HALF_BEAM, Ping
from pioneer3.behaviors.tracking.target import RADIUS
from pioneer3.geometry import wrap
from pioneer3.models import RobotModel

REACH = 1.0
"""People are taken up to this far in front of the robot's front end [m]."""
AHEAD = radians(35)
"""Transducers that look farther aside find nobody new [rad]."""
STRAIGHT, FACING = radians(20), 0.3
"""Whom transducers hear that look farther aside than this [rad] counts as so much farther away [m]:
who wants to be followed stands straight ahead."""
RETURN_REACH, RETURN_NEAR, RETURN_AHEAD = 1.6, 0.7, radians(60)
"""Whoever was lost may come back from this far [m], this near to where they are expected [m]."""
FRONT = radians(60)
"""Transducers that look less aside than this are the front [rad]."""
FRESH = 0.5
"""Older echoes are not looked at [s]: each transducer fires three times a second."""
STEP = 0.2
"""Neighbours whose ranges differ less hear the same thing [m]."""
SENDS_BACK = 0.7
"""Share of half of somebody's width from which echoes come back: they glance off its sides."""


@dataclass(frozen=True, slots=True)
class Hearing:
    """All that is heard at one instant.

    Attributes:
        latest: The last firing of each transducer, by its number.
        now: [s]
        model: Of the robot.
        clutter: What is known to be furniture.
    """

    latest: Mapping[int, Ping]
    now: float
    model: RobotModel
    clutter: Clutter

    def echoes(self) -> list[Ping]:
        """Return all that has echoed lately."""
        return [ping for ping in self.latest.values() if self._echo(ping)]

    def nearest_person(self) -> Ping | None:
        """Return the nearest echo in front that may be somebody, or `None`."""
        mounts = self.model.sonars
        found = self._candidates(AHEAD, REACH)
        return _nearest(
            [
                (away + (FACING if abs(mounts[ping.number].theta) > STRAIGHT else 0.0), ping)
                for away, ping in found
            ]
        )

    def returning_person(self, x: float, y: float) -> Ping | None:
        """Return the nearest echo close to where somebody is expected, or `None`."""
        found = self._candidates(RETURN_AHEAD, RETURN_REACH)
        return _nearest([pair for pair in found if _beside(pair[1], x, y) < RETURN_NEAR])

    def walls(self) -> set[int]:
        """Return the transducers that hear something wider than a person.

        Neighbours that hear nearly the same range hear one thing.
        """
        found: set[int] = set()
        run: list[Ping] = []
        for ping in self._from_left_to_right():
            if ping is not None and (not run or abs(ping.distance - run[-1].distance) < STEP):
                run.append(ping)
                continue
            found.update(_if_wide(run))
            run = [ping] if ping is not None else []
        return found | _if_wide(run)

    def _from_left_to_right(self) -> list[Ping | None]:
        """Return what the front hears; `None` where nothing echoed lately."""
        mounts = self.model.sonars
        front = [i for i, mount in enumerate(mounts) if abs(mount.theta) < FRONT]
        front.sort(key=lambda i: -mounts[i].theta)
        return [self._echo(self.latest.get(i)) for i in front]

    def _echo(self, ping: Ping | None) -> Ping | None:
        heard = ping is not None and self.now - ping.stamp <= FRESH and ping.distance < inf
        return ping if heard else None

    def _candidates(self, ahead: float, reach: float) -> list[tuple[float, Ping]]:
        """Return the echoes that may be somebody, each with its distance from the centre [m]."""
        wide, model = self.walls(), self.model
        found = []
        for number, ping in self.latest.items():
            mount = model.sonars[number]
            away = hypot(mount.x, mount.y) + ping.distance
            if (
                self._echo(ping)
                and abs(mount.theta) <= ahead
                and away <= reach + model.length_front
                and number not in wide
                and self.clutter.explains(ping) == inf
            ):
                found.append((away, ping))
        return found


def _nearest(found: list[tuple[float, Ping]]) -> Ping | None:
    return min(found, key=lambda pair: pair[0])[1] if found else None


def _beside(ping: Ping, x: float, y: float) -> float:
    """Return how far a point is from the arc that an echo came from, or its middle [m]."""
    away, _ = ping.seen(x, y)
    px, py = ping.point
    return min(abs(ping.distance + RADIUS - away), hypot(px - x, py - y))


def _if_wide(run: list[Ping]) -> set[int]:
    """Return the numbers of neighbours that hear one thing, if that is wider than a person.

    Somebody is heard by transducers that look past them by half a beam, on either side.
    """
    if len(run) < 2:
        return set()
    nearest = min(ping.distance for ping in run)
    widest = 2 * (HALF_BEAM + asin(SENDS_BACK * RADIUS / (nearest + RADIUS)))
    span = abs(wrap(run[0].axis - run[-1].axis))
    return {ping.number for ping in run} if span > widest else set()
