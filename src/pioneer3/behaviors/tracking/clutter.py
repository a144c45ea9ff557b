"""What stands still: places in odometry's frame from which echoes come again and again."""

from collections.abc import Iterable
from dataclasses import dataclass
from math import inf

from pioneer3.behaviors.tracking.pings import HALF_BEAM, Ping

REACH = 2.5
"""Farther echoes are not remembered [m]."""
SAME = 0.12
"""Echoes that differ less come from the same place [m]."""
BESIDE = 1.4
"""Places up to this far outside a beam, in half beams, may have sent its echo."""
STANDS = 2.0
"""What has been at the same place for this long stands there [s]."""
OFTEN = 3
"""At least so many echoes make a place."""
FORGET = 30.0
"""Places that have not been heard of for this long are forgotten [s]."""
MOST = 200
"""Places that are kept."""


@dataclass(slots=True)
class Spot:
    """A place.

    Attributes:
        x: In odometry's frame [m].
        y: [m].
        first: When it was first heard of [s].
        last: When last [s].
        echoes: How often.
    """

    x: float
    y: float
    first: float
    last: float
    echoes: int = 1

    @property
    def stands(self) -> bool:
        """Whether it has been there for long enough to be furniture."""
        return self.echoes >= OFTEN and self.last - self.first >= STANDS


class Clutter:
    """Takes echoes that are nobody's.

    An echo comes from somewhere on an arc; it is said to come from a place that is known already,
    if one is on it.
    """

    def __init__(self) -> None:
        self.spots: list[Spot] = []

    def take(self, ping: Ping) -> None:
        """Remember an echo, and that nothing is before it any more."""
        if ping.distance <= REACH:
            spot = self._at(ping)
            if spot is None:
                self._add(ping)
            else:
                spot.last, spot.echoes = ping.stamp, spot.echoes + 1
        self._clear(ping)

    def learn(self, pings: Iterable[Ping]) -> None:
        """Remember that echoes come from furniture, though they have not been watched for long."""
        for ping in pings:
            spot = Spot(*ping.point, ping.stamp - STANDS, ping.stamp, OFTEN)
            self.spots = [*self.spots, spot][-MOST:]

    def explains(self, ping: Ping) -> float:
        """Return how much longer a range is than that to what stands there [m]; `inf`: nothing."""
        spot = self._at(ping, standing=True)
        return ping.distance - ping.seen(spot.x, spot.y)[0] if spot else inf

    def _at(self, ping: Ping, *, standing: bool = False) -> Spot | None:
        """Return the place that an echo fits best."""
        best, found = SAME, None
        for spot in self.spots:
            away, off = ping.seen(spot.x, spot.y)
            differs = abs(ping.distance - away)
            if differs < best and abs(off) < BESIDE * HALF_BEAM and (spot.stands or not standing):
                best, found = differs, spot
        return found

    def _add(self, ping: Ping) -> None:
        self.spots = [s for s in self.spots if ping.stamp - s.last < FORGET][-(MOST - 1) :]
        self.spots.append(Spot(*ping.point, ping.stamp, ping.stamp))

    def _clear(self, ping: Ping) -> None:
        """Doubt what should have sent a nearer echo. Slanting walls send none, so only doubt."""
        for spot in self.spots:
            away, off = ping.seen(spot.x, spot.y)
            if away < ping.distance - 2 * SAME and abs(off) < HALF_BEAM / 2 and away < REACH:
                spot.echoes -= 1
        self.spots = [spot for spot in self.spots if spot.echoes > 0]
