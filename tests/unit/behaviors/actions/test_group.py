"""Robots in a group."""

from collections.abc import Callable, Sequence
from dataclasses import astuple, dataclass, field
from itertools import combinations, pairwise
from math import cos, hypot, pi, sin

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pioneer3.behaviors.action import Action, Desire
from pioneer3.behaviors.actions.group import (
    SETTLED,
    FollowLeader,
    KeepFormation,
    SpreadOut,
)
from pioneer3.behaviors.actions.keep_apart import LimiterPeers
from pioneer3.behaviors.formations import FORMATIONS, assigned
from pioneer3.behaviors.peers import LOST, Peer
from pioneer3.geometry import ORIGIN, STILL, Pose2, Twist2, arc, wrap
from tests.unit.behaviors.support import LIMITS, P3AT, above, seen

DT = 0.1
LATE = 1
"""Poses of others are so many steps old."""


@dataclass
class Mate:
    """A robot of a group that does as its action wants, as fast as it can."""

    name: str
    pose: Pose2
    action: Action | None = None
    limiter: LimiterPeers | None = None
    twist: Twist2 = STILL
    past: list[Peer] = field(default_factory=list)
    wanted: Desire | None = None

    def step(self, now: float, commanded: Twist2 | None = None) -> None:
        situation = seen(now, pose=self.pose, twist=self.twist)
        v, w = (commanded.v, commanded.w) if commanded else (0.0, 0.0)
        if self.action is not None:
            self.wanted = self.action.decide(situation)
            assert self.wanted is not None
            assert isinstance(self.wanted.v, float)
            assert isinstance(self.wanted.w, float)
            v, w = self.wanted.v, self.wanted.w
        if self.limiter and (limits := self.limiter.decide(situation)):
            assert isinstance(limits.v_max, float)
            assert isinstance(limits.back_max, float)
            v = max(-limits.back_max, min(v, limits.v_max))
        self.twist = Twist2(
            towards(self.twist.v, v, LIMITS.acceleration, LIMITS.deceleration),
            towards(self.twist.w, w, LIMITS.turn_acceleration, LIMITS.turn_deceleration),
        )
        self.pose = self.pose @ arc(self.twist.v, self.twist.w, DT)


def towards(now: float, wanted: float, faster: float, slower: float) -> float:
    step = (faster if abs(wanted) > abs(now) and wanted * now >= 0 else slower) * DT
    return max(now - step, min(now + step, wanted))


class Group:
    """Robots that tell each other where they are."""

    def __init__(self) -> None:
        self.mates: list[Mate] = []
        self.now = 0.0
        self.silent: set[str] = set()

    def peers_of(self, name: str) -> Callable[[], Sequence[Peer]]:
        def peers() -> Sequence[Peer]:
            return [
                mate.past[max(0, len(mate.past) - 1 - LATE)]
                for mate in self.mates
                if mate.name != name and mate.past
            ]

        return peers

    def step(self, **commanded: Twist2) -> None:
        for mate in self.mates:
            if mate.name not in self.silent:
                told = Peer(
                    name=mate.name,
                    pose=mate.pose,
                    twist=mate.twist,
                    stamp=self.now,
                    length=P3AT.length,
                    width=P3AT.width,
                )
                mate.past.append(told)
        for mate in self.mates:
            mate.step(self.now, commanded.get(mate.name))
        self.now += DT

    def run(self, seconds: float, **commanded: Twist2) -> None:
        for _ in range(round(seconds / DT)):
            self.step(**commanded)


def formation(name: str, followers: int = 4, spacing: float = 1.2) -> Group:
    """Return a leader and its followers, all near to their places."""
    group = Group()
    group.mates.append(Mate("leader", ORIGIN))
    for number, place in enumerate(FORMATIONS[name].places(followers, spacing), 1):
        mate = f"mate {number}"
        keep = KeepFormation(leader="leader", place=place, peers=group.peers_of(mate))
        x, y = place
        group.mates.append(Mate(mate, Pose2(x - 0.2, y + 0.15, 0.2), keep))
    return group


def off_place(group: Group, mate: Mate) -> float:
    leader = group.mates[0].pose
    assert isinstance(mate.action, KeepFormation)
    there = leader @ Pose2(*mate.action.place)
    return hypot(there.x - mate.pose.x, there.y - mate.pose.y)


