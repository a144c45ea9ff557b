"""The table of `pioneer3 ros2 check`."""

from rich.console import Console

from pioneer3.cli.ros2_check_table import absent_line, summary, table
from pioneer3.ros.checks.facts import CheckFault, CheckReport, CheckRow, ReportPart, fail, warn


def row(name: str, *faults: CheckFault, absent: str = "", rate: float | None = 10.0) -> CheckRow:
    return CheckRow(
        part=ReportPart.PUBLISHED,
        name=name,
        expected="sensor_msgs/msg/Range, 3 Hz",
        found="10.0 Hz",
        absent=absent,
        faults=faults,
        rate=rate,
    )


def shown(*rows: CheckRow, width: int = 80) -> str:
    report = CheckReport(node="/robot1/pioneer3", seconds=5.0, rows=rows)
    console = Console(width=width, color_system=None, force_terminal=False)
    with console.capture() as capture:
        console.print(table(report, width))
        console.print(absent_line(report) or "")
        console.print(summary(report))
    return capture.get()


def test_rows_that_differ_in_a_number_are_one() -> None:
    text = shown(*(row(f"/robot1/sonar/range_{number}", rate=3 + number) for number in range(3)))
    assert "sonar/range_0…2" in text
    assert "3.0 to 5.0 Hz" in text
    assert "range_1" not in text


def test_a_row_with_a_fault_stands_alone_with_its_reason_and_advice() -> None:
    fault = fail("range is NaN", example="7 of 9 messages", advice="mend the driver")
    text = shown(row("/robot1/sonar/range_0"), row("/robot1/sonar/range_1", fault), width=200)
    assert "FAIL range is NaN (7 of 9 messages)" in text
    assert "→ mend the driver" in text
    assert "sonar/range_0 " in text


def test_rows_with_the_same_fault_are_one() -> None:
    silent = [row(f"/robot1/sonar/range_{number}", fail("it is silent")) for number in range(16)]
    text = shown(row("/robot1/scan"), *silent)
    assert "sonar/range_0…15" in text
    assert text.count("FAIL it is silent") == 1


def test_the_table_fits_a_narrow_terminal() -> None:
    text = shown(row("/robot1/odom", fail("a " * 60)), row("/diagnostics", warn("b")))
    assert max(map(len, text.splitlines())) <= 80


def test_absent_parts_are_told_in_a_line() -> None:
    text = shown(row("/robot1/odom"), row("/robot1/scan", absent="a laser range finder"))
    assert "Without: a laser range finder (scan)." in text


def test_the_summary_counts_faults() -> None:
    good, odd, bad = row("/a"), row("/b", warn("odd")), row("/c", fail("bad"), warn("odd"))
    head = "/robot1/pioneer3: "
    assert f"{head}1 things checked in 5 s, all right." in shown(good)
    assert f"{head}2 things checked in 5 s, none wrong, 1 to look at." in shown(good, odd)
    assert f"{head}3 things checked in 5 s, 1 wrong, 1 to look at." in shown(good, odd, bad)
