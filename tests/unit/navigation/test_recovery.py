"""A robot that is held up: by a narrow place, or by somebody who waits for it."""

from dataclasses import replace

import numpy as np
import pytest

from pioneer3.arrays import Float
from pioneer3.geometry import Pose2
from pioneer3.nav.mover import Mover
from pioneer3.nav.planner import CostToGo, Way, plan
from pioneer3.nav.sightings import STANDING_TIME, Sightings
from pioneer3.navigation.recovery import BLOCKED_TIME, HELD_UP_TIME, STAYING_TIME, Recovery
from tests.unit.behaviors.support import seen
from tests.unit.nav.offices import NO_OBSTACLES, costs, room

HERE = Pose2(5.0, 3.0, 0.0)
DT = 0.1
ASIDE = STANDING_TIME + HELD_UP_TIME
"""Time after which it has begun to go aside [s]."""


@pytest.fixture(scope="module")
def to_go() -> CostToGo:
    way = plan(costs(room()), (2.0, 3.0), (8.0, 3.0))
    assert isinstance(way, Way)
    return way.cost_to_go


@pytest.fixture
def recovery() -> Recovery:
    return Recovery(Sightings(costs(room())))


FENCE = np.array([(5.6, 1.0 + 0.1 * number, 0.0, 0.0, 0.0) for number in range(41)])
"""Things that leave no way round somebody who stands behind them."""


def meet(recovery: Recovery, x: float, now: float, *, ahead: float = -1.0) -> Mover:
    """Put somebody in front of the robot, who walked towards it, or away from it, and stands."""
    somebody = Mover(
        x, 3.0, 0.0, 0.0, now, (x + 2.0, 3.0, now), walks=True, stands=now, heading=(ahead, 0.0)
    )
    recovery.sightings.movers.things = [somebody]
    return somebody


def reasons(
    recovery: Recovery,
    to_go: CostToGo,
    begin: float,
    seconds: float,
    *,
    speed: float = 0.0,
    held_up: float | None = None,
    blocked: bool = True,
    obstacles: Float = NO_OBSTACLES,
) -> list[str]:
    """Return what a robot does that drives at a speed [m/s], or else stands at the same place.

    It is `held_up` since 0 s, if nothing else is told.
    """
    found = []
    for tick in range(round(seconds / DT)):
        here = Pose2(HERE.x + speed * tick * DT, HERE.y)
        now = seen(begin + tick * DT)
        since = now.now if held_up is None else held_up
        for thing in recovery.sightings.movers.things:
            thing.seen = now.now
        people = recovery.sightings.movers.discs(now.now)
        around = np.concatenate([obstacles, people])
        desire = recovery.decide(now, here, around, to_go, since, blocked=blocked)
        found.append(desire.reason if desire else "")
        if desire and desire.reason == "waits for somebody":
            assert (desire.v, desire.w) == (0.0, 0.0)
    return found


def test_a_robot_that_is_alone_goes_on(recovery: Recovery, to_go: CostToGo) -> None:
    assert not any(reasons(recovery, to_go, 0.0, 10.0, held_up=0.0))


def test_it_waits_for_somebody_then_goes_aside(recovery: Recovery, to_go: CostToGo) -> None:
    meet(recovery, 5.8, 0.0)
    found = reasons(recovery, to_go, 0.0, ASIDE, obstacles=FENCE)
    assert not any(found[: round(BLOCKED_TIME / DT)])
    waits = found[round(BLOCKED_TIME / DT) + 1 : round(STANDING_TIME / DT)]
    assert set(waits) == {"waits for somebody"}
    assert found[-1] == "goes aside for somebody"


def test_it_goes_round_somebody_where_there_is_room(recovery: Recovery, to_go: CostToGo) -> None:
    meet(recovery, 5.8, 0.0)
    assert reasons(recovery, to_go, 0.0, 3 * BLOCKED_TIME)[-1] == "goes round somebody"


def test_a_robot_that_may_not_turn_at_its_goal_leaves_it_for_a_while(
    recovery: Recovery, to_go: CostToGo
) -> None:
    """Somebody may stand behind it, whom nothing sees, and wait for it."""
    recovery.sightings.movers.met = 0.0
    arrives = replace(to_go, values=np.zeros_like(to_go.values))
    found = reasons(recovery, arrives, 0.0, ASIDE)
    assert "goes aside for somebody" not in found[: round(STANDING_TIME / DT)]
    assert found[-1] == "goes aside for somebody"


def test_who_walked_away_and_stands_wants_back_past_it(recovery: Recovery, to_go: CostToGo) -> None:
    meet(recovery, 5.8, 0.0, ahead=1.0)
    assert reasons(recovery, to_go, 0.0, ASIDE, obstacles=FENCE)[-1] == "goes aside for somebody"


