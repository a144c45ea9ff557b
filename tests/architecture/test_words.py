"""The words of the code: docstrings say what a thing is in their first words."""

import ast
from collections.abc import Iterator
from pathlib import Path

SOURCE = Path(__file__).parents[2] / "src" / "pioneer3"
MODULES = {path.relative_to(SOURCE): ast.parse(path.read_text()) for path in SOURCE.rglob("*.py")}
NO_BEGINNING = ("Of ", "Who ", "What ", "The same ", "It ")
"""A docstring begins with its verb, or with the noun that the thing is."""
NUMBERS = ("behaviors/", "nav/", "navigation/going_aside.py", "navigation/follow_way.py")
"""Modules whose constants wait for their new design."""


def docstrings(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Yield line and text of the docstrings of modules, classes, functions and constants."""
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if not isinstance(body, list):
            continue
        for place, statement in enumerate(body):
            if (
                isinstance(statement, ast.Expr)
                and isinstance(statement.value, ast.Constant)
                and isinstance(statement.value.value, str)
                and (not place or isinstance(body[place - 1], ast.Assign | ast.AnnAssign))
            ):
                yield statement.lineno, statement.value.value


def test_docstrings_begin_with_a_verb_or_the_noun_that_a_thing_is() -> None:
    assert [
        f"{path}:{line}: {text.splitlines()[0]}"
        for path, tree in MODULES.items()
        for line, text in docstrings(tree)
        if text.startswith(NO_BEGINNING) and not str(path).startswith(NUMBERS)
    ] == []
