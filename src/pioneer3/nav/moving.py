"""People and other things that move: where they are, and how fast they go, from scan to scan.

Each cluster of echoes belongs to the nearest thing that is known, or begins another one. A thing
that has come some way is a walker from then on, also when it stands.
"""

from math import atan2, hypot, inf

import numpy as np

from pioneer3.arrays import Bool, Float, Int
from pioneer3.geometry import Pose2
from pioneer3.nav.clusters import (
    FIELD_EDGE,
    JOIN_DISTANCE,
    SHANK_RADIUS,
    STANCE,
    clusters,
    is_whole,
    looks_like_legs,
    middle_of,
)
from pioneer3.nav.mover import COASTING_TIME, MEMORY_TIME, NEAR_RANGE, OFTEN, STEP_LENGTH, Mover

PEOPLE_TIME = 60.0
"""Time since somebody was seen for which people are about, and things stay noted; and since a thing
was seen first for which it may be people who stand together [s]."""
BESIDE = 0.95
"""Distance of people who are beside each other, or beside the robot, and stand because of it [m].
"""
PERSON_RADIUS = 0.28
"""Radius of people [m]: lasers see their legs alone."""
UNSEEN_MARGIN = 0.1
"""Distance by which somebody out of sight, and one of two, may be nearer [m]."""


