"""The pictures of the book: each has a row in the table, a file, and a page that shows it."""

import re

from docs.plots.studio import MADE, ROOT, SOURCE
from docs.plots.table import PICTURES, ROWS

FOLDER = ROOT / "docs/images"
FILES = sorted(path for path in FOLDER.rglob("*") if path.is_file())
SHOWN = re.compile(r"!\[[^\]]+\]\((?:[\w./-]*/)?images/([\w./-]+)\)")
MOST = 2_000_000
"""Bytes of one picture."""


def test_each_picture_is_made_by_a_row_and_each_row_has_its_picture() -> None:
    files = {path.relative_to(ROOT).as_posix() for path in FILES}
    rows = {row.file for row in ROWS if row.file.startswith("docs/images/")}
    assert files == rows
    assert [row.file for row in ROWS if not row.path.is_file()] == []
    assert len(PICTURES) == len(ROWS)


def test_each_picture_is_shown_by_a_page_that_says_what_it_shows() -> None:
    pages = [ROOT / "README.md", *(ROOT / "docs").rglob("*.md")]
    shown = {name for page in pages for name in SHOWN.findall(page.read_text())}
    assert shown == {path.relative_to(FOLDER).as_posix() for path in FILES}


def test_no_picture_is_too_large_for_a_page() -> None:
    assert [path.name for path in FILES if path.stat().st_size > MOST] == []


def test_all_that_gives_a_picture_its_looks_is_there() -> None:
    parts = {part for row in ROWS for part in row.parts}
    assert [part for part in sorted(parts) if not (SOURCE / part).exists()] == []
    assert all(re.fullmatch("[0-9a-f]{16}", row.digest()) for row in ROWS)


def test_pictures_that_were_made_are_known_to_the_table() -> None:
    names = [line.split()[0] for line in MADE.read_text().splitlines()]
    assert set(names) <= set(PICTURES)
