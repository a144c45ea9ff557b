"""Finds a person among the echoes of sonars: clutter and walls are left out."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import asin, hypot, inf, radians

from pioneer3.behaviors.pings import HALF_BEAM, Ping
from pioneer3.geometry import wrap
from pioneer3.models import RobotModel

CLUTTER_REACH = 2.5
"""Farther echoes are not remembered [m]."""
SAME_PLACE = 0.12
"""Echoes that differ less come from the same place [m]."""
BESIDE = 1.4
"""Places up to this far outside a beam, in half beams, may have sent its echo."""
STANDS = 2.0
"""An echo from the same place for this long is furniture [s]."""
OFTEN = 3
"""At least so many echoes make a place."""
FORGET = 30.0
"""Places that have not been heard of for this long are forgotten [s]."""
MOST_PLACES = 200
"""Places that are kept at most."""


@dataclass(slots=True)
class ClutterPoint:
    """A place in odometry's frame [m], with the first and the last time it echoed [s]."""

    x: float
    y: float
    first: float
    last: float
    echoes: int = 1

    @property
    def stands(self) -> bool:
        """Whether it has been there for long enough to be furniture."""
        return self.echoes >= OFTEN and self.last - self.first >= STANDS


class ClutterMap:
    """Remembers places of echoes that do not come from the person who is followed.

    An echo comes from somewhere on an arc; it is said to come from a place that is known already,
    if one is on it.
    """

    def __init__(self) -> None:
        self.spots: list[ClutterPoint] = []

    def take(self, ping: Ping) -> None:
        """Remember an echo, and that nothing is before it any more."""
        if ping.distance <= CLUTTER_REACH:
            spot = self._at(ping)
            if spot is None:
                self._add(ping)
            else:
                spot.last, spot.echoes = ping.stamp, spot.echoes + 1
        self._clear(ping)

    def learn(self, pings: Iterable[Ping]) -> None:
        """Remember that echoes come from furniture, though they have not been watched for long."""
        for ping in pings:
            spot = ClutterPoint(*ping.point, ping.stamp - STANDS, ping.stamp, OFTEN)
            self.spots = [*self.spots, spot][-MOST_PLACES:]

    def explains(self, ping: Ping) -> float:
        """Return how much longer a range is than that to the furniture there [m]; `inf`: none."""
        spot = self._at(ping, standing=True)
        return ping.distance - ping.seen(spot.x, spot.y)[0] if spot else inf

    def _at(self, ping: Ping, *, standing: bool = False) -> ClutterPoint | None:
        """Return the place that an echo fits best."""
        best, found = SAME_PLACE, None
        for spot in self.spots:
            away, off = ping.seen(spot.x, spot.y)
            differs = abs(ping.distance - away)
            if differs < best and abs(off) < BESIDE * HALF_BEAM and (spot.stands or not standing):
                best, found = differs, spot
        return found

    def _add(self, ping: Ping) -> None:
        self.spots = [s for s in self.spots if ping.stamp - s.last < FORGET][-(MOST_PLACES - 1) :]
        self.spots.append(ClutterPoint(*ping.point, ping.stamp, ping.stamp))

    def _clear(self, ping: Ping) -> None:
        """Count against places that should have echoed nearer: slanting walls may be silent."""
        for spot in self.spots:
            away, off = ping.seen(spot.x, spot.y)
            if (
                away < ping.distance - 2 * SAME_PLACE
                and abs(off) < HALF_BEAM / 2
                and away < CLUTTER_REACH
            ):
                spot.echoes -= 1
        self.spots = [spot for spot in self.spots if spot.echoes > 0]


RADIUS = 0.25
"""Radius of a person who walks, seen from above [m]."""
NEW_REACH = 1.0
"""Distance in front of the robot's front end up to which people are taken [m]."""
AHEAD = radians(35)
"""Transducers that look farther aside find no new person [rad]."""
STRAIGHT = radians(20)
"""Bearing above which a person is not straight ahead [rad]."""
FACING = 0.3
"""Distance by which a person counts as farther away who is not straight ahead [m]: who wants to be
followed stands there."""
RETURN_REACH = 1.6
"""Distance from which a lost person may come back at most [m]."""
RETURN_NEAR = 0.7
"""Distance to the expected place at which a lost person may come back at most [m]."""
RETURN_AHEAD = radians(60)
"""Bearing at which a lost person may come back at most [rad]."""
FRONT = radians(60)
"""Transducers that look less aside than this are the front [rad]."""
FRESH = 0.5
"""Older echoes are not looked at [s]: each transducer fires three times a second."""
SAME_THING = 0.2
"""Difference of the ranges of neighbours below which they hear the same thing [m]."""
SENDS_BACK = 0.7
"""Share of half of a person's width from which echoes come back: they glance off its sides."""


@dataclass(frozen=True, slots=True)
class PersonDetector:
    """All that is heard at one instant: the last firing of each transducer, by its number."""

    latest: Mapping[int, Ping]
    now: float
    model: RobotModel
    clutter: ClutterMap

    def echoes(self) -> list[Ping]:
        """Return all that has echoed lately."""
        return [ping for ping in self.latest.values() if self._echo(ping)]

    def nearest_person(self) -> Ping | None:
        """Return the nearest echo in front that may be a person, or `None`."""
        mounts = self.model.sonars
        found = self._candidates(AHEAD, NEW_REACH)
        return _nearest(
            [
                (away + (FACING if abs(mounts[ping.number].theta) > STRAIGHT else 0.0), ping)
                for away, ping in found
            ]
        )

    def returning_person(self, x: float, y: float) -> Ping | None:
        """Return the nearest echo close to the place where a person is expected, or `None`."""
        found = self._candidates(RETURN_AHEAD, RETURN_REACH)
        return _nearest([pair for pair in found if _beside(pair[1], x, y) < RETURN_NEAR])

    def walls(self) -> set[int]:
        """Return the transducers that hear something wider than a person.

        Neighbours that hear nearly the same range hear one thing.
        """
        found: set[int] = set()
        run: list[Ping] = []
        for ping in self._from_left_to_right():
            if ping is not None and (not run or abs(ping.distance - run[-1].distance) < SAME_THING):
                run.append(ping)
                continue
            found.update(_if_wide(run))
            run = [ping] if ping is not None else []
        return found | _if_wide(run)

    def _from_left_to_right(self) -> list[Ping | None]:
        """Return the pings of the front; `None` where nothing echoed lately."""
        mounts = self.model.sonars
        front = [i for i, mount in enumerate(mounts) if abs(mount.theta) < FRONT]
        front.sort(key=lambda i: -mounts[i].theta)
        return [self._echo(self.latest.get(i)) for i in front]

    def _echo(self, ping: Ping | None) -> Ping | None:
        heard = ping is not None and self.now - ping.stamp <= FRESH and ping.distance < inf
        return ping if heard else None

    def _candidates(self, ahead: float, reach: float) -> list[tuple[float, Ping]]:
        """Return the echoes that may be a person, each with its distance from the centre [m]."""
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

    Transducers that look past a person by half a beam hear the person too, on either side.
    """
    if len(run) < 2:
        return set()
    nearest = min(ping.distance for ping in run)
    widest = 2 * (HALF_BEAM + asin(SENDS_BACK * RADIUS / (nearest + RADIUS)))
    span = abs(wrap(run[0].axis - run[-1].axis))
    return {ping.number for ping in run} if span > widest else set()
