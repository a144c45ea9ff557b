"""Chooses the person to follow and keeps to them, by sonar or by the legs in a laser's scans.

However they are sensed, the person is a :class:`FollowedPerson`: a filter's estimate, and when a
sensor last found them. How the rules differ is in docs/explanation/follow.md.
"""

from collections.abc import Callable
from math import atan2, hypot, inf
from typing import Protocol

from pioneer3.behaviors.action import Situation
from pioneer3.behaviors.detection import (
    AHEAD,
    FACING,
    RETURN_NEAR,
    STRAIGHT,
    ClutterMap,
    PersonDetector,
)
from pioneer3.behaviors.kalman import KalmanFilter
from pioneer3.behaviors.leg_tracking import LegTrack, LegTracks
from pioneer3.behaviors.pings import RING, Ping, PingReader
from pioneer3.behaviors.tracking import Track
from pioneer3.geometry import wrap

COAST = 1.2
"""A person who has not been heard for this long is lost [s]."""
RETURN = 4.0
"""For this long, a lost person is looked for around the expected place [s]."""
STANDS_STILL = 10.0
"""A track that has never walked is furniture after this time [s]."""
ALIKE_ECHOES = 0.15
"""Difference of the distances of echoes that may come from the same person [m]."""
LEGS_REACH = 1.5
"""People are taken up to this far in front of the robot's front end by their legs [m]."""
ONE_LEG = 0.5
"""Something with one leg counts as so much farther away than somebody with two [m]."""
SURE = 0.3
"""Legs that have been seen for so long may be somebody's [s]: noise does not last."""
WALKS_ON = 15
"""Scans in turn of walking after which a person comes before nearer things that never walked."""


class FollowedPerson(Protocol):
    """A person who is followed.

    Attributes:
        estimate: Of their middle, in odometry's frame.
        seen: When a sensor last found them [s].
        walked: Whether they have ever walked: furniture has not.
    """

    estimate: KalmanFilter
    seen: float
    walked: bool


class PersonTracker(Protocol):
    """Keeps to one person."""

    @property
    def target(self) -> FollowedPerson | None:
        """The person who is followed, if any."""

    @property
    def remark(self) -> str:
        """About the sensor, behind the reason of a desire; empty where all is as usual."""

    @property
    def blind(self) -> bool:
        """Whether its sensor has stopped working: it would not notice anybody."""

    def update(self, situation: Situation) -> None:
        """Take in all that is new, and choose a person if there is none."""


class SonarTracker:
    """Keeps to a person by the echoes of sonars; maybe to one followed by another sensor."""

    def __init__(self, person: FollowedPerson | None = None, now: float = 0.0) -> None:
        self.target: Track | None = None
        self.blind = False
        if person is not None:
            self.target = Track(person.estimate, now, walked=person.walked)
        self._listener = PingReader()
        self._clutter = ClutterMap()
        self._lost: Track | None = None

    @property
    def remark(self) -> str:
        """The reason that it hears nothing, or empty."""
        return "the sonars are off" if self.blind else ""

    def update(self, situation: Situation) -> None:
        """Listen to all new echoes."""
        self.blind = not situation.snapshot.sonar.enabled
        self._hear(self._listener.listen(situation))
        self._give_up(situation.now)
        if self.target is None:
            self._find(situation)

    def _hear(self, pings: list[Ping]) -> None:
        """Share new echoes out between the person and the furniture."""
        if self.target is not None:
            pings = self.target.hear(pings, self._clutter)
        for ping in pings:
            self._clutter.take(ping)

    def _give_up(self, now: float) -> None:
        """Forget a person who has been silent for too long, and furniture."""
        target = self.target
        if target is None:
            return
        if now - target.seen > COAST:
            self.target, self._lost = None, target
        elif not target.walked and now - target.found > STANDS_STILL:
            self.target = self._lost = None
            self._clutter.learn(target.echoes.values())

    def _find(self, situation: Situation) -> None:
        """Look for the lost person, then for any person."""
        now, lost = situation.now, self._lost
        if now - self._listener.since < RING:
            return  # only some of the sonars have been heard
        hearing = PersonDetector(self._listener.latest, now, situation.model, self._clutter)
        ping = None
        if lost is not None and now - lost.seen <= RETURN:
            ping = hearing.returning_person(*lost.estimate.at(now))
        ping = ping or hearing.nearest_person()
        if ping is not None:
            self._lost = None
            self.target = self._acquire(ping, hearing)

    def _acquire(self, first: Ping, hearing: PersonDetector) -> Track:
        """Return a track from an echo; other echoes of this time are clutter."""
        target, alike = Track.from_ping(first), []
        for ping in hearing.echoes():
            if ping is not first and abs(ping.distance - first.distance) < ALIKE_ECHOES:
                alike.append(ping)
            elif ping is not first:
                self._clutter.learn([ping])
        target.hear(alike, self._clutter)
        return target


