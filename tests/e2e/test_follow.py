"""A robot follows somebody through a furnished room: virtual time, errors as of a real robot."""

import pytest

from pioneer3.behaviors.follow import Rule
from tests.e2e.follow_course import make_course
from tests.e2e.follow_walk import Outcome, Walk


def walked(seed: int, rule: Rule, model: str, seconds: float = 60.0) -> Outcome:
    walk = Walk(course=make_course(seed), seed=seed, rule=rule, model=model, seconds=seconds)
    return walk.run()


@pytest.mark.parametrize(("model", "seed"), [("p3at-sh", 101), ("p3dx-sh", 102)])
def test_tracking_keeps_the_person(model: str, seed: int) -> None:
    outcome = walked(seed, "tracking", model)
    assert outcome.share() >= 0.95
    assert (outcome.lost, outcome.walls, outcome.contacts, outcome.ended) == (0, 0, 0, None)


def test_the_labs_rule_stays_farther_behind() -> None:
    """It has no speed of its own: at 0.4 m/s it is 0.48 m farther away than it wants to be."""
    outcome = walked(101, "lab", "p3at-sh", seconds=20.0)
    assert outcome.contacts == 0
    assert outcome.share(0.6, 1.0) > 0.3


def test_the_same_seed_gives_the_same_walk() -> None:
    one, other = (walked(103, "tracking", "p3dx-sh", seconds=10.0) for _ in range(2))
    assert one.gaps == other.gaps
