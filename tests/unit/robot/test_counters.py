"""Wheel counters that wrap around."""

import pytest

from pioneer3.robot.assemble import POSITION_MODULUS, Counter, difference


@pytest.mark.parametrize(
    ("new", "old", "way"),
    [
        (4102, 3, 4099),
        (2, 32765, 5),  # forward over the top (protocol.md 4.8)
        (32767, 0, -1),
        (0, 4097, -4097),  # ARIA makes +28671 of it
        (100, 5000, -4900),
        (0, 16384, -16384),
        (16384, 0, -16384),  # half a turn is ambiguous: backwards by convention
    ],
)
def test_the_shorter_way_is_taken(new: int, old: int, way: int) -> None:
    assert difference(new, old, POSITION_MODULUS) == way


def test_servers_that_count_in_sixteen_bits_agree() -> None:
    assert difference(3, 65533, POSITION_MODULUS) == 6


def test_the_first_reading_is_where_counting_begins() -> None:
    counter = Counter(POSITION_MODULUS)
    assert [counter.update(raw) for raw in (32000, 32100, 32000)] == [0, 100, 0]


def test_a_total_grows_beyond_what_the_counter_holds() -> None:
    counter = Counter(POSITION_MODULUS)
    totals = [counter.update(step * 1000 % POSITION_MODULUS) for step in range(101)]
    assert totals == [step * 1000 for step in range(101)]
