"""The pages about symptoms: each reason and each finding has one, and they quote what is said."""

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

import pioneer3
from pioneer3.errors import Symptom
from pioneer3.robot.explain import REASONS, Reason

ROOT = Path(__file__).parents[2]
SOURCES = Path(pioneer3.__file__).parent
PAGES = ROOT / "docs/troubleshooting"
QUOTES = re.compile(r"^\| (?:it|doctor) says \|.*\n\|.*\n((?:\|.*\n)+)", re.MULTILINE)
DIAGNOSIS = ("doctor/port_checks.py", "doctor/robot_checks.py", "ros/ros1/environment.py")
LEAST = 12
"""Characters that a sentence has beside its details."""


def page(symptom: Symptom) -> str:
    return (PAGES / f"{symptom}.md").read_text(encoding="utf-8")


def quotes(text: str) -> list[str]:
    """Return the first cells of the tables of sentences."""
    rows = [row for table in QUOTES.findall(text) for row in table.splitlines()]
    return [row.split(" | ")[0].removeprefix("| ") for row in rows]


def pattern(node: ast.expr) -> str:
    """Return a pattern of the texts that an expression makes; empty if it makes none."""
    match node:
        case ast.Constant(value=str(text)):
            parts = re.split(r"\{[^{}]*\}", text)
        case ast.JoinedStr(values=values):
            fixed = [each.value if isinstance(each, ast.Constant) else "\0" for each in values]
            parts = "".join(map(str, fixed)).split("\0")
        case _:
            return ""
    return ".*".join(map(re.escape, parts)) if len("".join(parts)) >= LEAST else ""


@cache
def texts() -> tuple[str, tuple[re.Pattern[str], ...]]:
    """Return all texts of the program without details, a line each, and patterns of the others."""
    whole, found = list[str](), set[str]()
    for path in SOURCES.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.expr):
                found.add(pattern(node))
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                whole.append(node.value)
    for path in (SOURCES / "web/static").rglob("*.js"):
        whole += re.findall(r'"([^"\n]{12,})"', path.read_text("utf-8"))
    return "\n".join(whole), tuple(re.compile(each) for each in found if ".*" in each)


def test_each_symptom_is_a_page_and_the_index_leads_to_each() -> None:
    pages = {path.stem for path in PAGES.glob("*.md")} - {"index"}
    assert pages == set(Symptom)
    index = (PAGES / "index.md").read_text("utf-8")
    assert all(f"({symptom}.md)" in index for symptom in Symptom)


@pytest.mark.parametrize("reason", REASONS, ids=lambda reason: reason.text[:30])
def test_each_reason_to_stand_is_treated_by_its_page(reason: Reason) -> None:
    said = re.compile(pattern(ast.Constant(reason.text)))
    assert any(map(said.fullmatch, quotes(page(reason.symptom))))


@pytest.mark.parametrize("symptom", Symptom)
def test_the_sentences_of_a_page_are_those_of_the_program(symptom: Symptom) -> None:
    whole, patterns = texts()
    for quoted in quotes(page(symptom)):
        said = quoted in whole or any(each.fullmatch(quoted) for each in patterns)
        assert said, f"{symptom}.md: nothing says {quoted!r}"


def meanings(path: Path) -> Iterator[ast.expr]:
    """Yield the explanations of findings in a module: keywords, and those of other devices."""
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        match node:
            case ast.keyword(arg="meaning", value=value):
                yield value
            case ast.AnnAssign(target=ast.Name(id="_OTHER_DEVICES"), value=ast.Dict(values=pairs)):
                yield from (pair.elts[0] for pair in pairs if isinstance(pair, ast.Tuple))


@pytest.mark.parametrize("module", DIAGNOSIS)
def test_each_finding_of_the_diagnosis_is_treated_by_a_page(module: str) -> None:
    quoted = [each for symptom in Symptom for each in quotes(page(symptom))]
    said = [re.compile(found) for each in meanings(SOURCES / module) if (found := pattern(each))]
    assert said or module.startswith("ros")
    for each in said:
        assert any(map(each.fullmatch, quoted)), each.pattern
