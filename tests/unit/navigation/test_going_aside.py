"""A robot that somebody waits for."""

import numpy as np
import pytest

from pioneer3.geometry import Pose2
from pioneer3.nav.follower import NO_OBSTACLES
from pioneer3.nav.mover import Mover
from pioneer3.nav.sightings import Sightings
from pioneer3.navigation.going_aside import (
    AT_GOAL,
    GONE,
    LETS,
    LONGEST,
    PATIENT,
    STUCK,
    GoingAside,
)
from tests.unit.behaviors.support import seen
from tests.unit.nav.offices import costs, room

HERE = Pose2(5.0, 3.0, 0.0)
DT = 0.1


@pytest.fixture
def aside() -> GoingAside:
    return GoingAside(Sightings(costs(room())))


def meet(aside: GoingAside, x: float, now: float) -> Mover:
    """Put somebody in front of the robot, who walked towards it and stands."""
    somebody = Mover(
        x, 3.0, 0.0, 0.0, now, (x + 2.0, 3.0), walks=True, stands=now, heading=(-1.0, 0.0)
    )
    aside.sightings.movers.things = [somebody]
    return somebody


def reasons(aside: GoingAside, begin: float, seconds: float) -> list[str]:
    """Return what a robot does that stands at the same place."""
    found = []
    for tick in range(round(seconds / DT)):
        desire = aside.decide(seen(begin + tick * DT), HERE, NO_OBSTACLES)
        found.append(desire.reason if desire else "")
    return found


def test_a_robot_that_is_alone_goes_on(aside: GoingAside) -> None:
    assert not any(reasons(aside, 0.0, 10.0))


def test_it_goes_aside_for_somebody_who_waits_once_it_is_stuck(aside: GoingAside) -> None:
    meet(aside, 5.8, 0.0)
    found = reasons(aside, 0.0, STUCK + 1.0)
    assert not any(found[: round(STUCK / DT)])
    assert found[-1] == "goes aside for somebody"


def test_a_robot_that_turns_is_not_stuck(aside: GoingAside) -> None:
    meet(aside, 5.8, 0.0)
    for tick in range(40):
        here = Pose2(5.0, 3.0, tick * 0.04)
        assert aside.decide(seen(tick * DT), here, NO_OBSTACLES) is None


def test_a_robot_that_gets_on_waits_for_nobody(aside: GoingAside) -> None:
    meet(aside, 5.8, 0.0)
    for tick in range(40):
        assert aside.decide(seen(tick * DT), HERE, NO_OBSTACLES, blocked=False) is None


def test_who_stands_farther_away_is_let_be(aside: GoingAside) -> None:
    meet(aside, 7.0, 0.0)
    assert not any(reasons(aside, 0.0, 5.0))


def test_it_goes_on_when_they_have_gone(aside: GoingAside) -> None:
    meet(aside, 5.8, 0.0)
    assert reasons(aside, 0.0, 2.0)[-1]
    aside.sightings.movers.forget()
    assert not reasons(aside, 2.0, GONE + 0.5)[-1]


def test_who_does_not_pass_is_let_be(aside: GoingAside) -> None:
    """A thing may look like the legs of somebody."""
    thing = meet(aside, 5.8, 0.0)
    found = reasons(aside, 0.0, STUCK + LETS + 3.0)
    assert "goes aside for somebody" in found
    assert not found[-1]
    thing.x, thing.stands = 4.2, 20.0  # somebody else comes
    assert reasons(aside, 20.0, STUCK + 1.0)[-1]


def test_the_time_it_spends_aside_is_forgiven_but_not_for_ever(aside: GoingAside) -> None:
    meet(aside, 5.8, 0.0)
    reasons(aside, 0.0, 5.0)
    assert aside.forgiven == pytest.approx(DT)
    reasons(aside, 5.0, LONGEST)
    assert aside.forgiven == 0.0


def test_at_its_goal_it_waits_rather_than_goes_aside(aside: GoingAside) -> None:
    meet(aside, 5.8, 0.0)
    found = [
        aside.decide(seen(tick * DT), HERE, NO_OBSTACLES, AT_GOAL / 2)
        for tick in range(round(PATIENT / DT))
    ]
    told = [desire.reason if desire else "" for desire in found]
    waits = told[round(STUCK / DT) + 1 : round(PATIENT / DT)]
    assert set(waits) == {"waits for somebody"}
    assert all(desire is None or (desire.v, desire.w) == (0.0, 0.0) for desire in found)


def test_it_waits_for_who_has_just_come_where_no_place_is_beside_their_way(
    aside: GoingAside,
) -> None:
    meet(aside, 5.8, 0.0)
    angles = np.linspace(0.0, 2 * np.pi, 40)
    ring = np.stack([5.0 + 0.48 * np.cos(angles), 3.0 + 0.48 * np.sin(angles)], axis=1)
    around = np.pad(ring, ((0, 0), (0, 3)))
    desire = None
    for tick in range(round(3.0 / DT)):
        desire = aside.decide(seen(tick * DT), HERE, around)
    assert desire is not None
    assert (desire.v, desire.w, desire.reason) == (0.0, 0.0, "waits for somebody")
    assert aside.forgiven == pytest.approx(DT)


def test_who_comes_where_somebody_was_let_be_may_wait(aside: GoingAside) -> None:
    meet(aside, 5.8, 0.0)
    assert not reasons(aside, 0.0, STUCK + LETS + 3.0)[-1]
    aside.sightings.movers.things = []
    assert not any(reasons(aside, 20.0, 0.5))
    meet(aside, 5.8, 21.0)
    assert reasons(aside, 21.0, STUCK + 1.0)[-1]
