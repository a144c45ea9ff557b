"""docs/reference/simulated.md is complete, and tells the truth about the accessories."""

import re
from pathlib import Path

from pioneer3.arcos import commands, reports
from pioneer3.sim.accessories.collection import IGNORED

PAGE = Path(__file__).parents[4] / "docs" / "reference" / "simulated.md"
ROW = re.compile(r"^\| (0x[0-9A-F]+|\d+) \| [^|]+ \| (simulated|answers|ignored) \|", re.MULTILINE)


def rows(heading: str) -> list[tuple[int, str]]:
    section = PAGE.read_text().split(f"## {heading}\n")[1].split("\n## ")[0]
    return [(int(number, 0), word) for number, word in ROW.findall(section)]


def test_every_command_is_listed_once() -> None:
    listed = [number for number, _ in rows("Commands")]
    assert listed == sorted({command.ID for command in commands.every_command()})


def test_every_report_is_listed_once() -> None:
    listed = [number for number, _ in rows("Reports")]
    handshake = {0, 1, 2}
    spoken = {number for cls in reports.ALL for number in reports.numbers(cls)} - handshake
    unused_sips = {0x30, 0x31, 0x34}
    assert listed == sorted(spoken - unused_sips)


def test_what_is_taken_silently_is_called_ignored() -> None:
    words = dict(rows("Commands"))
    assert {words[number] for number in IGNORED} == {"ignored"}


def test_every_operation_of_the_simulator_is_listed() -> None:
    section = PAGE.read_text().split("SIM_CTRL:\n")[1].split("\n## ")[0]
    numbers = re.findall(r"^\| ([\d, ]+?) [a-z]", section, re.MULTILINE)
    listed = [int(number) for row in numbers for number in row.split(", ")]
    assert listed == [int(operation) for operation in commands.SimOperation]
