"""Who drives when several want to: the rules of facts.md 7.4."""

from dataclasses import dataclass
from math import inf, nan, pi, radians

import pytest

from pioneer3.behaviors.action import Action, Desire, Goal, Ranked, Situation, Stack, Weighted
from pioneer3.behaviors.engine import ActionError, Decision, approach, resolve
from pioneer3.geometry import STILL, Pose2, Twist2
from tests.unit.behaviors.support import LIMITS, seen


@dataclass
class Wants(Action):
    name: str
    priority: int
    desire: Desire | None

    def decide(self, situation: Situation) -> Desire | None:
        return self.desire


def decided(*actions: Wants, theta: float = 0.0) -> Decision:
    stacks = [Stack.alone(action, action.priority) for action in actions]
    return resolve(stacks, seen(pose=Pose2(0, 0, theta)))


WEB = Wants("web", 80, Desire(v=0.2, w=0.5, until=3.0))
STICK = Wants("stick", 100, Desire(v=-0.1, w=0.0, until=1.0))
STEER = Wants("steer", 90, Desire(w=-0.3, until=2.0))
CAUTION = Wants("caution", 10, Desire(v_max=0.05))


@pytest.mark.parametrize(
    ("actions", "decision"),
    [
        ((), (STILL, inf, None, None)),
        ((Wants("idle", 99, None),), (STILL, inf, None, None)),
        ((WEB,), (Twist2(0.2, 0.5), 3.0, "web", "web")),
        ((WEB, STICK), (Twist2(-0.1, 0.0), 1.0, "stick", "stick")),
        ((WEB, STEER), (Twist2(0.2, -0.3), 2.0, "web", "steer")),
        ((WEB, CAUTION), (Twist2(0.05, 0.5), 3.0, "web", "web")),
        ((STICK, CAUTION), (Twist2(-0.1, 0.0), 1.0, "stick", "stick")),
        ((CAUTION,), (STILL, inf, None, None)),
    ],
)
def test_each_channel_goes_to_the_highest_priority_that_speaks(
    actions: tuple[Wants, ...], decision: tuple[Twist2, float, str | None, str | None]
) -> None:
    for order in (actions, tuple(reversed(actions))):
        got = decided(*order)
        assert (got.twist, got.until, got.v_by, got.w_by) == decision


def test_a_limit_alone_asks_for_nothing() -> None:
    assert not decided(CAUTION).wanted
    assert decided(WEB).wanted
    assert decided(STEER).wanted


def test_what_strength_is_left_goes_to_the_next_priority() -> None:
    # (0.6 * 0.100 + (1 - 0.6) * 0.300) / 1 = 0.180
    high = Wants("high", 2, Desire(v=Weighted(0.1, 0.6)))
    low = Wants("low", 1, Desire(v=Weighted(0.3, 1.0)))
    assert decided(low, high).twist.v == pytest.approx(0.18)


def test_equal_priorities_give_the_mean_by_strength() -> None:
    # (0.5 * 0.100 + 0.25 * 0.300) / 0.75 = 0.1667, with strength 0.75;
    # below it the last quarter goes to 0.4: 0.75 * 0.1667 + 0.25 * 0.4 = 0.225
    one = Wants("one", 2, Desire(v=Weighted(0.1, 0.5)))
    two = Wants("two", 2, Desire(v=Weighted(0.3, 0.25)))
    low = Wants("low", 1, Desire(v=0.4))
    assert decided(one, two).twist.v == pytest.approx(0.125 / 0.75)
    assert decided(two, low, one).twist.v == pytest.approx(0.225)


def test_strengths_of_a_group_are_cut_to_one_together() -> None:
    # both full: the mean; nothing is left for the one below
    one, two = Wants("one", 2, Desire(v=0.1)), Wants("two", 2, Desire(v=0.3))
    assert decided(one, two, Wants("low", 1, Desire(v=0.7))).twist.v == pytest.approx(0.2)


def test_limits_of_one_group_take_the_safest_value_in_any_order() -> None:
    go = Wants("go", 1, Desire(v=0.5))
    one, two = Wants("one", 2, Desire(v_max=0.1)), Wants("two", 2, Desire(v_max=0.2))
    for order in ((go, one, two), (two, one, go)):
        assert decided(*order).twist.v == 0.1


def test_limits_of_lower_priority_hold_and_their_strength_does_not_matter() -> None:
    go = Wants("go", 9, Desire(v=-0.5, w=1.0))
    limits = Wants("limits", 1, Desire(back_max=Weighted(0.2, 0.01), left_max=0.3, right_max=0.0))
    assert decided(go, limits).twist == Twist2(-0.2, 0.3)
    none = Wants("none", 1, Desire(back_max=Weighted(0.2, 0.0)))
    assert decided(go, none).twist.v == -0.5


def test_brakes_take_the_hardest_value() -> None:
    soft, hard = (
        Wants("soft", 2, Desire(deceleration=0.3)),
        Wants("hard", 1, Desire(deceleration=1)),
    )
    assert decided(soft, hard, WEB).limits["deceleration"] == 1.0