def test_formations_are_as_people_draw_them() -> None:
    assert FORMATIONS["line"].places(4, 1.0) == [(0, 1), (0, -1), (0, 2), (0, -2)]
    assert FORMATIONS["wedge"].places(4, 2.0) == [(-2, 2), (-2, -2), (-4, 4), (-4, -4)]
    assert FORMATIONS["column"].places(2, 0.8) == [(-0.8, 0), (-1.6, 0)]


@given(st.permutations(range(5)))
def test_each_robot_takes_the_place_that_is_near(order: list[int]) -> None:
    places = FORMATIONS["wedge"].places(5, 1.5)
    robots = [(places[n][0] + 0.3, places[n][1] - 0.4) for n in order]
    assert assigned(robots, places) == list(order)


def test_of_many_robots_the_nearest_pairs_are_matched_first() -> None:
    places = FORMATIONS["column"].places(20, 1.0)
    robots = [(x + 0.2, y) for x, y in reversed(places)]
    assert assigned(robots, places) == [*reversed(range(20))]


@pytest.mark.parametrize("name", ["line", "wedge"])
@pytest.mark.parametrize("turn_rate", [0.0, 0.08, -0.08])
def test_followers_keep_their_places_beside_a_leader(name: str, turn_rate: float) -> None:
    group = formation(name)
    group.run(15.0, leader=Twist2(0.3, turn_rate))
    worst = 0.0
    for _ in range(200):
        group.step(leader=Twist2(0.3, turn_rate))
        worst = max(worst, *(off_place(group, mate) for mate in group.mates[1:]))
    assert worst < 0.12


def test_behind_a_leader_that_stops_they_come_to_their_places_and_look_as_it_does() -> None:
    group = formation("wedge")
    group.run(10.0, leader=Twist2(0.3, 0.1))
    group.run(25.0, leader=Twist2())
    leader = group.mates[0].pose
    for mate in group.mates[1:]:
        assert off_place(group, mate) < 0.1
        assert abs(wrap(mate.pose.theta - leader.theta)) < 0.12
        assert mate.twist.is_zero or abs(mate.twist.v) < 0.01


def test_a_column_follows_the_track_of_its_leader_around_a_corner() -> None:
    group = Group()
    group.mates.append(Mate("leader", ORIGIN))
    for number in (1, 2, 3):
        name = f"mate {number}"
        follow = FollowLeader(leader="leader", distance=number * 1.0, peers=group.peers_of(name))
        group.mates.append(Mate(name, Pose2(-number * 1.0), follow))
    track, off, gaps = [], [], []
    commands = [Twist2(0.3, 0.0)] * 150 + [Twist2(0.2, 0.4)] * 39 + [Twist2(0.3, 0.0)] * 250
    for number, command in enumerate(commands):
        group.step(leader=command)
        track.append(group.mates[0].pose)
        if number > 100:
            for mate in group.mates[1:]:
                near = min(hypot(p.x - mate.pose.x, p.y - mate.pose.y) for p in track)
                off.append(near)
        if number > 350:
            gaps += [
                hypot(a.pose.x - b.pose.x, a.pose.y - b.pose.y) for a, b in pairwise(group.mates)
            ]
    assert max(off) < 0.25  # it cuts no corner
    assert 0.8 < min(gaps) <= max(gaps) < 1.2


def test_a_heap_of_robots_spreads_out_and_is_done() -> None:
    group = Group()
    for number, (x, y) in enumerate([(0.0, 0.0), (0.9, 0.1), (0.1, 1.0), (-0.9, 0.2), (0.2, -1.0)]):
        name = f"mate {number}"
        spread = SpreadOut(apart=2.0, peers=group.peers_of(name))
        group.mates.append(Mate(name, Pose2(x, y, number * 1.1), spread))
    group.run(60.0)
    for one, other in combinations(group.mates, 2):
        apart = hypot(one.pose.x - other.pose.x, one.pose.y - other.pose.y)
        assert apart >= 2.0 - 2 * SETTLED
    assert all(mate.action.done for mate in group.mates if isinstance(mate.action, SpreadOut))


def test_without_word_of_the_leader_nobody_moves() -> None:
    group = formation("line")
    group.run(5.0, leader=Twist2(0.3, 0.0))
    assert group.mates[1].twist.v > 0.2
    group.silent.add("leader")
    group.run(LOST + LATE * DT + 1.5, leader=Twist2(0.3, 0.0))
    assert all(mate.twist.is_zero for mate in group.mates[1:])
    assert group.mates[1].wanted is not None
    assert group.mates[1].wanted.reason == "it is not known where leader is"


