"""The table of `fleet drive`: words for every state, and what the page says about the columns."""

from dataclasses import replace
from pathlib import Path

import pytest

from pioneer3.fleet.drive_table import COLUMNS, Look, cells, headline, widths
from pioneer3.fleet.members import Member, MemberReport, Reached
from pioneer3.robot.explain import Reason, ReasonKind
from pioneer3.teleop.several import RobotChooser, Selection

ROOT = Path(__file__).parents[3]
NAMES = ["p3at-1", "p3at-2"]
MOVES = MemberReport(speed=0.2, turn_rate=-0.35, motors=True, voltage=12.62, low=False, stands=None)


def look(
    reached: Reached = Reached.CONNECTED,
    why: str = "",
    told: MemberReport | None = None,
    *,
    name: str = "p3at-1",
    keys: str = "",
) -> Look:
    selection = Selection({each: number for number, each in enumerate(NAMES)})
    for key in keys:
        choice = {"s": RobotChooser.SEVERAL, "a": RobotChooser.ALL, "q": RobotChooser.NEXT}[key]
        selection.press(choice, key)
    member = Member(name=name, number=0, reached=reached, why=why, since=10.0, told=told)
    return Look(member, selection, 14.2)


def texts(seen: Look) -> list[str]:
    return [cell.text for cell in cells(seen)]


def test_a_robot_that_moves() -> None:
    assert texts(look(told=MOVES)) == [
        "drives", "0", "p3at-1", "connected", " 0.20  -20", "on", "12.6", "",
    ]  # fmt: skip


@pytest.mark.parametrize(("age", "state"), [(0.4, "connected"), (0.72, "old 0.7 s")])
def test_an_old_report_is_told(age: float, state: str) -> None:
    cell = cells(look(told=replace(MOVES, age=age)))[3]
    assert (cell.text, cell.ok) == (state, state == "connected")


@pytest.mark.parametrize("reached", [Reached.WAITS, Reached.LOST, Reached.REFUSED])
def test_a_robot_that_is_not_there_says_since_when_and_why(reached: Reached) -> None:
    why = "tcp://10.0.0.1:8101: nobody listens there"
    seen = look(reached, why)
    assert texts(seen)[3:] == [f"{reached} 4 s", "-", "-", "-", "nobody listens there"]
    assert cells(seen)[3].ok is cells(seen)[7].ok is False


def test_what_is_normal_is_no_fault_and_an_idle_robot_says_nothing() -> None:
    def why(kind: ReasonKind, *, taken: bool = False) -> tuple[str, bool | None]:
        told = replace(MOVES, stands=Reason(kind, "Because."), taken=taken)
        cell = cells(look(told=told))[-1]
        return cell.text, cell.ok

    assert why(ReasonKind.IDLE) == ("", None)
    assert why(ReasonKind.NORMAL) == ("Because.", None)
    assert why(ReasonKind.FAULT) == ("Because.", False)
    watches = why(ReasonKind.FAULT, taken=True)
    assert watches == ("another program drives it; only stops count", None)


def test_a_low_battery_is_told_in_words() -> None:
    assert texts(look(told=replace(MOVES, voltage=11.04, low=True)))[6] == "11.0 LOW"


def test_marks_come_before_what_drives_now() -> None:
    assert texts(look(keys="sa"))[0] == "marked"
    assert texts(look(keys="s"))[0] == "drives"
    assert texts(look(keys="q"))[0] == ""


def test_the_headline_counts() -> None:
    looks = [look(told=MOVES), look(Reached.LOST, "gone", name="p3at-2")]
    assert headline(looks, emergency=False) == "2 robots: 1 connected, 1 lost; 1 move"
    assert headline(looks, emergency=True).endswith("EMERGENCY STOP is latched")


@pytest.mark.parametrize("columns", [80, 100, 200])
def test_the_last_column_takes_the_room_that_is_left(columns: int) -> None:
    across = widths(["p3at-1", "a-robot-with-a-long-name"], columns)
    assert sum(across) + len(across) - 1 == columns
    assert across[-1] >= 10


def test_the_page_says_what_the_columns_mean() -> None:
    page = (ROOT / "docs/how-to/fleet-drive.md").read_text("utf-8")
    for column in COLUMNS:
        title = " ".join(column.title.split())
        assert f"| {title} | {column.meaning} |" in page
