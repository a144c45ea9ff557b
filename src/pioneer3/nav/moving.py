"""People and other things that move: where they are, and how fast they go, from scan to scan.

Echoes that no wall explains are joined to clusters, as far apart as two legs; each cluster belongs
to the nearest thing that is known, or begins another one. A thing that has come some way is a
walker from then on, also when it stands.
"""

from dataclasses import dataclass, field
from math import atan2, hypot, inf

import numpy as np
from numpy.typing import NDArray

Float = NDArray[np.float64]
Int = NDArray[np.int64]

JOINED = 0.45
"""Echoes nearer to each other than this are of one thing [m]: the legs of somebody who walks."""
WIDEST = 0.9
"""Larger things are no people [m]."""
NEAR = 5.0
"""Things farther away are not followed [m]."""
GATE, FASTEST = 0.45, 2.0
"""A thing is looked for so far from where it should be [m]; nobody walks faster than this [m/s]."""
PLACE, SPEED = 0.5, 0.2
"""Share of an error of the place that corrects the place, and of the speed that would explain it
that corrects the speed."""
FADES = 0.8
"""Share of its speed that is left in each scan of a thing of which a part is seen."""
COMPANY = 0.15
"""An echo without another one so near is a mistake of the laser, or too little of a thing [m]."""
SAME = 0.3
"""Things nearer to each other are one: the legs of one person [m]."""
JUMP = 0.3
"""Larger errors are no motion [m]."""
CAME, TIMES, WALKING = 0.3, 4, 0.25
"""A thing walks that has come so far [m], in so many scans, at this speed at least [m/s]."""
STILL = 0.15
"""Slower than this it stands [m/s]."""
SHANK, WIDE, CLOSE, OFTEN = 0.04, 0.15, 2.5, 4
"""Radius of a leg [m], and how wide parts of a thing are at most that are legs; in so many scans
from nearer than the third [m]."""
APART = 0.08
"""Echoes farther apart are of two legs [m]."""
UNSEEN, HIDDEN = 0.6, 15.0
"""A thing is forgotten that is not seen for so long [s]: in plain sight, and elsewhere."""
AT_EDGE = 0.1
"""So near to the edge of what the laser sees a thing is not seen whole [rad]."""
KNOWN = 10
"""Who was seen no more often than this is forgotten at once."""
COASTS = 0.4
"""So long after it was seen last a thing is expected to go on; then to stand [s]."""
BELIEVED = 15.0
"""Who looked like a person stays one for so long [s]: two who stand together do not look so."""
BEYOND = 0.19
"""A body ends so far before its legs at most [m]."""
NEW, ABOUT = 100, 60.0
"""A small thing that was seen less often may be people who stand together, where somebody was seen
within the latter [s].
"""
PARTS = 0.9
"""Who steps out of a thing of two people begins so near to it at most [m]."""
RADIUS = 0.28
"""Of people [m]: lasers see their legs alone."""
UNSURE = 0.08
"""Who is out of sight may be so much nearer [m]."""
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

    @property
    def is_person(self) -> bool:
        """Whether it walks, or stands on legs, or did so lately."""
        return self.walks or self.legs >= OFTEN or self.believed > self.seen

    @property
    def speed(self) -> float:
        """[m/s]."""
        return hypot(self.vx, self.vy)

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

    def correct(self, x: float, y: float, now: float, *, whole: bool = True) -> None:
        """Take in where it was seen at `now`, or where a part of it was."""
        passed = max(now - self.seen, 0.02)
        if passed > COASTS:  # it was out of sight, and may have turned
            self.x, self.y, self.vx, self.vy = x, y, 0.0, 0.0
        elif whole:
            self._filter(x, y, passed, PLACE, SPEED)
        else:
            self._filter(x, y, passed, PLACE / 2, 0.0)
            self.vx, self.vy = FADES * self.vx, FADES * self.vy
        self.seen, self.times = now, self.times + 1
        came = hypot(self.x - self.begin[0], self.y - self.begin[1])
        self.walks |= came > CAME and self.times > TIMES and self.speed > WALKING
        if self.speed > STILL:
            self.stands = None
            if self.speed > WALKING:
                self.heading = self.vx / self.speed, self.vy / self.speed
        elif self.stands is None:
            self.stands = now
        self.past = [*self.past[-MEMORY:], (x, y)]

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


