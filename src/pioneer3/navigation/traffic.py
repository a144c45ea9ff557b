"""The robots of this program: each knows where the others are, and keeps out of their ways."""

from collections import defaultdict
from collections.abc import Callable, Hashable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from itertools import product
from math import floor, hypot, inf
from typing import TYPE_CHECKING, Protocol

from pioneer3.behaviors.peers import Peer
from pioneer3.geometry import Pose2
from pioneer3.runtime.driven import Driven
from pioneer3.state import Snapshot

if TYPE_CHECKING:
    from pioneer3.maps import LineMap
    from pioneer3.nav.traffic import Traveller

NEAR_ROBOTS = 4.5
"""Distance beyond which robots do not hold each other up [m]."""
OVERLAP = 0.15
"""No two robots are so near [m]."""
LOOK_UP_EVERY = 0.25
"""Time between two look-ups of the robots that are near [s]."""
SLACK = 1.0
"""Distance by which they may come nearer meanwhile [m]."""
GRID_SIDE = NEAR_ROBOTS + SLACK
"""Side of a cell of the grid in which they are looked up [m]."""


@dataclass(frozen=True, slots=True)
class SharedPlace:
    """The place of a robot's odometry in a frame that it shares with others.

    Attributes:
        frame: Identifies the frame, such as that of a map.
        odom_in_frame: Pose of odometry's origin [m, rad].
        true: Whether a simulator told it. Two robots of which such places overlap are not in one
            world, though their simulators are on one computer.
    """

    frame: Hashable
    odom_in_frame: Pose2
    true: bool = False


def frame_of(line_map: "LineMap") -> Hashable:
    """Return the identity of a map's frame."""
    return "map", id(line_map)


@dataclass(frozen=True, slots=True, eq=False)
class Participant:
    """A robot of this program; no two have the same name.

    `place` returns its place by its newest snapshot, or the reason that it is not known.
    """

    name: str
    robot: Driven
    place: Callable[[Snapshot], SharedPlace | str]


class Navigating(Protocol):
    """A robot that drives along ways of a map."""

    @property
    def robot(self) -> Driven:
        """The robot."""

    @property
    def line_map(self) -> "LineMap":
        """Its map."""

    @property
    def traveller(self) -> "Traveller | None":
        """Where it is and goes; `None` while it is not sure where it is."""


@dataclass(frozen=True, slots=True)
class _News:
    """Where a robot was last, and the robot as others know it in that frame."""

    place: SharedPlace
    peer: Peer


@dataclass(frozen=True, slots=True)
class _Near:
    """The robots that were near each one at `stamp` [s]."""

    names: dict[str, list[str]]
    stamp: float


