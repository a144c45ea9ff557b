"""The units of the wire."""

from math import pi

import pytest

from pioneer3 import units
from pioneer3.units import ANGLE, DURATION, LENGTH, SPEED, TURN_RATE, Quantity

WRITTEN = [
    (LENGTH, "2", 2.0),
    (LENGTH, "-50cm", -0.5),
    (LENGTH, "1500 mm", 1.5),
    (LENGTH, ".5m", 0.5),
    (ANGLE, "90", pi / 2),
    (ANGLE, "-90deg", -pi / 2),
    (ANGLE, "45°", pi / 4),
    (ANGLE, "1.57rad", 1.57),
    (SPEED, "0.3", 0.3),
    (SPEED, "30cm/s", 0.3),
    (SPEED, "3e2mm/s", 0.3),
    (TURN_RATE, "180", pi),
    (TURN_RATE, "0.8rad/s", 0.8),
    (TURN_RATE, "180°/s", pi),
    (DURATION, "60", 60.0),
    (DURATION, "2min", 120.0),
    (DURATION, "250ms", 0.25),
]


@pytest.mark.parametrize(("quantity", "text", "value"), WRITTEN)
def test_a_number_is_read_with_its_unit_or_without(
    quantity: Quantity, text: str, value: float
) -> None:
    assert quantity.read(text) == pytest.approx(value)


def test_another_unit_of_bare_numbers_can_be_asked_for() -> None:
    assert LENGTH.read("3000", "mm") == pytest.approx(3.0)
    assert LENGTH.read("3m", "mm") == 3.0


@pytest.mark.parametrize("text", ["", "fast", "nan", "inf", "-inf", "1,5", "0x10", "1e999", "--1"])
@pytest.mark.parametrize("quantity", [LENGTH, ANGLE, SPEED, TURN_RATE, DURATION])
def test_what_is_no_finite_number_is_refused(quantity: Quantity, text: str) -> None:
    with pytest.raises(ValueError, match=quantity.name):
        quantity.read(text)


def test_a_unit_of_something_else_is_refused_with_those_that_fit() -> None:
    with pytest.raises(ValueError, match=r"'m' is no unit of an angle.*\(units: deg, °, rad\)"):
        ANGLE.read("1m")


def test_a_value_is_written_in_few_digits_and_reads_the_same() -> None:
    assert TURN_RATE.written(0.5) == "28.65 deg/s"
    assert SPEED.written(0.7500000000000001) == "0.75 m/s"
    assert TURN_RATE.read(TURN_RATE.written(pi)) == pytest.approx(pi)


def test_a_turn_is_4096_units_and_360_degrees() -> None:
    assert pytest.approx(2 * pi) == units.HEADING_UNITS * units.HEADING_UNIT
    assert pytest.approx(2 * pi) == 360 * units.DEGREE


def test_a_thousand_of_each_small_unit_is_one_and_ten_decivolts_are_a_volt() -> None:
    assert 1000 * units.MM == 1
    assert 1000 * units.MS == 1
    assert 10 * units.DECIVOLT == 1