class LegTracker:
    """Keeps to a person by the legs in a laser's scans, or to one that another sensor followed."""

    def __init__(self, person: FollowedPerson | None = None) -> None:
        self.target: LegTrack | None = None
        self.remark = ""
        self._tracks = LegTracks()
        self._lost: FollowedPerson | None = person
        self._stamp: float | None = None

    @property
    def blind(self) -> bool:
        """Whether scans came once and do not now; a laser takes a while to begin."""
        return bool(self.remark) and self._stamp is not None

    def update(self, situation: Situation) -> None:
        """Look at the newest scan."""
        scan, now = situation.scan, situation.now
        self.remark = "" if scan is not None else "no scans come from a laser"
        if scan is not None and scan.stamp != self._stamp:
            self._stamp = scan.stamp
            self._tracks.look(scan, self.target)
        self._give_up(now)
        if scan is not None and (self.target is None or not self.target.walked):
            self._find(situation)

    def _give_up(self, now: float) -> None:
        target = self.target
        if target is None:
            return
        if target not in self._tracks.tracks or self.remark:
            self.target, self._lost = None, target
        elif not target.walked and now - target.found > STANDS_STILL:
            self.target = self._lost = None
            self._tracks.settle(target)

    def _find(self, situation: Situation) -> None:
        """Look for the lost person, then for any person in front; who walks comes first."""
        found = [t for t in self._tracks.tracks if t.legs and t.seen - t.found >= SURE]
        back = self._returned(found, situation.now)
        ahead = {t: away for t in found if (away := _reluctance(t, situation)) < inf}
        walks = {t: away for t, away in ahead.items() if t.walked and t.strolls >= WALKS_ON}
        if back is not None:
            self.target = back
        elif walks:
            self.target = min(walks, key=walks.__getitem__)
        elif ahead and self.target is None:
            self.target = min(ahead, key=ahead.__getitem__)
        if self.target is not None:
            self._lost = None

    def _returned(self, found: list[LegTrack], now: float) -> LegTrack | None:
        """Return the track that is nearest to where a lost person is expected, or `None`."""
        lost = self._lost
        if lost is None or now - lost.seen > RETURN:
            return None
        x, y = lost.estimate.at(now)
        near = {t: hypot(t.estimate.state[0] - x, t.estimate.state[1] - y) for t in found}
        best = min(near, key=near.__getitem__, default=None)
        if best is None or near[best] > RETURN_NEAR:
            return None
        best.walked = best.walked or lost.walked
        return best


def _reluctance(track: LegTrack, situation: Situation) -> float:
    """Return how far away somebody is [m], with penalties; `inf` for nobody in front."""
    here, (x, y) = situation.pose, track.estimate.position
    away = hypot(x - here.x, y - here.y)
    bearing = abs(wrap(atan2(y - here.y, x - here.x) - here.theta))
    if bearing > AHEAD or away > LEGS_REACH + situation.model.length_front:
        return inf
    one_leg = not (track.pairs or track.walked)
    return away + FACING * (bearing > STRAIGHT) + ONE_LEG * one_leg


class LaserOrSonarTracker:
    """Keeps to a person by the legs while scans come, and by sonar while none do."""

    def __init__(self) -> None:
        self._tracker: SonarTracker | LegTracker = SonarTracker()
        self._scanned = False

    @property
    def target(self) -> FollowedPerson | None:
        return self._tracker.target

    @property
    def remark(self) -> str:
        """A warning after the laser was lost."""
        lost = self._scanned and isinstance(self._tracker, SonarTracker)
        return self._tracker.remark or ("by sonar, the laser is silent" if lost else "")

    @property
    def blind(self) -> bool:
        """Whether neither sensor works."""
        return self._tracker.blind

    def update(self, situation: Situation) -> None:
        """Go on with the better sensor that works."""
        legs = isinstance(self._tracker, LegTracker)
        if situation.scan is not None and not legs:
            self._tracker, self._scanned = LegTracker(self.target), True
        elif situation.scan is None and legs:
            self._tracker = SonarTracker(self.target, situation.now)
        self._tracker.update(situation)


TRACKERS: dict[str, Callable[[], PersonTracker]] = {
    "auto": LaserOrSonarTracker,
    "legs": LegTracker,
    "tracking": SonarTracker,
}
"""By rule (:data:`pioneer3.behaviors.modes.follow.RULES`)."""