class Movers:
    """All things that may move.

    Attributes:
        met: When somebody was among them last [s].
        doubtful: Echoes that may be of legs, as somebody is or was beside them [m], shape (D, 2).
    """

    def __init__(self) -> None:
        self.things: list[Mover] = []
        self.met = -inf
        self.doubtful: Float = np.empty((0, 2))
        self._lost: list[tuple[float, float, float]] = []

    def take(self, points: Float, origin: Float, limit: Float, now: float) -> Int:
        """Take the echoes of a scan that no wall explains; return the indices of walkers' ones.

        Echoes (N, 2), none of which stands alone, are in the map's frame [m], in the scan's order,
        as is the laser's `origin` (2,); `limit` (2,) is the bearing of the laser and half of its
        field of view [rad].
        """
        away = np.hypot(*(points - origin).T)
        owner = self._owners(points, now)
        own: list[Int] = []
        for number, thing in enumerate(self.things):
            part = np.flatnonzero(owner == number)
            if len(part):
                x, y = thing.at(now)
                whole = is_whole(points[part], origin, limit, (x, y))
                fits = bool((np.hypot(*(points[part] - (x, y)).T) < STANCE).all())
                thing.correct(*middle_of(points[part], origin), now, whole=whole, fits=fits)
                reach = float(np.hypot(*(points[part] - (thing.x, thing.y)).T).max())
                thing.reach = reach if whole else max(thing.reach, reach)
                if whole and away[part].min() < NEAR_RANGE:  # a strip of a wall is as narrow
                    seen = 1 if looks_like_legs(points[part]) else -1
                    thing.legs = min(max(thing.legs + seen, -OFTEN), 2 * OFTEN)
                moves = thing.is_person and thing.stands is None
                if thing.walks or thing.legs >= OFTEN or moves:
                    thing.believed = now + MEMORY_TIME
            if thing.walks:
                own.append(part)
        doubted = self._doubted(points, owner, now)
        new = np.flatnonzero(owner < 0)
        for part in clusters(points[new]):
            middle = middle_of(points[new[part]], origin)
            self.things.append(self._begin(*middle, now))
            doubted[new[part]] |= self.are_about(now)
        self.doubtful = points[doubted]
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
        off[:, [not thing.is_person for thing in self.things]] += SHANK_RADIUS  # people come first
        owner: Int = off.argmin(axis=1)
        owner[off.min(axis=1) > JOIN_DISTANCE] = -1
        return owner

    def _doubted(self, points: Float, owner: Int, now: float) -> Bool:
        """Return which echoes (N, 2) may be of somebody's legs, though they do not look so, (N,).

        The `owner` (N,) of each is the number of the thing that it is of, -1 for none.
        """
        self._lost = [each for each in self._lost if each[2] > now - MEMORY_TIME]
        places = [thing.at(now) for thing in self.things if thing.is_person]
        places += [(x, y) for x, y, _ in self._lost]
        about = self.are_about(now)
        may = [now - thing.begin[2] < PEOPLE_TIME or thing.believed > -inf for thing in self.things]
        doubted: Bool = np.array([*may, False])[owner] & about  # -1, for none, is the last
        if places and len(points):
            off = np.hypot(*(points[:, None] - np.array(places)[None]).transpose(2, 0, 1))
            doubted = doubted | (off.min(axis=1) < BESIDE)
        return doubted

    def _begin(self, x: float, y: float, now: float) -> Mover:
        """Return a new thing; one that steps out of a thing of two people is one of them."""
        new = Mover(x, y, 0.0, 0.0, now, (x, y, now))
        for thing in self.things:
            if thing.holds_two(now) and hypot(thing.x - x, thing.y - y) < BESIDE:
                new.walks, new.legs, thing.joined = thing.walks, thing.legs, -inf
                break
        return new

    def _merge(self, now: float) -> None:
        """Let the older one of two things that are too near to each other take in the other."""
        kept: list[Mover] = []
        for thing in sorted(self.things, key=lambda each: -each.times):
            near = (k for k in kept if hypot(thing.x - k.x, thing.y - k.y) <= STEP_LENGTH)
            same = next(near, None)
            if same is None:
                kept.append(thing)
            else:
                same.join(thing, now)
        self.things = kept

    def are_about(self, now: float) -> bool:
        """Return whether somebody was seen within the last minute: then much may change soon."""
        return now - self.met < PEOPLE_TIME

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
            moves = thing.stands is None and now - thing.seen < COASTING_TIME
            two = thing.holds_two(now) or thing.legs <= -OFTEN  # together they look like no legs
            radius = PERSON_RADIUS + UNSEEN_MARGIN * ((now - thing.seen > COASTING_TIME) + two)
            if thing.stands is not None:  # it may be two, side by side
                radius = max(radius, PERSON_RADIUS - STANCE + thing.reach)
            rows.append((x, y, thing.vx * moves, thing.vy * moves, radius))
        return np.array(rows).reshape(-1, 5)

    def _forget(self, points: Float, origin: Float, limit: Float, now: float) -> None:
        bearings = np.arctan2(points[:, 1] - origin[1], points[:, 0] - origin[0])
        ranges = np.hypot(*(points - origin).T)
        kept = []
        for thing in self.things:
            age, patience = now - thing.seen, COASTING_TIME
            if thing.is_person and age > COASTING_TIME:
                x, y = thing.at(now)
                away = hypot(x - origin[0], y - origin[1])
                bearing = np.arctan2(y - origin[1], x - origin[0])
                off = (bearing - limit[0] + np.pi) % (2 * np.pi) - np.pi
                aside = atan2(JOIN_DISTANCE, away) + FIELD_EDGE
                beside = np.abs((bearings - bearing + np.pi) % (2 * np.pi) - np.pi) < 0.1
                hidden = abs(off) > limit[1] - aside or bool((ranges[beside] < away - 0.2).any())
                known = thing.times > 2 * OFTEN or away < BESIDE
                if known and (hidden or away < JOIN_DISTANCE):
                    patience = MEMORY_TIME
                if known and hidden:
                    age = now - max(thing.seen, thing.heard)
            if age <= patience:
                kept.append(thing)
            elif thing.is_person:
                self._lost.append((*thing.at(now), now))
        self.things = kept

    def hear(self, transducer: Pose2, metres: float, now: float) -> None:
        """Forget people out of sight whom a sonar does not hear where they should be.

        The transducer is in the map's frame [m, rad]; `metres` are `inf` where nothing echoed.
        """
        for thing in self.things:
            if thing.is_person and now - thing.seen > COASTING_TIME:
                thing.hear(transducer, metres, now)
        self.things = [thing for thing in self.things if thing.missed < OFTEN]

    def forget(self) -> None:
        """Forget everything."""
        self.things, self._lost, self.doubtful = [], [], np.empty((0, 2))
