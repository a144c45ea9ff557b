"""Who may drive when several people could."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pioneer3.web.control import TERM, Lease


def test_nobody_holds_a_new_lease() -> None:
    assert Lease[str]().holder(0.0) is None


def test_the_first_gets_control_and_the_second_is_refused() -> None:
    lease = Lease[str]()
    assert lease.take("ann", 0.0)
    assert not lease.take("bob", TERM / 2)
    assert lease.holder(TERM / 2) == "ann"


def test_the_lease_ends_exactly_a_term_after_its_last_renewal() -> None:
    lease = Lease[str]()
    lease.take("ann", 0.0)
    assert lease.take("ann", 0.5)
    assert lease.holder(1.499) == "ann"
    assert lease.holder(1.5) is None
    assert lease.take("bob", 1.5)


def test_a_refused_attempt_does_not_prolong_the_lease() -> None:
    lease = Lease[str]()
    lease.take("ann", 0.0)
    lease.take("bob", 0.9)
    assert lease.holder(1.0) is None


def test_whoever_gives_up_frees_control_at_once() -> None:
    lease = Lease[str]()
    lease.take("ann", 0.0)
    lease.release("ann")
    assert lease.holder(0.0) is None
    assert lease.take("bob", 0.0)


def test_giving_up_what_another_holds_changes_nothing() -> None:
    lease = Lease[str]()
    lease.take("ann", 0.0)
    lease.release("bob")
    assert lease.holder(0.0) == "ann"


@pytest.mark.parametrize("falsy", [0, "", ()])
def test_even_somebody_whose_name_is_false_keeps_others_out(falsy: object) -> None:
    lease = Lease[object]()
    assert lease.take(falsy, 0.0)
    assert not lease.take("bob", 0.1)


@given(st.lists(st.tuples(st.sampled_from("abc"), st.floats(0, 2)), max_size=20))
def test_only_the_holder_is_told_yes(attempts: list[tuple[str, float]]) -> None:
    lease, now = Lease[str](), 0.0
    for who, pause in attempts:
        now += pause
        before = lease.holder(now)
        assert lease.take(who, now) == (before in {None, who})
        assert lease.holder(now) == (before or who)