class Movers:
    """All things that may move.

    Attributes:
        things: These.
        met: When somebody was among them last [s].
        doubtful: Echoes that may be of legs, as somebody is or was beside them [m], shape (D, 2).
    """

    def __init__(self) -> None:
        self.things: list[Mover] = []
        self.met = -inf
        self.doubtful: Float = np.empty((0, 2))
        self._lost: list[tuple[float, float, float]] = []

    def take(self, points: Float, origin: Float, limit: Float, now: float) -> Int:
        """Take the echoes of a scan that no wall explains.

        Args:
            points: In the map's frame [m], in the scan's order, shape (N, 2).
            origin: Of the laser there, shape (2,).
            limit: Bearing of the laser [rad] and half of its field of view [rad], shape (2,).
            now: [s].

        Returns:
            The indices of the points that are of walkers.
        """
        away = np.hypot(*(points - origin).T)
        near = np.flatnonzero((away < NEAR) & has_company(points))
        owner = self._owners(points[near], now)
        own: list[Int] = []
        for number, thing in enumerate(self.things):
            part = near[owner == number]
            if len(part):
                whole = _is_whole(points[part], origin, limit)
                thing.correct(*_middle(points[part], origin), now, whole=whole)
                if away[part].min() < CLOSE:
                    thing.legs = min(max(thing.legs + _legs(points[part]), -OFTEN), 2 * OFTEN)
                if thing.walks or thing.legs >= OFTEN:
                    thing.believed = now + BELIEVED
            if thing.walks:
                own.append(part)
        doubted = self._doubted(points[near], owner, now)
        new = near[owner < 0]
        for part in _clusters(points[new]):
            middle = _middle(points[new[part]], origin)
            self.things.append(self._begin(*middle, now))
            doubted[np.isin(near, new[part])] |= now - self.met < ABOUT
        self.doubtful = points[near[doubted]]
        self._merge(now)
        self._forget(points, origin, limit, now)
        if self.people():
            self.met = now
        return np.concatenate([*own, np.empty(0, dtype=np.int64)])

    def _owners(self, points: Float, now: float) -> Int:
        """Return the number of the thing that each point (N, 2) is of, -1 for none, shape (N,)."""
        if not self.things or not len(points):
            return np.full(len(points), -1)
        places = np.array([thing.at(now) for thing in self.things])
        off = np.hypot(*(points[:, None] - places[None]).transpose(2, 0, 1))
        off[:, [not thing.is_person for thing in self.things]] += SHANK  # people come first
        owner: Int = off.argmin(axis=1)
        owner[off.min(axis=1) > GATE] = -1
        return owner

    def _doubted(self, points: Float, owner: Int, now: float) -> NDArray[np.bool_]:
        """Return which echoes (N, 2) may be of somebody's legs, though they do not look so, (N,).

        Args:
            points: Echoes that no wall explains.
            owner: Numbers of the things that they are of, -1 for none, shape (N,).
            now: [s].
        """
        self._lost = [each for each in self._lost if each[2] > now - BELIEVED]
        places = [thing.at(now) for thing in self.things if thing.is_person]
        places += [(x, y) for x, y, _ in self._lost]
        about = now - self.met < ABOUT
        new = np.array([*(about and thing.times < NEW for thing in self.things), False])
        doubted: NDArray[np.bool_] = new[owner]  # -1, for none, is the last
        if places and len(points):
            off = np.hypot(*(points[:, None] - np.array(places)[None]).transpose(2, 0, 1))
            doubted = doubted | (off.min(axis=1) < PARTS)
        return doubted

    def _begin(self, x: float, y: float, now: float) -> Mover:
        """Return a new thing; one that steps out of a thing of two people is one of them."""
        new = Mover(x, y, 0.0, 0.0, now, (x, y))
        for thing in self.things:
            if thing.holds_two(now) and hypot(thing.x - x, thing.y - y) < PARTS:
                new.walks, new.legs, thing.joined = thing.walks, thing.legs, -inf
                break
        return new

    def _merge(self, now: float) -> None:
        """Let the older one of two things that are too near to each other take in the other."""
        kept: list[Mover] = []
        for thing in sorted(self.things, key=lambda each: -each.times):
            same = next((k for k in kept if hypot(thing.x - k.x, thing.y - k.y) <= SAME), None)
            if same is None:
                kept.append(thing)
            else:
                same.join(thing, now)
        self.things = kept

    def walking(self) -> list[Mover]:
        """Return the things that have come some way."""
        return [thing for thing in self.things if thing.walks]

    def people(self) -> list[Mover]:
        """Return the things that walk, or stand on legs."""
        return [thing for thing in self.things if thing.is_person]

    def discs(self, now: float) -> Float:
        """Return people: x, y [m], velocity [m/s] and radius [m], shape (W, 5)."""
        rows = []
        for thing in self.people():
            x, y = thing.at(now)
            moves = thing.stands is None and now - thing.seen < COASTS
            doubt = UNSURE if now - thing.seen > COASTS else 0.0
            doubt += SAME / 2 * thing.holds_two(now)
            rows.append((x, y, thing.vx * moves, thing.vy * moves, RADIUS + doubt))
        return np.array(rows).reshape(-1, 5)

    def _forget(self, points: Float, origin: Float, limit: Float, now: float) -> None:
        bearings = np.arctan2(points[:, 1] - origin[1], points[:, 0] - origin[0])
        ranges = np.hypot(*(points - origin).T)
        kept = []
        for thing in self.things:
            age = now - thing.seen
            patience = UNSEEN
            if thing.is_person and age > UNSEEN:
                x, y = thing.at(now)
                away = hypot(x - origin[0], y - origin[1])
                bearing = np.arctan2(y - origin[1], x - origin[0])
                off = (bearing - limit[0] + np.pi) % (2 * np.pi) - np.pi
                aside = atan2(GATE, away) + AT_EDGE
                beside = np.abs((bearings - bearing + np.pi) % (2 * np.pi) - np.pi) < 0.1
                hidden = abs(off) > limit[1] - aside or bool((ranges[beside] < away - 0.2).any())
                known = thing.times > KNOWN and (hidden or away < GATE)
                patience = HIDDEN if known else UNSEEN
            if age <= patience:
                kept.append(thing)
            elif thing.is_person:
                self._lost.append((*thing.at(now), now))
        self.things = kept

    def forget(self) -> None:
        """Forget everything."""
        self.things, self._lost, self.doubtful = [], [], np.empty((0, 2))


