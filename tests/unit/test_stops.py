"""The table of commands after a stop: each cell happens, and the page on safety has the same."""

from pathlib import Path

import pytest

from pioneer3 import stops
from tests.held import BACK, CAUSES, FORTH, LEFT, Driver, Publisher

SAFETY = (Path(__file__).parents[2] / "docs/explanation/safety.md").read_text()
Table = list[list[str]]


def table_in(text: str) -> Table:
    """Return the cells of the table that begins with a column `after`."""
    lines = text[text.index("\n| after ") + 1 :].split("\n\n", maxsplit=1)[0].splitlines()
    return [[cell.strip() for cell in line[1:-1].split("|")] for line in lines if "---" not in line]


TABLE = table_in(stops.__doc__ or "")
ROWS = [(cause, *cells) for causes, *cells in TABLE[1:] for cause in causes.split(", ")]
INPUTS = [row[:4] for row in ROWS]
MODES = [(row[0], row[4]) for row in ROWS if row[4]]


def stopped_by(cause: str) -> Driver:
    """Return a driver that drove forth, and held on when it was stopped."""
    driver = Publisher() if "publisher" in cause else Driver()
    assert driver.send(FORTH, 1.0) == "obeyed"
    CAUSES[cause](driver)
    assert driver.send(FORTH) == "ignored"
    return driver


def test_the_page_on_safety_has_the_same_table() -> None:
    assert table_in(SAFETY) == TABLE


def test_the_table_names_all_causes() -> None:
    assert [row[0] for row in ROWS] == list(CAUSES)


@pytest.mark.parametrize(("cause", "held_on", "let_go", "other_way"), INPUTS)
def test_commands_count_after_a_stop_as_in_the_table(
    cause: str, held_on: str, let_go: str, other_way: str
) -> None:
    for seconds in (0.2, 1.0, 60.0):
        steady = "obeyed" if held_on == "once steady" and seconds >= 1.0 else "ignored"
        assert stopped_by(cause).send(FORTH, seconds) == steady
    again = stopped_by(cause)
    again.let_go()
    assert again.send(FORTH) == let_go
    for away in (BACK, LEFT):
        turned = stopped_by(cause)
        assert turned.send(away) == other_way
        assert turned.send(FORTH) == other_way


@pytest.mark.parametrize(("cause", "ends"), MODES)
def test_modes_end_after_a_stop_as_in_the_table(cause: str, ends: str) -> None:
    driver = stopped_by(cause)
    last = driver.pilot.last_stop
    assert driver.mode.ignored(last) == last.told
    driver.mode.answer(last)
    assert (driver.mode.ignored(last) is None) == (ends == "answers")
