"""Tracks all people in the scans of a laser, and all else that looks like legs."""

from dataclasses import dataclass
from itertools import combinations
from math import asin, atan2, hypot, sqrt

from pioneer3.behaviors.kalman import KalmanFilter
from pioneer3.behaviors.legs import Leg, find_legs, gap_to, range_towards
from pioneer3.geometry import Pose2
from pioneer3.state import Scan

FASTEST_PERSON = 2.0
"""Highest speed of a person [m/s]."""
BORN_SIGMA = 0.1
"""Standard deviation of the place of a person who has just been seen [m]."""
BOTH_SIGMA = 0.04
"""Standard deviation of the middle of a person of whom two legs are seen [m]."""
ONE_SIGMA = 0.12
"""Standard deviation of the middle of a person of whom one leg is seen [m]."""
PART_SIGMA = 0.15
"""Standard deviation of the middle of a person of whom one leg is seen in part [m]."""
GATE_SIGMAS = 2.5
"""Standard deviations from the expected middle within which a leg belongs to a person."""
LEGS_APART = 0.15
"""Distance of the legs of somebody who stands, half of which is added to that [m]."""
STEP_TIME = 0.3
"""Time of half a step, the way in which is added to that of somebody who walks [s]."""
WIDEST_GATE = 0.6
"""Distance from the expected middle at which a leg belongs to a person at most [m]."""
CLOSEST = 0.1
"""Distance of the two legs of a person at least [m]."""
WIDEST_STANCE = 0.5
"""Distance of the two legs of a person who stands at most [m]."""
LONGEST_STEP = 0.7
"""Distance of the two legs of a person who walks at most [m]."""
PERSONAL = 0.4
"""Distance to a person within which no other one begins [m]."""
SPLIT = 5
"""Scans in turn with one leg in each of two tracks side by side after which both are of one person.
"""
WALKED_WAY = 0.5
"""Way above which a track walks [m]."""
STROLL_SPEED = 0.15
"""Speed above which a track walks [m/s]."""
STROLLS = 8
"""Scans in turn at that speed after which a track walks: what jumps from one leg of a chair to the
next does not do so for long."""
STANDING_TIME = 2.0
"""Time after which a track that stays is furniture [s]."""
STAYING_WAY = 0.25
"""Way below which a track stays [m]."""
MISSED_TIME = 1.0
"""Time without plain sight after which a person is given up [s]."""
HIDDEN_TIME = 3.0
"""Time after which a person is given up who is behind something, or outside the field of view [s].
"""
NEVER_WALKED = 1.5
"""Time after which a track is given up that has never walked [s]."""
HIDING_GAP = 0.2
"""Distance from a person to something nearer to the laser that hides them [m]."""
FURNITURE_RADIUS = 0.12
"""Distance to furniture within which a leg is furniture [m]."""
FURNITURE_GAIN = 0.5
"""Share of the difference by which the place of furniture is moved: odometry is wrong when the
robot turns."""
FORGET = 30.0
"""Time after which furniture that has not been seen is forgotten [s]."""
SEEN_PAST = 3
"""Scans in turn that see past furniture after which it is gone."""
MOST_FURNITURE = 100
"""Pieces of furniture that are kept at most."""


@dataclass(slots=True)
class Furniture:
    """A place of a leg that stands still, in odometry's frame [m], last seen at `seen` [s].

    So many scans in turn have seen `past` it.
    """

    x: float
    y: float
    seen: float
    past: int = 0


