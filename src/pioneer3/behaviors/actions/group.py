"""Actions of robots in a group: formations, the track of a leader, apart from each other."""

from collections import deque
from dataclasses import dataclass, field, replace
from itertools import pairwise
from math import atan2, cos, dist, hypot, inf, pi, sin

from pioneer3.behaviors.action import Action, Desire, Situation
from pioneer3.behaviors.formations import Place
from pioneer3.behaviors.peers import Peer, Peers, named
from pioneer3.geometry import Pose2, Twist2, wrap

ALONG_GAIN = 0.8
"""Gain of the way off a moving place along it [1/s]: Kanayama's tracking law for robots with two
wheels (ICRA 1990)."""
ASIDE_GAIN = 2.0
"""Gain of the way off a moving place to its side [1/m^2]."""
HEADING_GAIN = 1.6
"""Gain of the heading off that of a moving place [1/m]."""
LEADER_STANDS = 0.05
"""Speed below which a leader stands [m/s]; its followers drive to their places and turn as it does.
"""
PLACE_REACHED = 0.08
"""Distance to the place beside a leader that stands within which it is reached [m]."""
HEADING_REACHED = 0.1
"""Angle to the heading of a leader that stands within which it is reached [rad]."""
STEEP_PLACE = 0.6
"""Bearing of the place from which on it turns where it stands [rad]."""
APPROACH = 0.6
"""Speed per way that is left [1/s]."""


def _find(leader: str, peers: Peers, now: float) -> Peer | None:
    """Return the leader, or `None` while it is not known where it is."""
    found = named(peers(), leader)
    return None if found is None or found.is_lost(now) else found


@dataclass(slots=True, kw_only=True)
class KeepFormation(Action):
    """Keeps a place beside a leader, as if both were parts of one body."""

    leader: str
    place: Place
    peers: Peers
    top_speed: float = inf
    name: str = "keep formation"

    def decide(self, situation: Situation) -> Desire:
        leader = _find(self.leader, self.peers, situation.now)
        if leader is None:
            return replace(_stand(f"it is not known where {self.leader} is"), lacks=True)
        there, twist = _beside(leader, self.place, situation.now)
        moves = abs(twist.v) > LEADER_STANDS
        v, w = _track(situation.pose, there, twist) if moves else _settle(situation.pose, there)
        off = hypot(there.x - situation.pose.x, there.y - situation.pose.y)
        return _bounded(situation, v, w, self.top_speed, f"{off:.2f} m off its place")


SPACING = 0.1
"""Distance between the points of a track that are remembered [m]."""
LONGEST = 400
"""Points of a track."""
LOOK_AHEAD = 0.4
"""A point of the track so far ahead is headed for [m]."""


@dataclass(slots=True, kw_only=True)
class FollowLeader(Action):
    """Follows the track of a leader, at a `distance` along it from middle to middle [m]."""

    leader: str
    distance: float
    peers: Peers
    top_speed: float = inf
    name: str = "follow leader"
    _track: deque[tuple[float, float]] = field(
        default_factory=lambda: deque(maxlen=LONGEST), init=False
    )

    def decide(self, situation: Situation) -> Desire:
        leader = _find(self.leader, self.peers, situation.now)
        if leader is None:
            return replace(_stand(f"it is not known where {self.leader} is"), lacks=True)
        ahead = leader.at(situation.now)
        here = situation.pose
        self._note(here, ahead)
        points = [(here.x, here.y), *self._track, (ahead.x, ahead.y)]
        gap = sum(dist(a, b) for a, b in pairwise(points))
        behind = gap - self.distance
        v = leader.twist.v + APPROACH * behind
        if behind < 0 and leader.twist.v < LEADER_STANDS:
            v = 0.0
        x, y = next((p for p in points[1:] if dist(p, points[0]) > LOOK_AHEAD), points[-1])
        off = wrap(atan2(y - here.y, x - here.x) - here.theta)
        v = max(0.0, v) * max(0.0, cos(off)) if abs(off) < STEEP_PLACE else 0.0
        w = 2.0 * off if v > 0 or (abs(off) > STEEP_PLACE and behind > 0) else 0.0
        return _bounded(situation, v, w, self.top_speed, f"{gap:.2f} m behind {self.leader}")

    def _note(self, here: Pose2, leader: Pose2) -> None:
        """Remember the track, and forget its part behind the robot."""
        track, robot = self._track, (here.x, here.y)
        if not track or dist(track[-1], (leader.x, leader.y)) > SPACING:
            track.append((leader.x, leader.y))
        while len(track) > 1 and dist(track[1], robot) <= dist(track[0], robot):
            track.popleft()


