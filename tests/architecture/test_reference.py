"""The reference pages have what the package has."""

from pathlib import Path

import pytest

from docs.reference.protocol_tables import PAGES, filled
from pioneer3.arcos import commands, reports

PROTOCOL = PAGES[0].read_text(encoding="utf-8")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_the_tables_are_up_to_date(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    assert text == filled(text), "run: uv run docs/reference/protocol_tables.py"


def test_every_command_is_on_the_page() -> None:
    for cls in commands.every_command():
        name = f"`{cls.__name__}` | "
        if cls.__name__ in commands.NUMBERS:
            name = f"| {cls.ID} | {cls.__name__} | "
        assert name in PROTOCOL, cls


def test_every_report_is_on_the_page_with_its_layout() -> None:
    for cls in reports.ALL:
        assert f"| `{cls.__name__}` | " in PROTOCOL
        assert f"**{cls.__name__}**, " in PROTOCOL
