"""Columns of tables: names with units, and a cell in each for every message."""

from math import inf, nan
from typing import Any

from pioneer3.log.columns import ValueShape


def table(*messages: dict[str, Any]) -> tuple[list[str], list[type], list[list[Any]]]:
    """Return names and types of columns, and the rows."""
    shape = ValueShape()
    for message in messages:
        shape.see(message)
    columns = list(shape.columns())
    rows = [shape.cells(message) for message in messages]
    assert all(len(row) == len(columns) for row in rows)
    return [column.name for column in columns], [column.kind for column in columns], rows


def test_each_number_has_a_column_with_its_unit() -> None:
    names, kinds, rows = table({"pose": {"x": 1.0, "theta": 2.0}, "low": True, "by": "key"})
    assert names == ["pose.x [m]", "pose.theta [rad]", "low", "by"]
    assert kinds == [float, float, bool, str]
    assert rows == [[1.0, 2.0, True, "key"]]


def test_lists_of_numbers_have_a_column_each_as_many_as_the_longest_has() -> None:
    names, kinds, rows = table({"ranges": [0.5]}, {"ranges": (1.0, "inf")}, {"ranges": []})
    assert names == ["ranges.0 [m]", "ranges.1 [m]"]
    assert kinds == [float, float]
    assert rows == [[0.5, None], [1.0, inf], [None, None]]


def test_other_lists_are_json_in_one_cell() -> None:
    names, kinds, rows = table({"fresh": [1, 2], "parts": [{"value": nan}], "faults": []})
    assert names == ["fresh", "parts", "faults"]
    assert kinds == [str, str, str]
    assert rows == [["[1,2]", '[{"value":"nan"}]', "[]"]]


def test_a_part_that_comes_later_has_its_place_beside_its_neighbours() -> None:
    names, _, rows = table({"pose": None, "by": "key"}, {"pose": {"x": 1.0}, "by": None})
    assert names == ["pose.x [m]", "by"]
    assert rows == [[None, "key"], [1.0, None]]


def test_words_for_numbers_are_numbers_only_where_all_others_are() -> None:
    _, kinds, rows = table({"spread": "inf", "by": "nan"}, {"spread": 0.5, "by": "Nan"})
    assert kinds == [float, str]
    assert rows == [[inf, "nan"], [0.5, "Nan"]]


def test_whole_numbers_become_others_where_one_is_none() -> None:
    _, kinds, rows = table({"speed": 1}, {"speed": 0.5})
    assert kinds == [float]
    assert rows == [[1.0], [0.5]]


def test_a_place_with_different_things_is_text() -> None:
    things: list[Any] = [{"a": 1}, 1.5, [2.5], "word", None]
    names, kinds, rows = table(*({"thing": each} for each in things))
    assert (names, kinds) == (["thing"], [str])
    assert rows == [['{"a":1}'], ["1.5"], ["[2.5]"], ["word"], [None]]
