"""Wrapping counters lose nothing, wherever they begin and however far they go."""

from hypothesis import given
from hypothesis import strategies as st

from pioneer3.robot.assemble import POSITION_MODULUS, Counter, difference

HALF = POSITION_MODULUS // 2


@given(st.integers(0, POSITION_MODULUS - 1), st.lists(st.integers(1 - HALF, HALF - 1)))
def test_a_total_is_the_sum_of_all_steps(start: int, steps: list[int]) -> None:
    counter, position, total = Counter(POSITION_MODULUS), start, 0
    assert counter.update(start) == 0
    for step in steps:
        position, total = position + step, total + step
        assert counter.update(position % POSITION_MODULUS) == total


@given(st.integers(), st.integers(), st.sampled_from([2, 4096, 1 << 15, 1 << 16]))
def test_a_difference_leads_from_the_old_to_the_new(new: int, old: int, modulus: int) -> None:
    way = difference(new, old, modulus)
    assert -modulus // 2 <= way < modulus // 2
    assert (old + way - new) % modulus == 0