def test_a_heading_is_a_turn_from_the_present_heading_the_short_way() -> None:
    # from 170 to -170 degrees it is 20 degrees to the left
    aim = Wants("aim", 1, Desire(heading=radians(-170)))
    turn = Wants("turn", 1, Desire(turn=radians(20)))
    theta = radians(170)
    assert decided(aim, theta=theta).twist.w == pytest.approx(decided(turn).twist.w)
    assert decided(turn).twist.w == approach(
        radians(20), LIMITS.max_turn_rate, LIMITS.turn_deceleration
    )


def test_who_turns_by_angle_is_not_mixed_with_who_turns_at_a_rate_below() -> None:
    angle = Wants("angle", 2, Desire(turn=Weighted(radians(10), 0.5)))
    rate = Wants("rate", 1, Desire(w=-1.0))
    assert decided(angle, rate).twist.w == decided(angle).twist.w > 0
    above = Wants("rate", 3, Desire(w=Weighted(-1.0, 0.5)))
    assert decided(angle, above).twist.w == -1.0


def test_at_equal_priority_the_angle_is_used() -> None:
    angle, rate = Wants("angle", 2, Desire(turn=0.2)), Wants("rate", 2, Desire(w=-1.0))
    assert decided(angle, rate).twist.w > 0


def test_a_turn_of_less_than_half_a_degree_is_done() -> None:
    assert decided(Wants("turn", 1, Desire(turn=radians(0.4)))).twist.w == 0.0


def test_a_turn_keeps_within_the_limit_of_its_side() -> None:
    right = Wants("right", 1, Desire(turn=-pi / 2))
    slow = Wants("slow", 2, Desire(right_max=0.1, left_max=1.0))
    assert decided(right, slow).twist.w == pytest.approx(-0.1)


def test_actions_know_what_those_above_want() -> None:
    heard: list[float] = []

    class Listens(Action):
        name = "listens"

        def decide(self, situation: Situation) -> None:
            heard.append(situation.higher.strength("v"))

    stack = Stack.of(
        "mode", 5, [Ranked(1, Listens()), Ranked(2, Wants("half", 0, Desire(v=Weighted(0.1, 0.5))))]
    )
    resolve([stack, Stack.alone(Wants("low", 0, Desire(v=1.0)), 1)], seen())
    assert heard == [0.5]


def test_the_stack_comes_before_the_place_within() -> None:
    low = Stack.of("low", 1, [Ranked(100, Wants("strong", 0, Desire(v=0.1)))])
    high = Stack.of("high", 2, [Ranked(1, Wants("weak", 0, Desire(v=0.2)))])
    assert resolve([low, high], seen()).v_by == "weak"


def test_a_mode_asks_its_actions_and_most_have_nothing_to_say() -> None:
    class Arrives(Wants):
        done, wants_scans, failed, goal = True, True, "no way", Goal(x=1.0, y=2.0)

    plain = Stack.alone(Wants("plain", 0, None), 0)
    assert (plain.done, plain.failed, plain.goal, plain.wants_scans) == (False, None, None, False)
    one = plain.adding(Arrives("arrives", 0, None), 1)
    assert (one.done, one.failed, one.goal, one.wants_scans) == (True, "no way", Arrives.goal, True)


def test_what_does_not_inherit_from_action_is_refused_before_it_drives() -> None:
    class Foreign:
        name = "foreign"

        def decide(self, situation: Situation) -> None:
            raise AssertionError

    with pytest.raises(TypeError, match="Foreign is no action: it must inherit from"):
        Stack.alone(Foreign(), 1)  # type: ignore[arg-type]


def test_two_actions_of_one_name_are_refused() -> None:
    with pytest.raises(ValueError, match="two actions are called web"):
        Stack.of("mode", 1, [Ranked(1, WEB), Ranked(2, WEB)])


@pytest.mark.parametrize(
    "failing", [lambda: 1 / 0, lambda: Desire(v=nan), lambda: Desire(turn=1, heading=1)]
)
def test_a_failing_action_is_named(failing: object) -> None:
    class Fails(Action):
        name = "shy"

        def decide(self, situation: Situation) -> Desire | None:
            assert callable(failing)
            return failing()  # type: ignore[no-any-return]

    with pytest.raises(ActionError, match="the action 'shy' failed"):
        resolve([Stack.alone(Fails(), 1)], seen())


def test_a_decision_says_who_has_which_part() -> None:
    high = Wants("high", 2, Desire(v=Weighted(0.1, 0.6), reason="near"))
    low = Wants("low", 1, Desire(v=0.3, v_max=0.5))
    shares = [(s.action, s.channel, s.strength, s.reason) for s in decided(low, high).contributions]
    assert shares == [
        ("high", "v", 0.6, "near"),
        ("low", "v", pytest.approx(0.4), ""),
        ("low", "v_max", 1.0, ""),
    ]