class LegTrack:
    """A person, tracked by the legs: `legs` in the last scan, the first one `found` at a time [s].

    Attributes:
        estimate: Of the middle between their legs, in odometry's frame.
        walked: Whether they have ever left the place where they were first seen.
        single: For how many scans in turn only one leg has been seen.
        strolls: For how many they have moved as fast as somebody who walks.
    """

    def __init__(self, legs: list[Leg], stamp: float) -> None:
        x, y = _middle(legs)
        self.estimate = KalmanFilter(x, y, stamp, BORN_SIGMA, FASTEST_PERSON)
        self.seen = self.found = stamp
        self.walked = False
        self.pairs = int(_is_pair(legs))
        self.single = self.strolls = 0
        self.legs = legs
        self._first = x, y

    @property
    def strayed(self) -> float:
        """How far they are from the place where they were first seen [m]."""
        x, y = self.estimate.position
        return hypot(x - self._first[0], y - self._first[1])

    @property
    def gate(self) -> float:
        """How far from the expected middle a leg may be [m]."""
        doubt = max(self.estimate.spread[0][0], self.estimate.spread[1][1])
        step = STEP_TIME * hypot(*self.estimate.velocity) if self.walked else LEGS_APART / 2
        return min(LEGS_APART + step + GATE_SIGMAS * sqrt(doubt), WIDEST_GATE)

    def accepts(self, leg: Leg) -> bool:
        """Return whether a leg may be theirs beside those that are already."""
        if not self.legs:
            return True
        one = self.legs[0]
        apart = gap_to(one, leg.x, leg.y)
        widest = LONGEST_STEP if self.walked else WIDEST_STANCE
        return len(self.legs) == 1 and not (one.both or leg.both) and CLOSEST < apart < widest

    def correct(self, stamp: float) -> None:
        """Take in the legs of the scan of `stamp` [s]."""
        if not self.legs:
            return
        pair = _is_pair(self.legs)
        self.seen, self.pairs = stamp, self.pairs + pair
        self.single = 0 if pair else self.single + 1
        whole = all(leg.free for leg in self.legs)
        sigma = BOTH_SIGMA if pair and whole else ONE_SIGMA if pair or whole else PART_SIGMA
        x, y = _middle(self.legs)
        self.estimate.correct(1.0, 0.0, x - self.estimate.state[0], sigma)
        self.estimate.correct(0.0, 1.0, y - self.estimate.state[1], sigma)
        self.strolls = self.strolls + 1 if hypot(*self.estimate.velocity) > STROLL_SPEED else 0
        self.walked = self.walked or (self.strayed > WALKED_WAY and self.strolls >= STROLLS)


