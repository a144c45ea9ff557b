"""The limiter that keeps robots apart which know each other's places."""

from dataclasses import dataclass
from math import atan2, cos, hypot, inf, pi, sin, sqrt

from pioneer3.behaviors.action import Action, Desire, Situation
from pioneer3.behaviors.actions.limiters import CREEP
from pioneer3.behaviors.peers import LOST, Peer, Peers
from pioneer3.geometry import Pose2, wrap
from pioneer3.models import RobotModel

MARGIN = 0.1
"""Kept between the circles around two robots [m]."""
BESIDE = 0.05
"""Robots side by side, so far apart, do not touch while they drive straight on [m]."""
STRAIGHT = 0.1
"""A turn rate below this is straight on [rad/s]."""
PAST = 0.05
"""Cosine of a bearing at which a robot comes no nearer."""
STRAYS = 0.1
"""A robot that has become silent may go so much faster than it did [m/s], for so long [s]."""
STRAYS_FOR = 2.0
REACTION = 0.3
"""From where the others are heard of until the robot brakes [s]."""
GOES_ON = 0.5
"""A robot that drives away needs way to stop; so much of it counts as room."""
SLOWEST_APPROACH = 0.02
"""Speed below which a robot stands that may come no faster [m/s]."""
FRESH_NEWS = 0.35
"""Age above which news say nothing about room [s]."""
ROUNDING = 1e-6
"""No two ways to compute a distance differ by more [m]."""


def least_spacing(one: RobotModel, other: RobotModel) -> float:
    """Return how near two robots may be and still drive side by side [m], between middles."""
    return one.corner + other.corner + 2 * MARGIN


@dataclass(frozen=True, slots=True)
class _Room:
    """The room that is left towards a peer, whose pose is `at` in the robot's frame.

    Attributes:
        gap: Way that is left to the margin, less the way that the peer needs to stop [m].
        apart: Between the circles around both [m]; negative where they overlap.
    """

    peer: Peer
    at: Pose2
    gap: float
    apart: float

    @property
    def bearing(self) -> float:
        """Bearing of the peer, from straight ahead [rad]."""
        return atan2(self.at.y, self.at.x)


@dataclass(slots=True, kw_only=True)
class LimiterPeers(Action):
    """Limits speed and turns by the other robots of a group, also where no sensor sees them.

    Both of two robots that come nearer to each other brake, so that each leaves the other the
    room to stop. The speed along the line between them counts, now and after the turn that
    the robot is about to make: robots that pass each other at a distance hold nobody up. One
    that has been silent may be nearer than it was.
    """

    peers: Peers
    name: str = "limiter peers"

    def decide(self, situation: Situation) -> Desire | None:
        """Return the limits; `None` where nobody is near enough to matter."""
        peers = self.peers()
        if not any(_matters(situation, peer) for peer in peers):
            return None
        rooms = [_room(situation, peer) for peer in peers]
        ahead = [_speed(situation, room, 0.0) for room in rooms]
        behind = [_speed(situation, room, pi) for room in rooms]
        v_max, back_max = min(ahead, default=inf), min(behind, default=inf)
        touch = any(room.apart <= 0 for room in rooms)
        if min(v_max, back_max) >= situation.limits.max_speed and not touch:
            return None
        nearest = min(rooms, key=lambda room: room.apart)
        if v_max != back_max:  # the one that holds it need not be the nearest
            speeds = ahead if v_max < back_max else behind
            nearest = rooms[speeds.index(min(speeds))]
        turn = CREEP / situation.model.corner if touch else None
        return Desire(
            v_max=min(v_max, situation.limits.max_speed),
            back_max=min(back_max, situation.limits.max_speed),
            left_max=turn,
            right_max=turn,
            reason=f"{nearest.peer.name} is {max(0.0, nearest.apart):.2f} m away",
        )


def _matters(situation: Situation, peer: Peer) -> bool:
    """Return whether a peer may be near enough to limit anything, however it drives.

    Most are not, and the distance alone tells it.
    """
    here, limits, speed = situation.pose, situation.limits, abs(peer.twist.v)
    distance = hypot(peer.pose.x - here.x, peer.pose.y - here.y)
    apart = distance - situation.model.corner - peer.radius - _strays(situation.now, peer)
    gap = apart - MARGIN - speed * (LOST + REACTION) - speed * speed / (2 * limits.deceleration)
    needs = limits.max_speed * (REACTION + limits.max_speed / (2 * limits.deceleration))
    return gap < needs + ROUNDING


def _strays(now: float, peer: Peer) -> float:
    """Return how far a peer may have strayed since it was lost [m]."""
    silent = max(0.0, now - peer.stamp - LOST)
    return (abs(peer.twist.v) + STRAYS) * min(silent, STRAYS_FOR)


def _room(situation: Situation, peer: Peer) -> _Room:
    """Return the room towards a peer, at the nearer of where it was and where it may be."""
    now, here = situation.now, situation.pose.inverse()
    places = (here @ peer.pose, here @ peer.at(now))
    at = min(places, key=lambda pose: hypot(pose.x, pose.y))
    distance = hypot(at.x, at.y)
    apart = distance - situation.model.corner - peer.radius - _strays(now, peer)
    leaves = peer.twist.v * cos(at.theta - atan2(at.y, at.x))
    to_stop = leaves * leaves / (2 * situation.limits.deceleration)
    gap = apart - MARGIN
    if leaves < 0:
        gap += leaves * REACTION - to_stop
    elif now - peer.stamp < FRESH_NEWS:
        gap += GOES_ON * to_stop
    return _Room(peer, at, gap, apart)


def _speed(situation: Situation, room: _Room, way: float) -> float:
    """Return the speed that the room allows [m/s], ahead (`way` 0) or back (`way` pi)."""
    turn = situation.higher.motion.get("w")
    w = situation.twist.w if turn is None else turn.value
    if abs(w) < STRAIGHT and _beside(situation, room):
        return inf
    deceleration = situation.limits.deceleration
    stops_after = abs(situation.twist.v) / deceleration + REACTION
    bearing = wrap(room.bearing - way)
    turned = bearing - max(-pi, min(pi, w * stops_after))
    passes_it = min(bearing, turned) <= 0.0 <= max(bearing, turned)
    towards = 1.0 if passes_it else max(cos(bearing), cos(turned))
    if towards < PAST:
        return inf
    delay = deceleration * REACTION
    room_left = 2 * deceleration * max(0.0, room.gap)
    speed = sqrt(delay * delay + room_left) - delay
    return speed / towards if speed > SLOWEST_APPROACH else 0.0


def _beside(situation: Situation, room: _Room) -> bool:
    """Return whether the peer is so much to the side that driving straight on does not touch it."""
    peer, at = room.peer, room.at
    side = (abs(sin(at.theta)) * peer.length + abs(cos(at.theta)) * peer.width) / 2
    crosses = abs(peer.twist.v * sin(at.theta)) > STRAIGHT
    return not crosses and abs(at.y) > situation.model.width / 2 + side + BESIDE