def test_a_robot_that_cannot_go_aside_does_not_behave_as_if_it_had(
    recovery: Recovery, to_go: CostToGo
) -> None:
    meet(recovery, 5.8, 0.0)
    found = reasons(recovery, to_go, 0.0, STAYING_TIME, obstacles=FENCE)
    begins = found.index("goes aside for somebody")
    ends = found.index("waits for somebody", begins)
    assert "goes aside for somebody" not in found[ends : ends + round(STANDING_TIME / DT)]
    assert "lets somebody pass" not in found


@pytest.mark.parametrize(
    ("begun", "around", "does"),
    [
        (ASIDE, FENCE, "goes aside for somebody"),
        (3 * BLOCKED_TIME, NO_OBSTACLES, "goes round somebody"),
    ],
)
def test_it_goes_on_as_soon_as_nobody_waits_any_more(
    recovery: Recovery, to_go: CostToGo, begun: float, around: Float, does: str
) -> None:
    meet(recovery, 5.8, 0.0)
    assert reasons(recovery, to_go, 0.0, begun, obstacles=around)[-1] == does
    recovery.sightings.movers.forget()
    found = reasons(recovery, to_go, begun, 2 * BLOCKED_TIME, blocked=False)
    assert found[0]
    assert not found[-1]


@pytest.mark.parametrize(("speed", "blocked"), [(0.3, True), (0.0, False)])
def test_a_robot_that_gets_on_waits_for_nobody(
    recovery: Recovery, to_go: CostToGo, speed: float, blocked: bool
) -> None:
    meet(recovery, 5.8, 0.0)
    assert not any(reasons(recovery, to_go, 0.0, 2.0, speed=speed, blocked=blocked))


def test_who_stands_farther_away_is_let_be(recovery: Recovery, to_go: CostToGo) -> None:
    meet(recovery, 7.0, 0.0)
    assert not any(reasons(recovery, to_go, 0.0, 5.0, held_up=0.0))


def test_it_goes_on_when_they_have_gone(recovery: Recovery, to_go: CostToGo) -> None:
    meet(recovery, 5.8, 0.0)
    assert reasons(recovery, to_go, 0.0, 2.0, obstacles=FENCE)[-1] == "waits for somebody"
    recovery.sightings.movers.forget()
    assert not reasons(recovery, to_go, 2.0, 0.5)[-1]


def test_who_does_not_pass_is_let_be(recovery: Recovery, to_go: CostToGo) -> None:
    """A thing may look like the legs of somebody."""
    thing = meet(recovery, 5.8, 0.0)
    found = reasons(recovery, to_go, 0.0, STAYING_TIME + HELD_UP_TIME, obstacles=FENCE)
    assert "goes aside for somebody" in found
    assert not found[-1]
    thing.x, thing.stands = 4.2, 2 * STAYING_TIME  # somebody else comes
    assert reasons(recovery, to_go, 2 * STAYING_TIME, 2 * BLOCKED_TIME)[-1]


def test_it_waits_on_where_no_place_is_beside_their_way(
    recovery: Recovery, to_go: CostToGo
) -> None:
    meet(recovery, 5.8, 0.0)
    angles = np.linspace(0.0, 2 * np.pi, 40)
    ring = np.stack([5.0 + 0.48 * np.cos(angles), 3.0 + 0.48 * np.sin(angles)], axis=1)
    around = np.pad(ring, ((0, 0), (0, 3)))
    found = reasons(recovery, to_go, 0.0, STANDING_TIME + 3.0, obstacles=around)
    assert set(found[round(2 * BLOCKED_TIME / DT) :]) == {"waits for somebody"}


def test_it_looks_for_a_manoeuvre_once_it_has_come_nowhere_for_a_while(
    recovery: Recovery, to_go: CostToGo
) -> None:
    found = reasons(recovery, to_go, 0.0, HELD_UP_TIME + 1.0, held_up=60.0)
    assert not any(found[: round(HELD_UP_TIME / DT)])
    assert found[-1] == "lines up with a narrow place"
    others = Recovery(recovery.sightings)
    assert not any(reasons(others, to_go, 0.0, HELD_UP_TIME + 1.0, held_up=60.0, speed=0.3))


def test_it_gives_up_a_manoeuvre_that_something_keeps_it_from(
    recovery: Recovery, to_go: CostToGo
) -> None:
    found = reasons(recovery, to_go, 0.0, 3 * HELD_UP_TIME, held_up=60.0)
    begins = round(HELD_UP_TIME / DT) + 3
    assert "" in found[begins : begins + round(HELD_UP_TIME / DT) + 1]
