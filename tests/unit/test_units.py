"""The units of the wire."""

from math import pi

import pytest

from pioneer3 import units


def test_a_turn_is_4096_units_and_360_degrees() -> None:
    assert pytest.approx(2 * pi) == units.HEADING_UNITS * units.HEADING_UNIT
    assert pytest.approx(2 * pi) == 360 * units.DEGREE


def test_a_thousand_of_each_small_unit_is_one_and_ten_decivolts_are_a_volt() -> None:
    assert 1000 * units.MM == 1
    assert 1000 * units.MS == 1
    assert 10 * units.DECIVOLT == 1
