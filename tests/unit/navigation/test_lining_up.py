"""A robot that comes no nearer to its goal."""

from pioneer3.geometry import Pose2
from pioneer3.nav.follower import NO_OBSTACLES
from pioneer3.nav.planner import Way, plan
from pioneer3.navigation.follow_way import HELD_UP, LiningUp
from tests.unit.behaviors.support import seen
from tests.unit.nav.offices import costs, room

DT = 0.1


def reasons(speed: float, seconds: float) -> list[str]:
    """Return what a robot does that has been held up for long, and drives at `speed` [m/s]."""
    way = plan(costs(room()), (2.0, 3.0), (8.0, 3.0))
    assert isinstance(way, Way)
    lining_up, found = LiningUp(), []
    for tick in range(round(seconds / DT)):
        here = Pose2(2.0 + speed * tick * DT, 3.0)
        desire = lining_up.decide(seen(tick * DT), here, NO_OBSTACLES, way.cost_to_go, 60.0)
        found.append(desire.reason if desire else "")
    return found


def test_it_looks_for_a_manoeuvre_once_it_has_come_nowhere_for_a_while() -> None:
    found = reasons(0.0, HELD_UP + 1.0)
    assert not any(found[: round(HELD_UP / DT)])
    assert found[-1] == "lines up with a narrow place"


def test_a_robot_that_gets_on_needs_none_whatever_held_it_up_before() -> None:
    assert not any(reasons(0.3, HELD_UP + 1.0))
