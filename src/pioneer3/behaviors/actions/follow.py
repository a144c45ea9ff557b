"""Actions that follow: a person by sonar or laser, a colour by camera."""

from dataclasses import dataclass, field
from math import atan2, copysign, cos, degrees, hypot, inf, pi, radians
from typing import Protocol

from pioneer3.behaviors.action import Action, Desire, Goal, Situation
from pioneer3.behaviors.actions.sensing import BLIND
from pioneer3.behaviors.detection import RADIUS
from pioneer3.behaviors.trackers import FollowedPerson, PersonTracker, SonarTracker
from pioneer3.geometry import Pose2, wrap

BEARINGS = {
    1: radians(40),
    2: radians(40),
    3: 0.0,
    4: 0.0,
    5: radians(-40),
    6: radians(-40),
}
"""Bearing of an echo in the lab's rule, by transducer [rad]. Numbers begin with 0 at the front
left: 1 and 2, at 50 and 30 degrees, look to the left (facts.md 6.4)."""
LAB_REACH = 1.0
"""Farther echoes are no person [m]."""
SECONDS = 1.2
"""In which a difference shall be gone: three of the lab's cycles of 0.4 s [s]."""
FASTEST = 0.5
"""Highest speed forwards [m/s]."""
FASTEST_BACK = 0.3
"""Highest speed backwards [m/s]."""
FASTEST_TURN = radians(45)
"""Highest turn rate [rad/s]."""


@dataclass(slots=True, kw_only=True)
class FollowLab(Action):
    """Follow the nearest echo of the front, as the lab's `p3_sonar_following_moving_object` does.

    Speed (d - 0.3 m) / 1.2 s from -0.3 to 0.5 m/s, turn rate bearing / 1.2 s up to 45 degrees/s
    towards the echo; stand still when nothing is within 1.0 m. Distances are ranges of
    transducers: the lab takes them from points around the robot's centre and subtracts how far
    out each transducer sits, 0.16 to 0.24 m on a P3-AT, which gives the same within 15 mm, but
    for the outermost two, which it does not use. Unlike the lab's node, it decides at each report,
    ten times a second, not 2.5 times.

    Attributes:
        keep: Range to keep [m].
        goal: Where it takes the nearest echo to come from; `None` without any.
    """

    keep: float = 0.3
    name: str = "follow"
    goal: Goal | None = field(default=None, init=False)

    def decide(self, situation: Situation) -> Desire | None:
        sonar = situation.snapshot.sonar
        if not sonar.enabled:
            self.goal = None
            return Desire(v=0.0, w=0.0, lacks=True, reason=BLIND)
        ranges = sonar.ranges
        near = [(ranges[i], i) for i in BEARINGS if i < len(ranges) and ranges[i] <= LAB_REACH]
        distance, number = min(near, default=(inf, -1))
        self.goal = None
        if distance == inf:
            return Desire(v=0.0, w=0.0, reason="looks for somebody")
        self.goal = _place(situation, number, distance)
        speed = (distance - self.keep) / SECONDS
        turn_rate = BEARINGS[number] / SECONDS
        return Desire(
            v=max(-FASTEST_BACK, min(FASTEST, speed)),
            w=max(-FASTEST_TURN, min(FASTEST_TURN, turn_rate)),
            reason=f"follows at {distance:.2f} m, sonar {number}",
        )


def _place(situation: Situation, number: int, distance: float) -> Goal | None:
    """Return the place `distance` [m] before a transducer; `None` if its mount is not known."""
    sonars = situation.model.sonars
    if number >= len(sonars):
        return None
    mount = Pose2(sonars[number].x, sonars[number].y, sonars[number].theta)
    echo = situation.pose @ mount @ Pose2(distance)
    return Goal(x=echo.x, y=echo.y, person=True)


BLINK = 0.4
"""A pause of echoes this short is none [s]: a transducer fires every 0.32 s."""
LEAD = 0.1
"""The robot acts this much later [s]."""
SETTLE = 0.8
"""Time in which a wrong distance is to be made good [s]."""
TURN_GAIN = 2.0
"""Turn rate per bearing [1/s]."""
FACING = radians(4)
"""The robot need not turn to a person this straight ahead [rad]."""
FAR_ASIDE = radians(60)
"""Bearing of a person from which on the robot turns before it drives on [rad]."""


