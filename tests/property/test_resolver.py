"""What holds for any actions: the order of adding never matters, limits only ever tighten."""

from dataclasses import dataclass
from math import inf

from hypothesis import given
from hypothesis import strategies as st

from pioneer3.behaviors.action import Action, Desire, Ranked, Situation, Stack, Weighted
from pioneer3.behaviors.engine import Decision, resolve
from tests.unit.behaviors.support import seen


@dataclass(frozen=True)
class Wants(Action):
    name: str
    desire: Desire

    def decide(self, situation: Situation) -> Desire | None:
        return self.desire


def wishes(low: float, high: float) -> st.SearchStrategy[Weighted | None]:
    return st.none() | st.builds(
        Weighted, st.floats(low, high), st.sampled_from([0.0, 0.1, 0.25, 0.5, 1.0])
    )


LIMIT = wishes(0, 2)
DESIRES = st.builds(
    Desire,
    v=wishes(-1, 1),
    turn=wishes(-3, 3),
    w=wishes(-2, 2),
    v_max=LIMIT,
    back_max=LIMIT,
    left_max=LIMIT,
    right_max=LIMIT,
    acceleration=LIMIT,
    deceleration=LIMIT,
    until=st.floats(0, 10),
)
RANKED = st.lists(st.tuples(st.integers(0, 4), DESIRES), max_size=8).map(
    lambda found: [Ranked(p, Wants(f"action {i}", d)) for i, (p, d) in enumerate(found)]
)


def decided(ranked: list[Ranked]) -> Decision:
    return resolve([Stack.of("mode", 1, ranked)], seen())


@given(RANKED, st.randoms(use_true_random=False))
def test_the_order_of_adding_never_matters(ranked: list[Ranked], shuffle: object) -> None:
    shuffled = list(ranked)
    shuffle.shuffle(shuffled)  # type: ignore[attr-defined]
    assert decided(shuffled) == decided(ranked)


@given(RANKED, DESIRES, st.integers(0, 4))
def test_limits_only_ever_tighten(ranked: list[Ranked], more: Desire, priority: int) -> None:
    limiting = Desire(
        v_max=more.v_max, back_max=more.back_max, left_max=more.left_max, right_max=more.right_max
    )
    free, limited = decided(ranked), decided([*ranked, Ranked(priority, Wants("more", limiting))])
    for before, after in ((free.twist.v, limited.twist.v), (free.twist.w, limited.twist.w)):
        assert abs(after) <= abs(before) + 1e-12
        assert before * after >= 0


@given(RANKED)
def test_nothing_exceeds_any_limit(ranked: list[Ranked]) -> None:
    got = decided(ranked)
    assert -got.limits.get("back_max", 1.0) <= got.twist.v <= got.limits.get("v_max", 1.0)
    right = got.limits.get("right_max", 2.0)
    assert -right <= got.twist.w <= got.limits.get("left_max", 2.0)


@given(RANKED)
def test_values_stay_within_what_was_wanted(ranked: list[Ranked]) -> None:
    wanted = [
        r.action.desire.v.value
        for r in ranked
        if isinstance(r.action, Wants) and isinstance(r.action.desire.v, Weighted)
    ]
    v = decided(ranked).twist.v
    assert min([0.0, *wanted]) - 1e-12 <= v <= max([0.0, *wanted]) + 1e-12


FULL = st.builds(
    Desire,
    v=st.none() | st.floats(-1, 1),
    w=st.none() | st.floats(-1, 1),
    v_max=st.none() | st.floats(0, 2),
    until=st.floats(0, 10),
)


@given(st.lists(FULL, max_size=6))
def test_at_full_strength_the_highest_that_speaks_owns_a_channel(
    desires: list[Desire],
) -> None:
    ranked = [Ranked(-n, Wants(f"{n}", desire)) for n, desire in enumerate(desires)]
    got = decided(ranked)
    v = next(((str(n), d) for n, d in enumerate(desires) if d.v is not None), (None, Desire(v=0.0)))
    w = next(((str(n), d) for n, d in enumerate(desires) if d.w is not None), (None, Desire(w=0.0)))
    assert (got.v_by, got.w_by) == (v[0], w[0])
    tops = [d.v_max for d in desires if isinstance(d.v_max, float)]
    assert isinstance(v[1].v, float)
    assert (got.twist.v, got.twist.w) == (min([v[1].v, *tops]), w[1].w)
    assert got.until == min((d.until for name, d in (v, w) if name is not None), default=inf)
