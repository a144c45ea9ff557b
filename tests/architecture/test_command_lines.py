"""Each command that the book shows is one that this program takes: its name, options, words."""

import re
import shlex
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Final

import pytest
from cyclopts import CycloptsError, MissingArgumentError
from markdown_it import MarkdownIt

from pioneer3.cli.aria_options import in_our_words
from pioneer3.cli.main import app
from pioneer3.cli.ros_arguments import gather_ros_arguments
from tests.book.page import Block, commands, steps

ROOT: Final = Path(__file__).parents[2]
PAGES: Final = (ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md")))
PROGRAMS: Final = {"pioneer3", "p3", ".venv/bin/pioneer3"}
OPERATORS: Final = set("|&;<>()")
WRITTEN_BY_READERS: Final = {"docs/how-to/extend.md": "spin"}
"""A command that a page lets its reader add."""


def command_lines(page: Path) -> Iterator[tuple[str, bool]]:
    """Yield the commands of a page, and whether they stand in a block, and are whole."""
    text = page.read_text("utf-8")
    for step in steps(text):
        if isinstance(step, Block) and step.language == "sh":
            yield from ((line, True) for line in commands(step))
        elif isinstance(step, Block) and step.language == "console":
            typed = re.findall(r"^\$ (.*)", step.text, re.MULTILINE)
            yield from ((line, True) for line in typed)
    for token in MarkdownIt().enable("table").parse(text):
        for child in token.children or ():
            if child.type == "code_inline" and child.content.partition(" ")[0] in PROGRAMS:
                yield child.content, False


def calls(line: str) -> Iterator[list[str]]:
    """Yield the words of each call of this program in a line of a shell, without the program."""
    lexer = shlex.shlex(line.replace("\\\n", " "), posix=True, punctuation_chars="|&;<>()")
    lexer.whitespace_split, words = True, list[str]()
    for word in (*lexer, ";"):
        if not set(word) <= OPERATORS:
            words.append(word)
            continue
        while words and (re.match(r"\w+=", words[0]) or words[0] == "sudo"):
            words.pop(0)
        if words and words[0] in PROGRAMS:
            yield [each for each in words[1:] if each not in {"…", "..."}]
        words = []


@cache
def complaint(*words: str, whole: bool) -> str:
    """Return why the program does not take the words; empty if it does."""
    given = gather_ros_arguments(in_our_words([*words], lambda _: None))
    try:
        app.parse_args(given, exit_on_error=False, print_error=False)
    except MissingArgumentError as error:
        return str(error) if whole else ""
    except CycloptsError as error:
        return str(error)
    return ""


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_the_program_takes_each_command_of_a_page(page: Path) -> None:
    added = WRITTEN_BY_READERS.get(page.relative_to(ROOT).as_posix())
    for line, whole in command_lines(page):
        for words in calls(line):
            if words[:1] != [added]:
                assert not complaint(*words, whole=whole), line


def test_a_command_that_is_no_more_is_told() -> None:
    assert [*calls("A=1 pioneer3 run --lan & p3 goto x > f # pioneer3 no")] == [
        ["run", "--lan"],
        ["goto", "x"],
    ]
    assert "spin" in complaint("spin", whole=True)
    assert "--lam" in complaint("run", "--lam", whole=False)
    assert "DISTANCE" in complaint("move", whole=True)
    assert not complaint("move", whole=False)