@given(
    bearing=st.floats(-pi, pi),
    heading=st.floats(-pi, pi),
    distance=st.floats(1.6, 5.0),
    speeds=st.tuples(st.floats(-0.75, 0.75), st.floats(-0.75, 0.75)),
)
def test_robots_that_know_of_each_other_do_not_touch(
    bearing: float, heading: float, distance: float, speeds: tuple[float, float]
) -> None:
    group = Group()
    there = Pose2(distance * cos(bearing), distance * sin(bearing), heading)
    for name, pose in (("ann", ORIGIN), ("bob", there)):
        limiter = LimiterPeers(peers=group.peers_of(name))
        group.mates.append(Mate(name, pose, limiter=limiter))
    ann, bob = group.mates
    for _ in range(150):
        group.step(ann=Twist2(speeds[0], 0.0), bob=Twist2(speeds[1], 0.0))
        apart = hypot(ann.pose.x - bob.pose.x, ann.pose.y - bob.pose.y)
        assert apart > 2 * P3AT.width / 2  # their sides


def test_head_on_they_stop_with_room_between_them() -> None:
    group = Group()
    for name, pose in (("ann", ORIGIN), ("bob", Pose2(5.0, 0.1, pi))):
        group.mates.append(Mate(name, pose, limiter=LimiterPeers(peers=group.peers_of(name))))
    group.run(15.0, ann=Twist2(0.75, 0.0), bob=Twist2(0.75, 0.0))
    ann, bob = group.mates
    gap = bob.pose.x - ann.pose.x - P3AT.length
    assert ann.twist.is_zero
    assert bob.twist.is_zero
    assert 0.25 < gap < 1.0


def test_a_robot_that_is_silent_may_be_nearer_than_it_was() -> None:
    peer = Peer(name="bob", pose=Pose2(2.0), twist=Twist2(0.5), stamp=0.0)
    limiter = LimiterPeers(peers=lambda: [peer])
    assert limiter.decide(seen(0.2)) is None
    silent = limiter.decide(seen(3.0))
    assert silent is not None
    assert silent.v_max == 0.0
    assert silent.back_max == LIMITS.max_speed


def test_a_robot_that_turns_is_expected_on_its_circle_and_no_longer_than_it_is_known() -> None:
    peer = Peer(name="bob", pose=Pose2(0.0, 0.0, pi / 2), twist=Twist2(0.5, 1.0), stamp=0.0)
    for now in (0.3, 1.0, 5.0):
        turned = min(now, LOST)
        there = Pose2(0.5 * cos(turned) - 0.5, 0.5 * sin(turned), pi / 2 + turned)
        assert astuple(peer.at(now)) == pytest.approx(astuple(there))


def test_robots_in_a_row_drive_straight_on_side_by_side_and_turn_slowly() -> None:
    peer = Peer(name="bob", pose=Pose2(0.1, 0.65), stamp=0.0)
    limits = LimiterPeers(peers=lambda: [peer]).decide(seen(0.1))
    assert limits is not None
    assert limits.v_max == limits.back_max == LIMITS.max_speed
    assert limits.left_max == limits.right_max == pytest.approx(0.035 / P3AT.corner)
    turning = above(Desire(v=0.3, w=0.5))
    towards_it = LimiterPeers(peers=lambda: [peer]).decide(seen(0.1, higher=turning))
    assert towards_it is not None
    assert towards_it.v_max == 0.0


def test_who_drives_ahead_leaves_room_by_the_way_that_it_needs_to_stop() -> None:
    def allowed(speed: float, stamp: float = 0.0) -> float:
        peer = Peer(name="bob", pose=Pose2(1.05), twist=Twist2(speed), stamp=stamp)
        limits = LimiterPeers(peers=lambda: [peer]).decide(seen(0.1))
        assert limits is not None
        assert isinstance(limits.v_max, float)
        return limits.v_max

    assert allowed(0.5) > allowed(0.0) > allowed(-0.5)
    assert allowed(0.5, stamp=-0.6) == allowed(0.0)  # old news


def test_who_is_beside_limits_nothing() -> None:
    peer = Peer(name="bob", pose=Pose2(0.5, 1.5), stamp=0.0)
    assert LimiterPeers(peers=lambda: [peer]).decide(seen(0.1)) is None
    assert LimiterPeers(peers=list).decide(seen(0.1)) is None
