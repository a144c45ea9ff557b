"""One thing that may move: where it is, how fast it goes, and whether it is a person."""

from dataclasses import dataclass, field
from math import hypot, inf

from pioneer3.geometry import Pose2

WALKING_SPEED = 0.25
"""Speed above which a thing walks [m/s]."""
STANDING_SPEED = 0.15
"""Speed below which it stands [m/s]."""
PLACE_SHARE = 0.5
"""Share of an error of the place that corrects the place."""
SPEED_SHARE = 0.2
"""Share of the speed that would explain that error that corrects the speed, and share of the speed
that is lost in each scan of a thing of which a part is seen."""
STEP_LENGTH = 0.3
"""Error of a place above which it is no motion, way that makes a thing a walker, and distance below
which two things are one [m]: the legs of one person."""
OFTEN = 4
"""Scans after which a thing is what it looks like, and echoes of sonars without it, one after the
other, after which it has gone."""
MEMORY_TIME = 15.0
"""Time for which people stay people, whatever they look like, and out of sight; and for which plans
avoid what sonars alone heard where nobody is [s]."""
COASTING_TIME = 0.5
"""Time since a thing was seen for which it is expected to go on, then to stand [s]."""
NEAR_RANGE = 2.5
"""Range within which legs look like legs, and sonars tell that nobody is there [m]."""
HEARD_ASIDE = 0.15
"""Distance of a body's middle from the axis of a sonar within which that hears it [m]."""
HEARD_BEFORE = 0.5
"""Distance before its middle from which its echo comes at most [m]."""
PLACES = 12
"""Number of places where a thing was that are remembered."""


@dataclass(slots=True)
class Mover:
    """A thing that may move, in the map's frame.

    Attributes:
        x: Where it was last [m].
        y: [m].
        vx: Its velocity [m/s].
        vy: [m/s].
        seen: When it was seen last [s].
        begin: Where it was first [m], and when [s].
        times: How often it was seen.
        walks: Whether it has come some way since.
        stands: Since when it does [s]; `None` while it walks.
        heading: Direction in which it walked last, as a vector of length 1.
        reach: Distance of its farthest echo from its middle in the last scan that saw all of it, or
            in one since [m].
        past: Places where it was [m].
        legs: In how many scans it looked like legs, less those in which it did not.
        believed: Until when it is a person, whatever it looks like [s].
        joined: When somebody else came so near that both were one thing from then on [s].
        heard: When a sonar heard it where it should be [s].
        missed: How often sonars heard nothing where it should be, since it was seen or heard.
    """

    x: float
    y: float
    vx: float
    vy: float
    seen: float
    begin: tuple[float, float, float]
    times: int = 1
    walks: bool = False
    stands: float | None = None
    heading: tuple[float, float] = (0.0, 0.0)
    reach: float = 0.0
    past: list[tuple[float, float]] = field(default_factory=list)
    legs: int = 0
    believed: float = -inf
    joined: float = -inf
    heard: float = -inf
    missed: int = 0

    @property
    def is_person(self) -> bool:
        """Whether it walks, or stands on legs, or did so lately."""
        return self.walks or self.legs >= OFTEN or self.believed > self.seen

    @property
    def still_since(self) -> float:
        """Since when it stands [s]; if it left the view while it walked, since then."""
        return self.seen if self.stands is None else self.stands

    def at(self, now: float) -> tuple[float, float]:
        """Return where it is expected at `now` [m]."""
        ahead = min(max(now - self.seen, 0.0), COASTING_TIME)
        return self.x + ahead * self.vx, self.y + ahead * self.vy

    def holds_two(self, now: float) -> bool:
        """Whether it may be two people, who stand together or pass each other."""
        return now - self.joined < MEMORY_TIME

    def join(self, other: "Mover", now: float) -> None:
        """Take in another thing at the same place; if that is a person, this is one, too."""
        if not other.is_person:
            return
        if self.is_person:
            self.joined = now
        if not any(self.heading):
            self.heading = other.heading
        self.walks |= other.walks
        self.legs = max(self.legs, other.legs)
        self.believed = max(self.believed, other.believed)

    def correct(
        self, x: float, y: float, now: float, *, whole: bool = True, fits: bool = False
    ) -> None:
        """Take in where it was seen at `now`, or where a part of it was.

        Args:
            x: Middle of the echoes [m].
            y: [m].
            now: [s].
            whole: Whether the laser sees all of it.
            fits: Whether all echoes are where they are if it went on as expected.
        """
        passed = max(now - self.seen, 0.02)
        if self.stands is not None and self.holds_two(now):
            self.joined += passed  # as long as they stand
        if passed > COASTING_TIME:  # it was out of sight, and may have turned
            self.x, self.y, self.vx, self.vy = x, y, 0.0, 0.0
        elif whole:
            self._filter(x, y, passed, PLACE_SHARE, SPEED_SHARE)
        else:
            self._filter(x, y, passed, 0.0 if fits else PLACE_SHARE / 2, 0.0)
            self.vx, self.vy = (1 - SPEED_SHARE) * self.vx, (1 - SPEED_SHARE) * self.vy
        self.seen, self.times, self.missed = now, self.times + 1, 0
        came = hypot(self.x - self.begin[0], self.y - self.begin[1])
        speed = hypot(self.vx, self.vy)
        self.walks |= came > STEP_LENGTH and self.times > OFTEN and speed > WALKING_SPEED
        if speed > STANDING_SPEED:
            self.stands = None
            if speed > WALKING_SPEED:
                self.heading = self.vx / speed, self.vy / speed
        elif self.stands is None:
            self.stands = now
        self.past = [*self.past[-PLACES:], (x, y)]

    def hear(self, transducer: Pose2, metres: float, now: float) -> None:
        """Take in the echo of a sonar, which may be of it, or come from behind it."""
        x, y = self.at(now)
        off = transducer.inverse() @ Pose2(x, y)
        if off.x < 0.0 or abs(off.y) > HEARD_ASIDE:
            return
        if min(metres, NEAR_RANGE) > off.x:
            self.missed += 1
        elif max(off.x - HEARD_BEFORE, 0.0) < metres <= off.x:
            self.missed, self.heard = 0, now

    def _filter(self, x: float, y: float, passed: float, place: float, speed: float) -> None:
        expected_x, expected_y = self.x + passed * self.vx, self.y + passed * self.vy
        off_x, off_y = x - expected_x, y - expected_y
        off = max(1.0, hypot(off_x, off_y) / STEP_LENGTH)
        off_x, off_y = off_x / off, off_y / off
        self.x, self.y = expected_x + place * off_x, expected_y + place * off_y
        self.vx += speed * off_x / passed
        self.vy += speed * off_y / passed
