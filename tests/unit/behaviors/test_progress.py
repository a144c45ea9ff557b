"""Whether a robot comes nearer to its goal."""

from pioneer3.behaviors.action import PATIENCE, PROGRESS, Goal, ProgressChecker

AHEAD = Goal(x=10.0, y=0.0)


def until_given_up(
    checker: ProgressChecker, x: float, begin: float = 0.0, *, goal: Goal = AHEAD
) -> float:
    """Look four times a second at a robot that stands at `x`; return when it makes no progress."""
    now = begin
    while checker.check(goal, x, 0.0, now):
        now += 0.25
        assert now < begin + 1000.0
    return now - begin


def test_who_stands_is_given_up_after_a_while() -> None:
    assert until_given_up(ProgressChecker(), 0.0) == PATIENCE


def test_who_comes_nearer_is_waited_for_again_and_who_only_jitters_is_not() -> None:
    checker = ProgressChecker()
    for second in range(100):
        assert checker.check(AHEAD, second * 1.1 * PROGRESS, 0.0, second)
    jitter = ProgressChecker()
    looks = [jitter.check(AHEAD, 0.05 * (n % 2), 0.0, n / 4) for n in range(80)]
    assert looks.index(False) == 60


def test_another_goal_has_its_own_time() -> None:
    checker = ProgressChecker()
    assert checker.check(AHEAD, 0.0, 0.0, 0.0)
    until_given_up(checker, 0.0)
    assert checker.check(Goal(x=5.0, y=0.0), 0.0, 0.0, 100.0)


def test_a_person_may_stand_and_nowhere_need_not_come_nearer() -> None:
    checker = ProgressChecker()
    person = Goal(x=1.0, y=0.0, person=True)
    for second in range(100):
        assert checker.check(person if second < 50 else None, 0.0, 0.0, second)


def test_time_without_readings_does_not_count() -> None:
    checker = ProgressChecker()
    assert checker.check(AHEAD, 0.0, 0.0, 0.0)
    assert checker.check(AHEAD, 0.0, 0.0, 600.0)
    assert until_given_up(checker, 0.0, 600.1) > PATIENCE - 2.0
