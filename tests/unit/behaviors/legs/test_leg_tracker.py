"""Whom the robot follows by the legs, and what it does when the laser falls silent."""

from dataclasses import replace
from math import radians

import pytest

from pioneer3.behaviors.action import Desire, Situation
from pioneer3.behaviors.actions.follow import FollowTracking
from pioneer3.behaviors.modes.follow import RULES, follow
from pioneer3.behaviors.trackers import (
    STANDS_STILL,
    LaserOrSonarTracker,
    LegTracker,
    PersonTracker,
)
from pioneer3.geometry import Pose2
from tests.unit.behaviors.legs.scans import LEG, Room
from tests.unit.behaviors.support import P3AT, seen, value
from tests.unit.behaviors.tracking.scene import Scene

FRONT = P3AT.length_front + 0.25


def by_legs(tracker: PersonTracker | None = None) -> FollowTracking:
    return FollowTracking(tracker=tracker or LegTracker())


def decided(room: Room, action: FollowTracking, seconds: float = 1.0) -> Desire:
    desire = None
    for _ in range(round(seconds * 10)):
        desire = action.decide(room.report())
    assert desire is not None
    return desire


def place(action: FollowTracking) -> tuple[float, float]:
    assert action.goal is not None
    return action.goal.x, action.goal.y


def test_it_goes_to_who_stands_in_front() -> None:
    desire = decided(Room(people=[Pose2(FRONT + 0.6)]), by_legs())
    # (0.6 - 0.3) / 0.8 s
    assert value(desire, "v") == pytest.approx(0.375, abs=0.05)
    assert value(desire, "w") == pytest.approx(0.0, abs=0.02)
    assert desire.reason == "follows at 0.60 m"


@pytest.mark.parametrize("side", [1, -1])
def test_it_turns_to_the_side_where_they_are(side: int) -> None:
    person = Pose2(theta=radians(30 * side)) @ Pose2(1.0)
    w = value(decided(Room(people=[person]), by_legs()), "w")
    assert w == pytest.approx(side * 2.0 * radians(30 - 4), abs=0.1)


@pytest.mark.parametrize("person", [Pose2(2.2), Pose2(0.5, 1.0), Pose2(-1.0)])
def test_who_is_far_away_or_beside_is_nobody(person: Pose2) -> None:
    action = by_legs()
    assert decided(Room(people=[person]), action).reason == "looks for somebody"
    assert action.goal is None


def test_a_person_comes_before_a_post_that_is_nearer() -> None:
    action = by_legs()
    decided(Room(people=[Pose2(1.2, 0.2)], posts=[(1.0, -0.3, LEG)]), action)
    assert place(action) == pytest.approx((1.2, 0.2), abs=0.05)


def test_what_has_never_walked_is_left_for_who_does() -> None:
    action, room = by_legs(), Room(people=[Pose2(1.0, -0.3), Pose2(1.7, 0.3)])
    decided(room, action)
    assert place(action)[1] < 0
    for tick in range(26):
        room.people[1] = Pose2(1.7 - 0.04 * tick, 0.3)
        decided(room, action, 0.1)
    assert place(action)[1] > 0


def test_what_has_never_walked_is_furniture_in_the_end() -> None:
    action, room = by_legs(), Room(people=[Pose2(1.1)])
    assert decided(room, action, STANDS_STILL - 1).reason.startswith("follows")
    decided(room, action, 2.0)
    for _ in range(50):
        assert decided(room, action, 0.1).reason == "looks for somebody"


def test_without_scans_it_stands_and_says_so() -> None:
    desire = by_legs().decide(seen(1.0))
    assert desire is not None
    assert (value(desire, "v"), value(desire, "w")) == (0.0, 0.0)
    assert desire.reason == "looks for somebody, no scans come from a laser"


def test_when_the_laser_falls_silent_it_goes_on_by_sonar() -> None:
    action = by_legs(LaserOrSonarTracker())
    room, ears = Room(people=[Pose2(FRONT + 0.5)]), Scene(people=[(FRONT + 0.5, 0.0)])

    def both(*, laser: bool) -> Desire:
        heard, looked = ears.report(), room.report()
        there = replace(heard, scan=looked.scan if laser else None)
        desire = action.decide(there)
        assert desire is not None
        return desire

    for _ in range(10):
        assert "sonar" not in both(laser=True).reason
    for _ in range(20):
        silent = both(laser=False)
        assert silent.reason.startswith("follows at 0.")
        assert silent.reason.endswith(", by sonar, the laser is silent")
    for _ in range(10):
        back = both(laser=True)
    assert back.reason == "follows at 0.50 m"


def test_a_robot_that_has_no_laser_is_as_before() -> None:
    """By default, it follows by sonar and does not complain."""
    one, other = by_legs(LaserOrSonarTracker()), FollowTracking()
    scene = Scene(people=[(FRONT + 0.6, 0.0)])
    for _ in range(20):
        situation: Situation = scene.report()
        assert one.decide(situation) == other.decide(situation)


@pytest.mark.parametrize("rule", RULES.names)
def test_only_rules_that_look_at_scans_ask_for_them(rule: str) -> None:
    assert follow(rule).wants_scans == (rule in {"auto", "legs"})  # type: ignore[arg-type]
