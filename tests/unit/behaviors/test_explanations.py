"""What people are told about a decision."""

from dataclasses import dataclass

from pioneer3.behaviors.action import Action, Desire, Ranked, Situation, Stack, Weighted
from pioneer3.behaviors.engine import Decision, resolve
from pioneer3.behaviors.explanations import explain, explain_parts, explain_standstill
from tests.unit.behaviors.support import seen


@dataclass(frozen=True)
class Wants(Action):
    name: str
    desire: Desire

    def decide(self, situation: Situation) -> Desire | None:
        return self.desire


def decided(*desires: tuple[str, Desire]) -> Decision:
    ranked = [Ranked(-n, Wants(name, desire)) for n, (name, desire) in enumerate(desires)]
    return resolve([Stack.of("mode", 1, ranked)], seen())


GO = ("constant velocity", Desire(v=0.4, turn=0.0))


def test_nobody_says_nothing() -> None:
    assert explain(Decision()) == ()
    assert explain_standstill(Decision()) is None


def test_speed_limit_and_turn_are_told_with_their_reasons() -> None:
    avoid = ("avoid front", Desire(turn=0.3, reason="0.38 m at -12°"))
    limit = ("near limiter", Desire(v_max=0.1, reason="0.42 m ahead"))
    assert explain(decided(avoid, limit, GO)) == (
        "0.10 m/s: constant velocity",
        "held to 0.10 m/s: near limiter, 0.42 m ahead",
        "turns left at 49°/s: avoid front, 0.38 m at -12°",
    )


def test_limits_that_do_not_bite_are_not_told() -> None:
    assert explain(decided(("limiter", Desire(v_max=0.5)), GO)) == ("0.40 m/s: constant velocity",)


def test_a_mixture_says_the_parts() -> None:
    half = ("half", Desire(v=Weighted(0.2, 0.6)))
    assert explain(decided(half, GO))[0] == "0.28 m/s: half (60 %) and constant velocity (40 %)"


def test_who_holds_the_robot_back_is_why_it_stands() -> None:
    limit = ("near limiter", Desire(v_max=0.0, reason="0.22 m ahead"))
    assert explain(decided(limit, GO))[1] == "held back: near limiter, 0.22 m ahead"
    assert explain_standstill(decided(limit, GO)) == "near limiter, 0.22 m ahead"
    assert explain_standstill(decided(GO)) is None
    stop = ("stop", Desire(v=0.0, turn=0.0))
    assert explain_standstill(decided(stop, GO)) == "stop"
    back = ("back", Desire(v=-0.2))
    assert explain_standstill(decided(back, ("rear", Desire(back_max=0.0)))) == "rear"


def test_each_part_is_told_with_what_its_limit_takes_from_the_others() -> None:
    avoid = ("avoid front", Desire(turn=0.3, reason="0.38 m at -12°"))
    limit = ("near limiter", Desire(v_max=0.1, left_max=2.0, reason="0.42 m ahead"))
    loose = ("far limiter", Desire(v_max=0.3))
    parts = explain_parts(decided(avoid, limit, loose, GO))
    assert [(part.action, part.wanted, part.took) for part in parts] == [
        ("avoid front", "left by 17°", ""),
        ("near limiter", "at most 0.10 m/s ahead", "0.30 m/s"),
        ("near limiter", "at most 115°/s to the left", ""),
        ("far limiter", "at most 0.30 m/s ahead", ""),
        ("constant velocity", "0.40 m/s", ""),
    ]
    assert parts[0].reason == "0.38 m at -12°"


def test_a_limit_of_the_other_side_takes_nothing() -> None:
    back = ("back", Desire(v=-0.4, w=-1.0))
    limits = ("limiter", Desire(v_max=0.1, back_max=0.1, left_max=0.1, right_max=0.5))
    took = [part.took for part in explain_parts(decided(limits, back))]
    assert took == ["", "0.30 m/s", "", "29°/s", "", ""]


def test_a_mixture_tells_the_shares() -> None:
    parts = explain_parts(decided(("half", Desire(v=Weighted(0.2, 0.5))), GO))
    assert [part.wanted for part in parts] == ["0.20 m/s, 50 %", "0.40 m/s, 50 %", "no turn"]
