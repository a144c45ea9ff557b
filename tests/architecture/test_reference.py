"""The reference pages have what the package has, and whatever cites them finds its section."""

import re
from collections.abc import Iterator
from itertools import chain
from pathlib import Path

import pytest

from docs.reference import fleet_tables, laser_tables, message_types, mode_tables
from docs.reference.protocol_tables import PAGES, filled
from pioneer3.arcos import commands, reports

ROOT = Path(__file__).parents[2]
BUILT = ROOT / "src/pioneer3/book"
PROTOCOL = PAGES[0].read_text(encoding="utf-8")
TEXTS = {".py", ".md", ".toml", ".js", ".html", ".css", ""}
NOTE = r"(?:,? (?:row|rule|field) \d+)?"
SECTION = rf"\d+(?:\.\d+)*{NOTE}"
CITED = (*PAGES, *(PAGES[0].with_name(f"{name}.md") for name in ("lasers", "lms2xx", "cola")))
NAMES = "|".join(page.stem for page in CITED)
CITATION = re.compile(rf"({NAMES})\.md\s+(?:# )?({SECTION}(?:(?:,| to| and|;)\s+{SECTION})*)")
HEADING = re.compile(r"^#{2,3} (\d+(?:\.\d+)?)\.? ", re.MULTILINE)
PAGE = re.compile(r"[\w./-]*\w\.md\b")
LINK = re.compile(r"\]\((?!https?:|mailto:|#)([^)#\s]+)")
CODE = re.compile(r"```.*?```", re.DOTALL)
DECLARED = re.compile(r'import\("[./]+messages\.d\.ts"\)\.(\w+)')
ELSEWHERE = re.compile(r"user-needs|\.\./shared/|\bshared/(?!maps|captures|cases|robots.tsv)\w")


def texts() -> Iterator[tuple[str, str]]:
    """Return names and contents of all files that may cite a page."""
    folders = ("src", "tests", "benchmarks", "docs", "examples", "scripts")
    for path in chain(*((ROOT / folder).rglob("*") for folder in folders), ROOT.glob("*.md")):
        if path == Path(__file__) or BUILT in path.parents:
            continue
        if path.is_file() and path.suffix in TEXTS:
            yield str(path.relative_to(ROOT)), path.read_text(encoding="utf-8")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_the_tables_are_up_to_date(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    assert text == filled(text), "run: uv run docs/reference/protocol_tables.py"


def test_the_tables_of_lasers_are_up_to_date() -> None:
    text = laser_tables.PAGE.read_text(encoding="utf-8")
    todo = "run: uv run python -m docs.reference.laser_tables"
    assert text == laser_tables.filled(text), todo


def test_the_tables_of_the_fleet_are_up_to_date() -> None:
    text = fleet_tables.PAGE.read_text(encoding="utf-8")
    todo = "run: uv run python -m docs.reference.fleet_tables"
    assert text == fleet_tables.filled(text), todo


@pytest.mark.parametrize("page", mode_tables.PAGES, ids=lambda page: page.name)
def test_a_table_of_modes_is_up_to_date(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    assert text == mode_tables.filled(text), "run: uv run docs/reference/mode_tables.py"


def test_links_lead_to_files() -> None:
    pages = (*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md"))
    dead = [
        f"{page.relative_to(ROOT)}: {link}"
        for page in pages
        for link in LINK.findall(CODE.sub("", page.read_text(encoding="utf-8")))
        if not (page.parent / link).exists()
    ]
    assert dead == []


def test_nobody_is_told_to_install_it_from_an_index_that_does_not_have_it() -> None:
    index = r"(?:pipx?|uv tool) install (?!--no-index)[^.\n`]*"
    asks = re.compile(rf"{index}'?pioneer3(?!-\d)")  # a wheel is named with its version
    assert [name for name, text in texts() if asks.search(text)] == []


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


def test_every_cited_section_exists() -> None:
    sections = {page.stem: set(HEADING.findall(page.read_text(encoding="utf-8"))) for page in CITED}
    cited = 0
    for name, text in texts():
        for page, numbers in CITATION.findall(text):
            found = set(re.findall(r"(?<!row )(?<!rule )(?<!field )\b\d+(?:\.\d+)*", numbers))
            assert found <= sections[page], f"{name} cites {page}.md {numbers}"
            cited += len(found)
    assert cited > 100


def test_no_page_is_cited_that_is_not_here() -> None:
    pages = {path.name for path in chain(ROOT.glob("*.md"), (ROOT / "docs").rglob("*.md"))}
    for name, text in texts():
        lines = (line for line in text.splitlines() if ".md" in line)
        for page in PAGE.findall("\n".join(lines)):
            if page.startswith("docs/made/"):  # scripts/docs makes them, and looks for each
                continue
            assert Path(page).name in pages, f"{name} cites {page}"
        assert not ELSEWHERE.search(text), name


def test_the_types_of_messages_are_up_to_date() -> None:
    todo = "run: uv run docs/reference/message_types.py"
    assert message_types.SCHEMA.read_text(encoding="utf-8") == message_types.schema(), todo


def test_a_message_is_declared_with_its_words_and_the_types_of_its_fields() -> None:
    declared = message_types.declarations()
    assert "/** A robot's type and outline [m];" in declared
    assert '  type: "hello";\n  version: string;\n  robots: ListedRobot[];\n' in declared
    known = set(re.findall(r"^export (?:interface|type) (\w+)", declared, re.MULTILINE))
    for path in (ROOT / "src/pioneer3/web/static").rglob("*.js"):
        used = set(DECLARED.findall(path.read_text(encoding="utf-8")))
        assert used <= known, f"{path.name}: {used - known}"
