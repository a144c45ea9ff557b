"""The resolver: order does not matter, priority does, and limits are never lost."""

from dataclasses import dataclass
from math import inf

from hypothesis import given
from hypothesis import strategies as st

from pioneer3.behaviors.engine import Action, Desire, resolve
from pioneer3.geometry import ORIGIN, STILL, Twist2
from pioneer3.state import Battery, Motors, Odometry, Snapshot

ODOMETRY = Odometry(robot_in_odom=ORIGIN, twist=STILL, left_speed=0, right_speed=0)
NOW = Snapshot(
    stamp=0.0, sequence=1, odometry=ODOMETRY, battery=Battery(voltage=12), motors=Motors()
)
SPEED = st.floats(-2, 2)


@dataclass(frozen=True)
class Fixed:
    """Always wants the same."""

    name: str
    priority: int
    desire: Desire | None

    def decide(self, snapshot: Snapshot, now: float) -> Desire | None:
        return self.desire


DESIRES = st.none() | st.builds(
    Desire,
    v=st.none() | SPEED,
    w=st.none() | SPEED,
    v_max=st.just(inf) | st.floats(0, 2),
    until=st.just(inf) | st.floats(0, 10),
)
ACTIONS = st.lists(DESIRES, max_size=6).map(
    lambda desires: [Fixed(f"a{n}", n, desire) for n, desire in enumerate(desires)]
)


@given(ACTIONS, st.randoms(use_true_random=False))
def test_the_order_of_the_actions_does_not_matter(actions: list[Action], random: object) -> None:
    shuffled = list(actions)
    random.shuffle(shuffled)  # type: ignore[attr-defined]
    assert resolve(shuffled, NOW, 0.0) == resolve(actions, NOW, 0.0)


@given(ACTIONS)
def test_the_highest_priority_that_speaks_owns_each_channel(actions: list[Fixed]) -> None:
    decision = resolve(actions, NOW, 0.0)
    spoken = [(a.name, a.desire) for a in reversed(actions) if a.desire is not None]
    v = next(((name, d.v) for name, d in spoken if d.v is not None), (None, 0.0))
    w = next(((name, d.w) for name, d in spoken if d.w is not None), (None, 0.0))
    assert (decision.v_by, decision.w_by) == (v[0], w[0])
    assert decision.twist.w == w[1]
    assert decision.twist.v == min(v[1], *(d.v_max for _, d in spoken), inf)
    assert decision.wanted == (v[0] is not None or w[0] is not None)


@given(ACTIONS)
def test_a_decision_holds_no_longer_than_the_desires_it_is_made_of(actions: list[Fixed]) -> None:
    decision = resolve(actions, NOW, 0.0)
    owners = {decision.v_by, decision.w_by}
    untils = [a.desire.until for a in actions if a.name in owners and a.desire is not None]
    assert decision.until == min(untils, default=inf)


@given(st.lists(SPEED, min_size=2, max_size=5))
def test_among_equals_the_first_one_decides(speeds: list[float]) -> None:
    equals = [Fixed(f"a{n}", 7, Desire(v=speed)) for n, speed in enumerate(speeds)]
    assert resolve(equals, NOW, 0.0).v_by == "a0"


def test_nobody_asks_for_anything() -> None:
    decision = resolve([], NOW, 0.0)
    assert decision.twist == Twist2()
    assert not decision.wanted
