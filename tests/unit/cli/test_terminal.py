"""A terminal obeys nothing in a text of others, whichever way it is written."""

import json
import logging
from collections.abc import Callable

import pytest
from rich.panel import Panel
from rich.segment import Segment
from rich.table import Table
from rich.text import Text
from textual.strip import Strip

from pioneer3.cli import process
from pioneer3.cli.live import rewrite
from pioneer3.cli.terminal import Terminal
from pioneer3.teleop.screen import obeyed_by_none

FORGED = "a\x1b[2J\x9b2J\u202eb"
SHOWN = r"a\x1b[2J\x9b2J\u202eb"


def table(text: str) -> Table:
    made = Table("robot")
    made.add_row(text)
    made.add_row(Text(text, "bold"))
    return made


@pytest.mark.parametrize(
    "write",
    [
        process.write_line,
        process.write_error,
        process.write_warning,
        Terminal().print,
        Terminal(stderr=True, soft_wrap=True).print,
        lambda text: Terminal().print(Text(text, "red")),
        lambda text: Terminal().print(table(text)),
        lambda text: Terminal().print(Panel(table(text), title=text)),
    ],
)
def test_no_way_to_write_lets_a_terminal_obey(
    write: Callable[[str], object], capsys: pytest.CaptureFixture[str]
) -> None:
    write(FORGED)
    written = "".join(capsys.readouterr())
    assert SHOWN[:6] in written
    assert written.replace("\n", "").isprintable()


def test_lines_stay_lines(capsys: pytest.CaptureFixture[str]) -> None:
    process.write_line("a\n\tb")
    assert capsys.readouterr().out == "a\n\tb\n"


def test_a_live_line_has_no_sequence_but_its_own(capsys: pytest.CaptureFixture[str]) -> None:
    rewrite(FORGED)
    assert capsys.readouterr().out == f"\r\x1b[K{SHOWN}"


def test_json_keeps_what_it_escapes(capsys: pytest.CaptureFixture[str]) -> None:
    told = {"name": f"{FORGED}\U000e0001"}
    process.write_json(told)
    written = capsys.readouterr().out
    assert written.rstrip("\n").isprintable()
    assert json.loads(written) == told


def test_a_record_of_a_log_is_one_line_and_its_traceback_is_printable() -> None:
    record = logging.LogRecord("name", logging.WARNING, "", 0, "%s\nERROR: no", (FORGED,), None)
    formatter = process.LogFormatter("%(levelname)s: %(message)s")
    assert formatter.format(record) == rf"WARNING: {SHOWN}\nERROR: no"
    error = ValueError(FORGED)
    record.exc_info = (ValueError, error, None)
    line, *trace = formatter.format(record).split("\n")
    assert trace[-1] == f"ValueError: {SHOWN}"
    assert all(each.isprintable() for each in (line, *trace))


def test_a_line_of_a_screen_is_obeyed_by_no_terminal() -> None:
    strip = obeyed_by_none(Strip([Segment(FORGED), Segment(" and more")]))
    assert strip.text == f"{SHOWN} and more"
