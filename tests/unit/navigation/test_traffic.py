"""What robots of one program know of each other."""

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field, replace
from math import pi
from typing import Any, cast

import pytest

from pioneer3.behaviors.peers import Peers
from pioneer3.geometry import ORIGIN, Pose2, Twist2
from pioneer3.navigation.traffic import (
    LOOK_UP_EVERY,
    NEAR_ROBOTS,
    SLACK,
    Participant,
    SharedPlace,
    Traffic,
)
from pioneer3.runtime.driven import Driven
from pioneer3.state import Snapshot
from tests.unit.behaviors.support import P3AT, seen


@dataclass
class Info:
    model: Any = P3AT


@dataclass
class Fake:
    """A robot that stands for a driven one: its snapshot and its place.

    Attributes:
        place: As its participant tells it.
        snapshot: The newest.
        peers: Given to the arbiter.
    """

    place: SharedPlace | str
    snapshot: Snapshot | None = field(default_factory=lambda: seen(1.0).snapshot)
    info: Info = field(default_factory=Info)
    peers: Peers | None = None

    @property
    def arbiter(self) -> "Fake":
        return self

    def keep_apart(self, peers: Peers | None) -> None:
        self.peers = peers

    def drives(self, pose: Pose2, stamp: float) -> None:
        self.snapshot = seen(stamp, pose=pose, twist=Twist2(0.3, 0.0)).snapshot


@contextmanager
def traffic(**robots: Fake) -> Iterator[Traffic]:
    made = Traffic()
    with ExitStack() as stack:
        for name, fake in robots.items():
            stack.enter_context(made.joined(participant(name, fake)))
        yield made


def participant(name: str, fake: Fake) -> Participant:
    return Participant(name, cast("Driven", fake), lambda snapshot: fake.place)


def at(x: float, y: float = 0.0, theta: float = 0.0, frame: str = "hall", **more: Any) -> Fake:
    return Fake(SharedPlace(frame, Pose2(x, y, theta), **more))


def test_each_knows_the_others_in_its_own_odometry() -> None:
    ann, bob = at(1.0, 2.0, pi / 2), at(1.0, 5.0)
    with traffic(ann=ann, bob=bob) as the:
        bob.drives(Pose2(0.5), 2.0)
        (peer,) = the.peers_of("ann")
        assert (peer.name, peer.stamp, peer.twist) == ("bob", 2.0, Twist2(0.3, 0.0))
        assert [peer.pose.x, peer.pose.y] == pytest.approx([3.0, -0.5])
        assert peer.pose.theta == pytest.approx(-pi / 2)
        assert peer.radius == pytest.approx(P3AT.corner)


def test_robots_of_other_frames_and_those_far_away_are_none() -> None:
    with traffic(ann=at(0.0), bob=at(1.0, frame="yard"), carol=at(NEAR_ROBOTS + 1.0)) as the:
        assert [peer.name for peer in the.peers_of("ann")] == ["carol"]
        assert the.peers_of("ann", NEAR_ROBOTS) == []
        assert not the.share_frame(["ann", "bob"])
        assert the.share_frame(["ann", "carol"])


def test_one_that_comes_near_is_noticed_soon() -> None:
    ann, bob = at(0.0), at(NEAR_ROBOTS + 3.0)
    with traffic(ann=ann, bob=bob) as the:
        assert the.peers_of("ann", NEAR_ROBOTS) == []
        bob.drives(Pose2(-5.0), 1.5)
        ann.drives(ORIGIN, 1.5)
        assert [peer.name for peer in the.peers_of("ann", NEAR_ROBOTS)] == ["bob"]


def test_one_that_comes_near_between_two_looks_is_noticed_at_once() -> None:
    ann, bob = at(0.0), at(NEAR_ROBOTS + SLACK - 0.1)
    with traffic(ann=ann, bob=bob) as the:
        assert the.peers_of("ann", NEAR_ROBOTS) == []
        bob.drives(Pose2(-SLACK), 1.0 + LOOK_UP_EVERY / 2)
        ann.drives(ORIGIN, 1.0 + LOOK_UP_EVERY / 2)
        assert [peer.name for peer in the.peers_of("ann", NEAR_ROBOTS)] == ["bob"]


def test_who_does_not_know_its_own_place_knows_nobody() -> None:
    with traffic(ann=Fake("it is not sure"), bob=at(1.0)) as the:
        assert the.peers_of("ann") == []
        assert the.peers_of("bob") == []
        assert (the.unknown("ann"), the.unknown("bob")) == ("it is not sure", "")


def test_the_last_news_of_one_that_is_lost_stay_with_their_age() -> None:
    ann, bob = at(0.0), at(2.0)
    with traffic(ann=ann, bob=bob) as the:
        the.peers_of("ann")
        bob.snapshot = None
        ann.drives(ORIGIN, 9.0)
        (peer,) = the.peers_of("ann")
        assert peer.is_lost(9.0)
        assert the.unknown("bob") == "it is not connected"
        bob.snapshot, bob.place = seen(9.5).snapshot, "it may have moved"
        assert the.peers_of("ann") == [peer]


def test_one_that_leaves_stands_there_still_until_it_is_forgotten() -> None:
    ann, bob = at(0.0), at(2.0)
    with traffic(ann=ann) as the:
        with the.joined(participant("bob", bob)):
            assert bob.peers is not None
            assert [peer.name for peer in bob.peers()] == ["ann"]
        assert bob.peers is None
        ann.drives(ORIGIN, 2.0)
        assert [peer.name for peer in the.peers_of("ann")] == ["bob"]
        the.forget("bob")
        assert the.peers_of("ann") == []


def test_simulated_robots_that_overlap_are_not_in_one_world() -> None:
    ann, bob = at(0.0, true=True), at(0.05, true=True)
    with traffic(ann=ann, bob=bob) as the:
        assert the.peers_of("ann") == []
        bob.drives(Pose2(2.0), 3.0)
        ann.drives(ORIGIN, 3.0)
        assert the.peers_of("ann") == []  # for ever
        assert not the.share_frame(["ann", "bob"])


def test_robots_on_a_map_that_seem_to_overlap_are_still_kept_apart() -> None:
    with traffic(ann=at(0.0), bob=at(0.05)) as the:
        assert [peer.name for peer in the.peers_of("ann")] == ["bob"]


def test_a_new_snapshot_takes_the_place_anew() -> None:
    ann, bob = at(0.0), at(2.0)
    with traffic(ann=ann, bob=bob) as the:
        the.peers_of("ann")
        bob.place = SharedPlace("hall", Pose2(3.0))
        assert bob.snapshot is not None
        bob.snapshot = replace(bob.snapshot, stamp=1.1)
        (peer,) = the.peers_of("ann")
        assert peer.pose.x == pytest.approx(3.0)