def _middle(points: Float, origin: Float) -> tuple[float, float]:
    """Return the middle of the box around points, as far behind them as that of a leg [m]."""
    x, y = ((points.min(axis=0) + points.max(axis=0)) / 2).tolist()
    dx, dy = x - float(origin[0]), y - float(origin[1])
    share = SHANK / max(hypot(dx, dy), SHANK)
    return x + share * dx, y + share * dy


def has_company(points: Float) -> NDArray[np.bool_]:
    """Return which of the points (N, 2) have a neighbour in the scan's order near them."""
    close = np.hypot(*np.diff(points, axis=0).T) < COMPANY
    company = np.zeros(len(points), dtype=np.bool_)
    company[1:] |= close
    company[:-1] |= close
    return company


def _is_whole(points: Float, origin: Float, limit: Float) -> bool:
    """Return whether no point (N, 2) is at the edge of what the laser sees."""
    bearings = np.arctan2(points[:, 1] - origin[1], points[:, 0] - origin[0])
    off = (bearings - limit[0] + np.pi) % (2 * np.pi) - np.pi
    return bool((np.abs(off) < limit[1] - AT_EDGE / 2).all())


def _legs(points: Float) -> int:
    """Return 1 if all parts of a thing are as narrow as legs, else -1."""
    apart = np.hypot(*np.diff(points, axis=0).T) > APART
    parts = np.split(points, np.flatnonzero(apart) + 1)
    return 1 if all(hypot(*np.ptp(part, axis=0).tolist()) < WIDE for part in parts) else -1


def _clusters(points: Float) -> list[Int]:
    """Return the indices of the points of each thing that is not too large.

    Points lie in the order of their bearings, so that neighbours are beside each other.
    """
    if not len(points):
        return []
    apart = np.hypot(*np.diff(points, axis=0).T) > JOINED
    parts = np.split(np.arange(len(points)), np.flatnonzero(apart) + 1)
    small = []
    for part in parts:
        size = np.ptp(points[part], axis=0)
        if hypot(size[0], size[1]) < WIDEST:
            small.append(part)
    return small
