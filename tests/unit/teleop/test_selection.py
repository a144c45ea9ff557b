"""Who of several robots drives: the keys that choose. Pure."""

import pytest

from pioneer3.teleop.several import ACTS, TABLE, RobotChooser, Selection, act_of, numbers


def selection(count: int = 5) -> Selection:
    return Selection(numbers([f"p3at-{number}" for number in range(1, count + 1)]))


def pressed(keys: str, count: int = 5) -> Selection:
    made = selection(count)
    for key in keys:
        act = act_of(key)
        assert isinstance(act, RobotChooser)
        made.press(act, key)
    return made


def chosen(keys: str) -> str:
    return "".join(name[-1] for name in pressed(keys).chosen)


@pytest.mark.parametrize(
    ("keys", "who"),
    [
        ("", "1"),
        ("q", "2"),
        ("qq\t", "4"),
        ("qqqqq", "1"),
        ("3", "3"),
        ("3q", "4"),
        ("a", "12345"),
        ("a4", "4"),
        ("7", "1"),
        ("s24y", "24"),
        ("s244y", "2"),
        ("s2", "1"),
        ("s24\r", "24"),
        ("say", "12345"),
        ("sa3y", "1245"),
        ("sqqy", "23"),
        ("s2qy", "23"),
        ("sy", "1"),
        ("3s1ys5y", "5"),
        ("S2Y", "2"),
    ],
)
def test_the_robots_that_keys_choose(keys: str, who: str) -> None:
    assert chosen(keys) == who


def test_several_are_marked_before_they_drive() -> None:
    made = pressed("s24")
    assert made.marked == frozenset({"p3at-2", "p3at-4"})
    assert list(made.chosen) == ["p3at-1"]


def test_escape_keeps_those_chosen() -> None:
    made = pressed("3s24")
    assert made.cancel()
    assert made.marked is None
    assert list(made.chosen) == ["p3at-3"]
    assert not made.cancel()


def test_a_click_lets_a_robot_drive_or_not_but_one_is_left() -> None:
    made = selection()
    made.toggle("p3at-3")
    assert list(made.chosen) == ["p3at-1", "p3at-3"]
    made.toggle("p3at-1")
    made.toggle("p3at-3")
    assert list(made.chosen) == ["p3at-3"]


def test_a_click_marks_while_several_are_chosen() -> None:
    made = pressed("s2")
    made.toggle("p3at-2")
    made.toggle("p3at-5")
    made.press(RobotChooser.CONFIRM)
    assert list(made.chosen) == ["p3at-5"]


def test_numbers_of_many_robots_have_as_many_digits_as_the_highest() -> None:
    made = pressed("07", count=100)
    assert made.label("p3at-7") == "007"
    assert list(made.chosen) == ["p3at-1"]
    made.press(RobotChooser.NUMBER, "3")
    assert list(made.chosen) == ["p3at-73"]
    made.press(RobotChooser.NUMBER, "1")
    made.press(RobotChooser.NEXT)
    assert list(made.chosen) == ["p3at-74"]
    assert made.typed == ""


def test_the_names_of_fleet_files_have_the_labs_numbers() -> None:
    assert numbers(["p3at-4", "p3dx-2"]) == {"p3at-4": 4, "p3dx-2": 2}
    assert numbers(["p3at-4", "rear"]) == {"p3at-4": 0, "rear": 1}


def test_no_key_means_two_things() -> None:
    assert len(ACTS) == sum(len(row.acts) for row in TABLE)