@dataclass(slots=True, kw_only=True)
class FollowTracking(Action):
    """Follow a person with a filter and a memory for furniture.

    Attributes:
        keep: Distance from the robot's front end to the person's outline [m].
        speed: Top speed [m/s].
        back: The same, backwards; only while they are sensed [m/s].
        turn_rate: Top turn rate [rad/s].
        tracker: Chooses the person, and keeps to them.
    """

    keep: float = 0.3
    speed: float = 0.5
    back: float = 0.3
    turn_rate: float = radians(60)
    tracker: PersonTracker = field(default_factory=SonarTracker)
    wants_scans: bool = False
    name: str = "follow"

    @property
    def target(self) -> FollowedPerson | None:
        """The person who is followed, or `None`."""
        return self.tracker.target

    @property
    def goal(self) -> Goal | None:
        """The estimated place of the person when a sensor last looked."""
        if self.target is None:
            return None
        x, y = self.target.estimate.position
        return Goal(x=x, y=y, person=True)

    def decide(self, situation: Situation) -> Desire | None:
        """Return the motion towards the person, or stand still and look for one."""
        self.tracker.update(situation)
        if self.target is None:
            blind, reason = self.tracker.blind, self._reason("looks for somebody")
            return Desire(v=0.0, w=0.0, lacks=blind, reason=reason)
        return self._follow(self.target, situation)

    def _reason(self, words: str) -> str:
        remark = self.tracker.remark
        return f"{words}, {remark}" if remark else words

    def _follow(self, target: FollowedPerson, situation: Situation) -> Desire:
        """Keep the distance, and face them; drive on only as far as they are ahead."""
        x, y = target.estimate.at(situation.now + LEAD)
        here = situation.pose
        dx, dy = x - here.x, y - here.y
        away, bearing = hypot(dx, dy), wrap(atan2(dy, dx) - here.theta)
        gap = away - RADIUS - situation.model.length_front
        silent = situation.now - target.seen
        vx, vy = target.estimate.velocity
        leaves = (vx * dx + vy * dy) / max(away, RADIUS)
        ahead = cos(bearing * (pi / 2) / FAR_ASIDE) if abs(bearing) < FAR_ASIDE else 0.0
        v = (leaves + (gap - self.keep) / SETTLE) * ahead
        v = max(-self.back if silent < BLINK else 0.0, min(self.speed, v))
        turn = max(0.0, abs(bearing) - FACING)
        w = copysign(min(self.turn_rate, TURN_GAIN * turn), bearing)
        return Desire(v=v, w=w, reason=self._reason(_words(gap, bearing, silent)))


def _words(gap: float, bearing: float, silent: float) -> str:
    if silent < BLINK:
        return f"follows at {gap:.2f} m"
    side = "left" if bearing > 0 else "right"
    ahead = "ahead" if abs(bearing) < radians(10) else f"{abs(degrees(bearing)):.0f} deg {side}"
    return f"lost for {silent:.1f} s, expects them {ahead}"


@dataclass(frozen=True, slots=True, kw_only=True)
class ColorPatch:
    """A patch of one colour in a picture.

    Attributes:
        x: Of its middle, -1 at the left edge to 1 at the right.
        y: -1 at the lower edge to 1 at the upper.
        area: Contribution of the picture, 0 to 1.
        stamp: When the picture was taken [s, monotonic].
    """

    x: float
    y: float = 0.0
    area: float = 0.0
    stamp: float


class BlobSource(Protocol):
    """Finds patches of colour in the picture of the robot's camera."""

    def largest(self, channel: int) -> ColorPatch | None:
        """Return the largest patch of a trained colour last seen, or `None`."""


@dataclass(slots=True)
class ColorFollow(Action):
    """Drives on and keeps a patch of colour in the middle; ARIA's example of ACTS, in our figures.

    It moves only while `moving`. When nothing is seen it stands, or turns to look for it while
    `acquiring`, towards where it was last.

    Attributes:
        turn_max: With the patch at the edge of the picture, ahead of the present heading [rad].
        dead_band: Nearer to the middle it drives straight ahead; share of half a picture.
        patience: A patch not seen for this long is lost [s].
        search_rate: When looking for one [rad/s].
    """

    source: BlobSource
    channel: int = 1
    speed: float = 0.2
    turn_max: float = radians(10)
    dead_band: float = 0.2
    patience: float = 2.0
    search_rate: float = radians(10)
    moving: bool = False
    acquiring: bool = False
    name: str = "color follow"
    _side: int = field(default=1, init=False)

    def decide(self, situation: Situation) -> Desire:
        blob = self.source.largest(self.channel)
        if blob is not None and situation.now - blob.stamp <= self.patience:
            return self._follow(blob)
        if self.moving and self.acquiring:
            return Desire(v=0.0, w=self._side * self.search_rate, reason="looking for the colour")
        return Desire(v=0.0, turn=0.0, reason="no blob in sight")

    def _follow(self, blob: ColorPatch) -> Desire:
        if blob.x:
            self._side = -1 if blob.x > 0 else 1
        if not self.moving:
            return Desire(v=0.0, turn=0.0, reason="blob in sight, movement off")
        turn = -blob.x * self.turn_max if abs(blob.x) > self.dead_band else 0.0
        return Desire(v=self.speed, turn=turn, reason=f"blob at {round(100 * blob.x)} %")