SETTLED = 0.05
"""So much too near to another one is near enough [m]."""


@dataclass(slots=True, kw_only=True)
class SpreadOut(Action):
    """Drives away from the other robots, until all are `apart` [m] from middle to middle."""

    apart: float
    peers: Peers
    speed: float = 0.3
    name: str = "spread out"
    done: bool = False

    def decide(self, situation: Situation) -> Desire:
        here, now = situation.pose, situation.now
        push_x = push_y = 0.0
        nearest = inf
        for peer in self.peers():
            there = peer.at(now)
            away_x, away_y = here.x - there.x, here.y - there.y
            distance = max(hypot(away_x, away_y), 0.01)
            nearest = min(nearest, distance)
            push = max(0.0, self.apart - distance) / distance
            push_x, push_y = push_x + push * away_x, push_y + push * away_y
        missing = self.apart - nearest
        self.done = missing <= SETTLED
        if self.done or hypot(push_x, push_y) < 1e-6:
            return _stand("far enough from the others")
        off = wrap(atan2(push_y, push_x) - here.theta)
        v = min(self.speed, APPROACH * missing + LEADER_STANDS) if abs(off) < STEEP_PLACE else 0.0
        return _bounded(situation, v, 2.0 * off, self.speed, f"{nearest:.2f} m from the next")


def _beside(leader: Peer, place: Place, now: float) -> tuple[Pose2, Twist2]:
    """Return the pose and the motion of a place that turns with its leader."""
    x, y = place
    pose, twist = leader.at(now), leader.twist
    forward, aside = twist.v - twist.w * y, twist.w * x
    there = pose @ Pose2(x, y)
    speed = hypot(forward, aside)
    if speed < LEADER_STANDS or forward <= 0:
        return there, Twist2(forward, twist.w)
    return Pose2(there.x, there.y, there.theta + atan2(aside, forward)), Twist2(speed, twist.w)


def _track(here: Pose2, there: Pose2, twist: Twist2) -> tuple[float, float]:
    """Return the velocity that follows a moving place [m/s, rad/s]."""
    off = here.inverse() @ there
    theta = wrap(off.theta)
    v = twist.v * cos(theta) + ALONG_GAIN * off.x
    w = twist.w + abs(twist.v) * (ASIDE_GAIN * off.y + HEADING_GAIN * sin(theta))
    return v, w


def _settle(here: Pose2, there: Pose2) -> tuple[float, float]:
    """Return the velocity to a place that stands, and then to its heading [m/s, rad/s]."""
    off = here.inverse() @ there
    distance, bearing = hypot(off.x, off.y), atan2(off.y, off.x)
    if distance < PLACE_REACHED:
        turn = wrap(off.theta)
        return 0.0, 0.0 if abs(turn) < HEADING_REACHED else 1.5 * turn
    if abs(bearing) > pi - STEEP_PLACE and distance < 4 * PLACE_REACHED:  # a little too far: back
        return -APPROACH * distance, 0.0
    if abs(bearing) > STEEP_PLACE:
        return 0.0, 1.5 * bearing
    return APPROACH * distance, 2.0 * bearing


def _stand(reason: str) -> Desire:
    return Desire(v=0.0, w=0.0, reason=reason)


def _bounded(situation: Situation, v: float, w: float, top: float, reason: str) -> Desire:
    limits = situation.limits
    top = min(top, limits.max_speed)
    return Desire(
        v=max(-top, min(top, v)),
        w=max(-limits.max_turn_rate, min(limits.max_turn_rate, w)),
        reason=reason,
    )
