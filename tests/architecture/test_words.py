"""The words of the code: docstrings say what a thing is, and each constant has its own."""

import ast
from collections import defaultdict
from collections.abc import Iterator
from functools import cache
from itertools import pairwise
from pathlib import Path

SOURCE = Path(__file__).parents[2] / "src" / "pioneer3"
NO_BEGINNING = ("Of ", "Who ", "What ", "The same ", "It ")
"""A docstring begins with its verb, or with the noun that the thing is."""
ONE_VALUE = ("behaviors", "nav", "navigation")
"""Packages in which the name of a constant stands for one value; within each of their folders."""


@cache
def modules() -> dict[Path, ast.Module]:
    """Return the syntax trees of all modules, once a test asks for them."""
    return {path.relative_to(SOURCE): ast.parse(path.read_text()) for path in SOURCE.rglob("*.py")}


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
        for path, tree in modules().items()
        for line, text in docstrings(tree)
        if text.startswith(NO_BEGINNING)
    ] == []


def constants(tree: ast.Module) -> Iterator[tuple[ast.Assign | ast.AnnAssign, ast.expr]]:
    """Yield the assignments of a module to constants, and their targets."""
    for statement in tree.body:
        if isinstance(statement, ast.Assign | ast.AnnAssign):
            target = (
                statement.target if isinstance(statement, ast.AnnAssign) else statement.targets[0]
            )
            if all(n.id.isupper() for n in ast.walk(target) if isinstance(n, ast.Name)):
                yield statement, target


def test_each_constant_has_a_docstring_of_its_own() -> None:
    """One for several is no sentence about any: "A robot waits so long [s], and so far [m]."."""
    docs = {
        (path, line.lineno)
        for path, tree in modules().items()
        for line, text in pairwise(tree.body)
        if isinstance(text, ast.Expr) and isinstance(text.value, ast.Constant)
    }
    assert [
        f"{path}:{statement.lineno}: {ast.unparse(target)}"
        for path, tree in modules().items()
        for statement, target in constants(tree)
        if isinstance(target, ast.Tuple) and (path, statement.lineno) in docs
    ] == []


def test_the_name_of_a_constant_has_one_value_in_a_package() -> None:
    values = defaultdict[tuple[Path, str], set[str]](set)
    for path, tree in modules().items():
        if path.parts[0] in ONE_VALUE:
            for statement, target in constants(tree):
                assert statement.value is not None
                values[path.parent, ast.unparse(target)].add(ast.unparse(statement.value))
    assert {name: found for name, found in values.items() if len(found) > 1} == {}


SHARED_NAMES = {
    "Gripper": "ARCOS's name of a command, and the robot's device",
    "Gyro": "ARCOS's name of a command, and the robot's device",
    "Sonar": "ARCOS's name of a command, and the ranges of a snapshot",
    "Move": "ARCOS's name of a command, and ARIA's of an action",
    "Stop": "ARCOS's name of a command, ARIA's of an action, and the stop that all count",
    "Turn": "ARIA's name of an action, and the mode that people know by it",
    "Goto": "ARIA's name of an action, and the mode that people know by it",
    "FollowLeader": "the action, and the mode that people know by it",
    "Bumpers": "ARIA's name of an action, and the contacts of a snapshot",
}
"""Names of classes that stand for two, with the reason."""


def test_the_name_of_a_public_class_stands_for_one_class() -> None:
    homes = defaultdict(list)
    for path, tree in modules().items():
        for node in tree.body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                homes[node.name].append(str(path))
    shared = {name: where for name, where in homes.items() if len(where) > 1}
    assert {name: shared[name] for name in shared.keys() - SHARED_NAMES.keys()} == {}
    assert SHARED_NAMES.keys() - shared.keys() == set(), "no exception is needed for these"
