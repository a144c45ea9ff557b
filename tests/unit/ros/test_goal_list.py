"""The rules of actionlib's protocol."""

import pytest

from pioneer3.ros.messages.goals import GoalState, SentGoal
from pioneer3.ros.node.goal_list import LISTED, MOST, GoalList
from tests.unit.ros.fakes import Moment

EARLY, LATE, NEVER = Moment(10.0), Moment(20.0), Moment(0.0)


def active(goals: GoalList, id_: str, stamp: Moment = EARLY) -> SentGoal:
    goal = goals.take(id_, stamp, 0.0)
    assert goal is not None
    goal.state = GoalState.ACTIVE
    return goal


def test_a_goal_that_comes_twice_counts_once() -> None:
    goals = GoalList()
    first = active(goals, "a")
    assert goals.take("a", LATE, 1.0) is None
    assert goals.listed(1.0) == [first]


@pytest.mark.parametrize(
    ("id_", "stamp", "ended"),
    [
        ("", NEVER, {"a", "b"}),
        ("a", NEVER, {"a"}),
        ("", Moment(15.0), {"a"}),
        ("b", Moment(15.0), {"a", "b"}),
        ("", Moment(20.0), {"a", "b"}),
        ("c", NEVER, set()),
    ],
)
def test_a_cancel_means_an_id_or_all_up_to_a_time_or_all(
    id_: str, stamp: Moment, ended: set[str]
) -> None:
    goals = GoalList()
    a, b = active(goals, "a", EARLY), active(goals, "b", LATE)
    assert {goal.id for goal in goals.cancel(id_, stamp, 1.0)} == ended
    assert {goal.id for goal in (a, b) if goal.state is GoalState.PREEMPTING} == ended


def test_a_goal_that_is_over_is_not_cancelled() -> None:
    goals = GoalList()
    goals.end(active(goals, "a"), GoalState.SUCCEEDED, "arrived", 1.0)
    assert goals.cancel("a", NEVER, 2.0) == []
    assert goals.listed(2.0)[0].state is GoalState.SUCCEEDED


def test_a_cancel_that_comes_before_its_goal_counts() -> None:
    goals = GoalList()
    assert goals.cancel("a", NEVER, 0.0) == []
    late = goals.take("a", EARLY, 1.0)
    assert late is not None
    assert late.state is GoalState.RECALLED
    assert goals.take("a", EARLY, 1.0) is None


def test_a_goal_that_is_older_than_the_last_cancel_is_recalled() -> None:
    goals = GoalList()
    goals.cancel("", LATE, 0.0)
    stale, fresh = goals.take("a", EARLY, 0.0), goals.take("b", Moment(21.0), 0.0)
    assert stale is not None
    assert stale.state is GoalState.RECALLED
    assert fresh is not None
    assert fresh.state is GoalState.PENDING


def test_a_goal_that_is_over_is_listed_for_a_while() -> None:
    goals = GoalList()
    goals.end(active(goals, "a"), GoalState.ABORTED, "no way", 1.0)
    assert len(goals.listed(1.0 + LISTED - 0.1)) == 1
    assert goals.listed(1.0 + LISTED) == []


def test_a_flood_of_cancels_is_forgotten_but_not_the_goal() -> None:
    goals = GoalList()
    goal = active(goals, "a")
    for number in range(3 * MOST):
        goals.cancel(f"unknown {number}", NEVER, 1.0)
    assert len(goals.listed(1.0)) == MOST
    assert goal in goals.listed(1.0)