@dataclass(slots=True)
class Traffic:
    """All robots that know of each other.

    A robot is known to the others while it is sure where it is, in a frame that they share. The
    last news of one that is lost stays: it stands there still, or has strayed.
    """

    _participants: dict[str, Participant] = field(default_factory=dict, init=False)
    _news: dict[str, _News] = field(default_factory=dict, init=False)
    _strangers: set[frozenset[str]] = field(default_factory=set, init=False)
    _near: _Near | None = field(default=None, init=False)
    _navigating: list[Navigating] = field(default_factory=list, init=False)

    @contextmanager
    def joined(self, participant: Participant) -> Iterator[None]:
        """Let `participant` know the others during the block, and keep it apart from them."""
        self._participants[participant.name] = participant
        participant.robot.arbiter.keep_apart(lambda: self.peers_of(participant.name, NEAR_ROBOTS))
        try:
            yield
        finally:
            participant.robot.arbiter.keep_apart(None)
            if self._participants.get(participant.name) is participant:
                self._note(participant)
                del self._participants[participant.name]

    def forget(self, name: str) -> None:
        """Forget a robot that is not there any more."""
        self._participants.pop(name, None)
        self._news.pop(name, None)

    def peers_of(self, name: str, within: float = inf) -> list[Peer]:
        """Return the others `within` [m] of a robot as it knows them, in its odometry's frame.

        While its own place is not known, it knows no others.
        """
        participant = self._participants.get(name)
        mine = self._note(participant) if participant else None
        if mine is None:
            return []
        around = self._around(mine, within)
        if not around:
            return []
        to_odom = mine.place.odom_in_frame.inverse()
        return [replace(news.peer, pose=to_odom @ news.peer.pose) for news in around]

    def unknown(self, name: str) -> str:
        """Return the reason that a robot does not know where it is among others, or nothing."""
        participant = self._participants.get(name)
        if participant is None:
            return "it is not connected"
        snapshot = participant.robot.snapshot
        if snapshot is None:
            return "it is not connected"
        place = participant.place(snapshot)
        return place if isinstance(place, str) else ""

    def share_frame(self, names: Sequence[str]) -> bool:
        """Return whether these robots know each other's places."""
        known = [
            self._note(self._participants[name]) for name in names if name in self._participants
        ]
        frames = {news.place.frame for news in known if news is not None}
        if len(frames) != 1 or len(known) != len(names) or None in known:
            return False
        others = {peer.name for peer in self.peers_of(names[0])}
        return others.issuperset(names[1:])

    def _around(self, mine: _News, within: float) -> list[_News]:
        """Return the news of the others that are near, also of those that are lost or have left."""
        names = self._looked_up(mine) if within <= NEAR_ROBOTS else self._names()
        return [news for other in names if (news := self._is_near(mine, other, within))]

    def _looked_up(self, mine: _News) -> list[str]:
        """Return the robots that may be near one.

        Among many robots, which of them are near is looked up again after :data:`LOOK_UP_EVERY`
        only, and for all of them at once.
        """
        name, known = mine.peer.name, self._near
        if (
            known is None
            or mine.peer.stamp - known.stamp >= LOOK_UP_EVERY
            or name not in known.names
        ):
            for participant in self._participants.values():
                self._note(participant)
            all_news = [self._news[other] for other in self._names() if other in self._news]
            known = self._near = _Near(
                _neighbours(all_news), max(news.peer.stamp for news in all_news)
            )
        return known.names[name]

    def _names(self) -> list[str]:
        return [*dict.fromkeys((*self._participants, *self._news))]

    def _is_near(self, mine: _News, name: str, within: float) -> _News | None:
        """Return the news of another robot if it is near."""
        if name == mine.peer.name:
            return None
        if name in self._participants:
            self._note(self._participants[name])
        news = self._news.get(name)
        if news is None or news.place.frame != mine.place.frame:
            return None
        away = _distance(mine, news)
        if away > within:
            return None
        pair = frozenset((mine.peer.name, name))
        if away < OVERLAP and mine.place.true and news.place.true:
            self._strangers.add(pair)
        return None if pair in self._strangers else news

    def _note(self, participant: Participant) -> _News | None:
        """Return the news of a robot that is there and sure of its place, and keep them."""
        snapshot = participant.robot.snapshot
        if snapshot is None:
            return None
        known = self._news.get(participant.name)
        if known is not None and known.peer.stamp == snapshot.stamp:
            return known
        place = participant.place(snapshot)
        if isinstance(place, str):
            return None  # others keep clear of where it was last
        pose = place.odom_in_frame @ snapshot.odometry.robot_in_odom
        model = participant.robot.info.model
        peer = Peer(
            name=participant.name,
            pose=pose,
            twist=snapshot.odometry.twist,
            stamp=snapshot.stamp,
            length=2 * max(model.length_front, model.length_rear),
            width=model.width,
        )
        news = self._news[participant.name] = _News(place, peer)
        return news

    @contextmanager
    def travelling(self, one: Navigating) -> Iterator[None]:
        """Let the others know the ways of a robot during the block."""
        self._navigating.append(one)
        try:
            yield
        finally:
            self._navigating.remove(one)

    def others(self, one: Navigating) -> "list[Traveller]":
        """Return the other robots on the same map, those of which it is known where they are."""
        travellers = {
            id(each.robot): other for each in self._navigating if (other := _beside(one, each))
        }
        stand = [
            standing
            for participant in self._participants.values()
            if participant.robot is not one.robot
            and id(participant.robot) not in travellers
            and (standing := self._standing(participant, one.line_map))
        ]
        return [*travellers.values(), *stand]

    def ahead_of(self, one: Navigating) -> "list[Traveller]":
        """Return the other robots that are on their way and go before `one`.

        The one that set out first does; of two that set out at once, the one that joined first.
        """
        mine = one.traveller
        if mine is None:
            return []
        number = self._navigating.index(one)
        return [
            other
            for at, each in enumerate(self._navigating)
            if (other := _beside(one, each))
            and len(other.way)
            and (other.since, at) < (mine.since, number)
        ]

    def _standing(self, participant: Participant, line_map: "LineMap") -> "Traveller | None":
        """Return a robot that does not navigate as a traveller without a way."""
        from pioneer3.nav.traffic import Traveller
        from pioneer3.navigation.ways import NOWHERE

        news = self._note(participant)
        if news is None or news.place.frame != frame_of(line_map):
            return None
        corner = participant.robot.info.model.corner
        here = news.peer.pose
        return Traveller(
            name=participant.name, robot_in_map=here, corner=corner, way=NOWHERE, since=inf
        )


def _neighbours(all_news: Sequence[_News]) -> dict[str, list[str]]:
    """Return for each robot those that are within :data:`GRID_SIDE`, in the order of `all_news`."""
    near: dict[str, list[str]] = {}
    cells = defaultdict[tuple[Hashable, int, int], list[_News]](list)
    for news in all_news:
        near[news.peer.name] = []
        cells[_cell(news)].append(news)
    for news in all_news:
        frame, i, j = _cell(news)
        for di, dj in product((-1, 0, 1), repeat=2):
            for other in cells.get((frame, i + di, j + dj), ()):
                if other is not news and _distance(news, other) <= GRID_SIDE:
                    near[other.peer.name].append(news.peer.name)
    return near


def _cell(news: _News) -> tuple[Hashable, int, int]:
    pose = news.peer.pose
    return news.place.frame, floor(pose.x / GRID_SIDE), floor(pose.y / GRID_SIDE)


def _distance(one: _News, other: _News) -> float:
    here, there = one.peer.pose, other.peer.pose
    return hypot(there.x - here.x, there.y - here.y)


def _beside(one: Navigating, each: Navigating) -> "Traveller | None":
    same = each is not one and each.line_map is one.line_map
    return each.traveller if same else None