class LegTracks:
    """All people and all furniture that the scans have shown.

    There are `tracks` of people, and of whatever has not stood still for long.
    """

    def __init__(self) -> None:
        self.tracks: list[LegTrack] = []
        self.furniture: list[Furniture] = []

    def look(self, scan: Scan, followed: LegTrack | None = None) -> None:
        """Take in a scan; `followed` is given up only when it is lost, though it stands still."""
        stamp = scan.stamp
        for track in self.tracks:
            track.estimate.advance(stamp)
            track.legs = []
        others = self._assign(self._without_furniture(find_legs(scan), stamp))
        for track in self.tracks:
            track.correct(stamp)
        self._merge(followed)
        self._begin([leg for leg in others if leg.free], stamp)
        self._give_up(scan, followed)
        self._clear(scan)

    def settle(self, track: LegTrack) -> None:
        """Take a track for furniture."""
        self.tracks.remove(track)
        new = [Furniture(leg.x, leg.y, track.seen) for leg in track.legs]
        self.furniture = [*self.furniture, *new][-MOST_FURNITURE:]

    def _without_furniture(self, legs: list[Leg], stamp: float) -> list[Leg]:
        """Return the legs that are no furniture; note where furniture is now."""
        left = []
        for leg in legs:
            spot = min(self.furniture, key=lambda s: gap_to(leg, s.x, s.y), default=None)
            if spot is None or gap_to(leg, spot.x, spot.y) > FURNITURE_RADIUS:
                left.append(leg)
                continue
            spot.seen, spot.past = stamp, 0
            if leg.free:
                spot.x += FURNITURE_GAIN * (leg.x - spot.x)
                spot.y += FURNITURE_GAIN * (leg.y - spot.y)
        return left

    def _assign(self, legs: list[Leg]) -> list[Leg]:
        """Give each leg to the nearest track, the nearest ones first; return the others."""
        near = []
        for track in self.tracks:
            (x, y), gate = track.estimate.position, track.gate
            near += [(gap, track, leg) for leg in legs if (gap := gap_to(leg, x, y)) < gate]
        near.sort(key=lambda found: found[0])
        left = set(range(len(legs)))
        numbers = {id(leg): number for number, leg in enumerate(legs)}
        for _, track, leg in near:
            if numbers[id(leg)] in left and track.accepts(leg):
                track.legs.append(leg)
                left.remove(numbers[id(leg)])
        return [leg for number, leg in enumerate(legs) if number in left]

    def _begin(self, legs: list[Leg], stamp: float) -> None:
        """Begin a track with each leg, or with each two, that are nobody's."""
        people = [track.estimate.position for track in self.tracks if track.walked and track.legs]
        legs = [leg for leg in legs if all(gap_to(leg, x, y) > PERSONAL for x, y in people)]
        while legs:
            one = legs.pop()
            alike = [leg for leg in legs if CLOSEST < gap_to(one, leg.x, leg.y) < WIDEST_STANCE]
            alike = [] if one.both else [leg for leg in alike if not leg.both]
            pair = [one]
            if alike:
                pair.append(min(alike, key=lambda leg: gap_to(leg, one.x, one.y)))
                legs.remove(pair[1])
            self.tracks.append(LegTrack(pair, stamp))

    def _merge(self, followed: LegTrack | None) -> None:
        """Drop the younger of two tracks that have one leg each of the same person."""
        single = [track for track in self.tracks if track.single >= SPLIT and track.legs]
        for older, younger in combinations(single, 2):
            apart = gap_to(older.legs[0], younger.legs[0].x, younger.legs[0].y)
            if apart < WIDEST_STANCE and older in self.tracks and younger in self.tracks:
                self.tracks.remove(older if younger is followed else younger)

    def _give_up(self, scan: Scan, followed: LegTrack | None) -> None:
        """Forget people who are gone; take for furniture what stands still."""
        for track in tuple(self.tracks):
            known = track.walked or track is followed
            patience = NEVER_WALKED
            if known:
                patience = HIDDEN_TIME if _may_be_hidden(scan, track) else MISSED_TIME
            if scan.stamp - track.seen > patience:
                self.tracks.remove(track)
            elif (
                not known
                and scan.stamp - track.found > STANDING_TIME
                and track.strayed < STAYING_WAY
            ):
                self.settle(track)

    def _clear(self, scan: Scan) -> None:
        """Forget furniture that has not been seen for long, or that beams pass by."""
        for spot in self.furniture:
            if spot.seen < scan.stamp and _is_past(scan, spot.x, spot.y):
                spot.past += 1
        self.furniture = [
            spot
            for spot in self.furniture
            if spot.past < SEEN_PAST and scan.stamp - spot.seen <= FORGET
        ]


def _is_pair(legs: list[Leg]) -> bool:
    return len(legs) == 2 or legs[0].both


def _middle(legs: list[Leg]) -> tuple[float, float]:
    return sum(leg.x for leg in legs) / len(legs), sum(leg.y for leg in legs) / len(legs)


def _may_be_hidden(scan: Scan, track: LegTrack) -> bool:
    """Return whether a person may be behind something, or beside the field of view."""
    away, bearing = _polar(scan, *track.estimate.position)
    beside = asin(min(1.0, track.gate / max(away, track.gate)))
    sides = (bearing - beside, bearing, bearing + beside)
    return any(range_towards(scan, side) < away - HIDING_GAP for side in sides)


def _is_past(scan: Scan, x: float, y: float) -> bool:
    """Return whether a laser sees past a point."""
    away, bearing = _polar(scan, x, y)
    return range_towards(scan, bearing) > away + HIDING_GAP


def _polar(scan: Scan, x: float, y: float) -> tuple[float, float]:
    """Return the distance of a point from the laser [m], and its bearing there [rad]."""
    there = scan.sensor_in_odom.inverse() @ Pose2(x, y)
    return hypot(there.x, there.y), atan2(there.y, there.x)
