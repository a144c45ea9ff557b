"""One thing that may move: where it is, how fast it goes, and whether it is a person."""

from dataclasses import dataclass, field
from math import hypot, inf

from pioneer3.geometry import Pose2

FASTEST = 2.0
"""Nobody walks faster than this [m/s]."""
PLACE, SPEED = 0.5, 0.2
"""Share of an error of the place that corrects the place, and of the speed that would explain it
that corrects the speed."""
FADES = 0.8
"""Share of its speed that is left in each scan of a thing of which a part is seen."""
JUMP = 0.3
"""Larger errors are no motion [m]."""
CAME, TIMES, WALKING = 0.3, 4, 0.25
"""A thing walks that has come so far [m], in so many scans, at this speed at least [m/s]."""
STILL = 0.15
"""Slower than this it stands [m/s]."""
OFTEN = 4
"""Who looked like legs in so many scans is a person."""
HIDDEN = 15.0
"""So long after they were seen last, people are remembered who are out of sight [s]."""
COASTS = 0.4
"""So long after it was seen last a thing is expected to go on; then to stand [s]."""
LISTENS = 2.5
"""Sonars tell up to here that nobody is there [m]."""
HIT, DEEP, MISSED = 0.15, 0.5, 3
"""A sonar hears a body that its axis passes so near to the middle of [m], from no farther before
that [m]; whom sonars have missed so often, one after the other, has gone.
"""
MEMORY = 12
"""Places where a thing was that are remembered."""


@dataclass(slots=True)
class Mover:
    """A thing that may move, in the map's frame.

    Attributes:
        x: Where it was last [m].
        y: [m].
        vx: Its velocity [m/s].
        vy: [m/s].
        seen: When it was seen last [s].
        begin: Where it was first [m].
        times: How often it was seen.
        walks: Whether it has come some way since.
        stands: Since when it does [s]; `None` while it walks.
        heading: Direction in which it walked last, as a vector of length 1.
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
    begin: tuple[float, float]
    times: int = 1
    walks: bool = False
    stands: float | None = None
    heading: tuple[float, float] = (0.0, 0.0)
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
    def speed(self) -> float:
        """[m/s]."""
        return hypot(self.vx, self.vy)

    @property
    def still_since(self) -> float:
        """Since when it stands [s]; if it left the view while it walked, since then."""
        return self.seen if self.stands is None else self.stands

    def at(self, now: float) -> tuple[float, float]:
        """Return where it is expected at `now` [m]."""
        ahead = min(max(now - self.seen, 0.0), COASTS)
        return self.x + ahead * self.vx, self.y + ahead * self.vy

    def holds_two(self, now: float) -> bool:
        """Whether it may be two people, who stand together or pass each other."""
        return now - self.joined < HIDDEN

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
        if passed > COASTS:  # it was out of sight, and may have turned
            self.x, self.y, self.vx, self.vy = x, y, 0.0, 0.0
        elif whole:
            self._filter(x, y, passed, PLACE, SPEED)
        else:
            self._filter(x, y, passed, 0.0 if fits else PLACE / 2, 0.0)
            self.vx, self.vy = FADES * self.vx, FADES * self.vy
        self.seen, self.times, self.missed = now, self.times + 1, 0
        came = hypot(self.x - self.begin[0], self.y - self.begin[1])
        self.walks |= came > CAME and self.times > TIMES and self.speed > WALKING
        if self.speed > STILL:
            self.stands = None
            if self.speed > WALKING:
                self.heading = self.vx / self.speed, self.vy / self.speed
        elif self.stands is None:
            self.stands = now
        self.past = [*self.past[-MEMORY:], (x, y)]

    def hear(self, transducer: Pose2, metres: float, now: float) -> None:
        """Take in the echo of a sonar, which may be of it, or come from behind it."""
        x, y = self.at(now)
        off = transducer.inverse() @ Pose2(x, y)
        if off.x < 0.0 or abs(off.y) > HIT:
            return
        if min(metres, LISTENS) > off.x:
            self.missed += 1
        elif max(off.x - DEEP, 0.0) < metres <= off.x:
            self.missed, self.heard = 0, now

    def _filter(self, x: float, y: float, passed: float, place: float, speed: float) -> None:
        expected_x, expected_y = self.x + passed * self.vx, self.y + passed * self.vy
        off_x, off_y = x - expected_x, y - expected_y
        off = max(1.0, hypot(off_x, off_y) / JUMP)
        off_x, off_y = off_x / off, off_y / off
        self.x, self.y = expected_x + place * off_x, expected_y + place * off_y
        self.vx += speed * off_x / passed
        self.vy += speed * off_y / passed
        if self.speed > FASTEST:
            self.vx, self.vy = FASTEST * self.vx / self.speed, FASTEST * self.vy / self.speed
