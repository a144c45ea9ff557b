"""The shape and the words of the package: imports, folders, tasks, docstrings, constants.

They are in one file because parsing all modules takes long.
"""

import ast
import re
from collections import defaultdict
from collections.abc import Iterator
from functools import cache
from graphlib import CycleError, TopologicalSorter
from itertools import pairwise
from pathlib import Path

import pytest

SOURCE = Path(__file__).parents[2] / "src"
PROGRAMS = SOURCE / "pioneer3/classroom/lessons"
"""Programs of students, which a class hands out."""
MODULES = {
    ".".join(path.relative_to(SOURCE).with_suffix("").parts).removesuffix(".__init__"): path
    for path in (SOURCE / "pioneer3").rglob("*.py")
    if path.parent != PROGRAMS
}
UNTYPED = ("sim.worldfile", "tables", "gym")
"""Readers of files, where anything may stand under any name; and Gymnasium's own interface."""


@cache
def nodes_of(path: Path) -> tuple[ast.AST, ...]:
    """Return all nodes of the syntax tree of a file."""
    return (*ast.walk(ast.parse(path.read_text())),)


def nodes(module: str) -> tuple[ast.AST, ...]:
    """Return all nodes of the syntax tree of a module."""
    return nodes_of(MODULES[module])


def tree_of(path: Path) -> ast.Module:
    """Return the syntax tree of a file."""
    tree = nodes_of(path)[0]
    assert isinstance(tree, ast.Module)
    return tree


def imports(module: str) -> Iterator[str]:
    """Yield the modules of ours that `module` imports anywhere, for type checking too."""
    for node in nodes(module):
        if isinstance(node, ast.Import):
            yield from (name.name for name in node.names if name.name in MODULES)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            for name in node.names:
                child = f"{node.module}.{name.name}"
                if child in MODULES:
                    yield child
                elif node.module in MODULES:
                    yield node.module


def test_no_circle_of_imports() -> None:
    modules = MODULES.keys() - {"pioneer3"}  # the root names everything, and nothing needs it
    graph = TopologicalSorter(
        {module: set(imports(module)) & modules - {module} for module in modules}
    )
    try:
        graph.prepare()
    except CycleError as error:
        pytest.fail(" -> ".join(error.args[1]))


def test_no_package_lies_deeper_than_two_folders() -> None:
    assert [
        name for name in MODULES if MODULES[name].name == "__init__.py" and name.count(".") > 2
    ] == []


OUTPUT = {
    "print": {"pioneer3.cli.process"},
    "sys.stdout.write": {"pioneer3.cli.process", "pioneer3.teleop.terminal"},
    "sys.stderr.write": set[str](),
    "logging.basicConfig": {"pioneer3.cli.main"},
    "logging.Formatter": set[str](),
    "Console": {"pioneer3.sim.firmware.controller"},  # a console of the simulator
    "Static": set[str](),
}
"""Calls that show text on a terminal or in a log, and the modules that may make them.

All others use :mod:`pioneer3.cli.process`, :mod:`pioneer3.cli.terminal`, or a `Part` of
:mod:`pioneer3.teleop.screen`, which make the text printable.
"""


def test_all_text_for_terminals_and_logs_is_made_printable() -> None:
    """Names, reasons and answers of robots, hosts and networks come without escape sequences."""
    assert [
        f"{name}:{node.lineno}: {call}"
        for name in MODULES
        for node in nodes(name)
        if isinstance(node, ast.Call)
        and isinstance(node.func, ast.Name | ast.Attribute)
        and (call := ast.unparse(node.func)) in OUTPUT
        and name not in OUTPUT[call]
    ] == []


def test_every_task_belongs_to_somebody() -> None:
    """A bare task dies with the first collection of garbage, and its errors with it."""
    bare = [
        f"{name}:{node.lineno}"
        for name in MODULES
        for node in nodes(name)
        if isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Call)
        and isinstance(node.value.func, ast.Attribute)
        and node.value.func.attr in {"create_task", "ensure_future"}
    ]
    assert bare == []


def test_messages_have_types() -> None:
    assert [
        name
        for name, path in MODULES.items()
        if "dict[str, Any]" in path.read_text()
        and not name.startswith(tuple(f"pioneer3.{module}" for module in UNTYPED))
    ] == []


MARKS = {
    "Connect call failed": "asyncio's words",
    " - at `$": "msgspec's words",
    "ROS 2": "a name in the tables of parameters",
    "# pioneer3": "the beginning of a recording",
    "pioneer3: the answer": "the beginning of a remote program's answer",
    "Drawn by pioneer3 from the robot's model.": "the mark of a description of ours",
}
"""Texts of two words or more that are looked for in others, as they are no sentences of ours."""


@cache
def constants(module: str) -> dict[str, str]:
    """Return the texts that a module gives names."""
    return {
        target.id: node.value.value
        for node in tree_of(MODULES[module]).body
        if isinstance(node, ast.Assign | ast.AnnAssign) and isinstance(node.value, ast.Constant)
        for target in (node.targets if isinstance(node, ast.Assign) else [node.target])
        if isinstance(target, ast.Name) and isinstance(node.value.value, str)
    }


def named_texts(module: str) -> dict[str, str]:
    """Return the texts that have names in a module, its own and those that it imports."""
    found = {**constants(module)}
    for node in nodes(module):
        if isinstance(node, ast.ImportFrom) and node.module in MODULES:
            theirs = constants(node.module)
            found |= {each.name: theirs[each.name] for each in node.names if each.name in theirs}
    return found


def searched_texts(node: ast.AST) -> Iterator[ast.expr]:
    """Yield what an expression looks for in another one."""
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
        if node.func.attr in {"startswith", "endswith", "partition"}:
            for argument in node.args:
                yield from argument.elts if isinstance(argument, ast.Tuple) else (argument,)
    elif isinstance(node, ast.Compare) and isinstance(node.ops[0], ast.In | ast.NotIn):
        yield node.left


def test_no_code_looks_into_our_own_sentences() -> None:
    """The kind of a reason, a refusal or an error is data: an attribute, or the error's class."""
    ours = "\n".join(
        node.value
        for module in MODULES
        for node in nodes(module)
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    )
    found = []
    for module in MODULES:
        named = named_texts(module)
        for text in (text for node in nodes(module) for text in searched_texts(node)):
            if isinstance(text, ast.Constant) and isinstance(text.value, str):
                words = text.value
            else:
                words = named.get(text.id, "") if isinstance(text, ast.Name) else ""
            if len(words.split()) > 1 and words not in MARKS and ours.count(words) > 1:
                found.append(f"{module}:{text.lineno}: {words!r}")
    assert found == []


LEAST = 4
"""Modules of a package whose door lists them."""


def test_the_door_of_a_package_lists_its_modules() -> None:
    """The root's door is the public names; docs/explanation/architecture.md draws its packages."""
    inside: dict[str, list[str]] = {}
    for module in MODULES:
        package, _, name = module.rpartition(".")
        inside.setdefault(package, []).append(name)
    missing = {
        package: absent
        for package, names in inside.items()
        if package.startswith("pioneer3.") and len(names) >= LEAST
        if (absent := sorted({*names} - {*listed(package)}))
    }
    assert missing == {}


def listed(package: str) -> list[str]:
    """Return the first words of the table in a package's docstring."""
    table = re.search(
        r"^=+ +=+\nmodule +contents\n=[= ]+\n(.*?)^=", door(package), re.MULTILINE | re.DOTALL
    )
    return re.findall(r"^(\w+) +\S", table[1], re.MULTILINE) if table else []


def door(package: str) -> str:
    return ast.get_docstring(tree_of(MODULES[package])) or ""


def test_a_door_lists_nothing_else() -> None:
    assert [
        f"{package}.{name}"
        for package, path in MODULES.items()
        if path.name == "__init__.py"
        for name in listed(package)
        if f"{package}.{name}" not in MODULES
    ] == []


NO_BEGINNING = ("Of ", "Who ", "What ", "The same ", "It ")
"""A docstring begins with its verb, or with the noun that the thing is."""
ONE_VALUE = ("behaviors", "nav", "navigation")
"""Packages in which the name of a constant stands for one value; within each of their folders."""


def files() -> Iterator[tuple[Path, ast.Module]]:
    """Yield all modules, and programs of students, with their syntax trees."""
    for path in (SOURCE / "pioneer3").rglob("*.py"):
        yield path.relative_to(SOURCE / "pioneer3"), tree_of(path)


def docstrings(path: Path) -> Iterator[tuple[int, str]]:
    """Yield line and text of the docstrings of modules, classes, functions and constants."""
    for node in nodes_of(path):
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
        for path, _ in files()
        for line, text in docstrings(SOURCE / "pioneer3" / path)
        if text.startswith(NO_BEGINNING)
    ] == []


def assigned(tree: ast.Module) -> Iterator[tuple[ast.Assign | ast.AnnAssign, ast.expr]]:
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
        for path, tree in files()
        for line, text in pairwise(tree.body)
        if isinstance(text, ast.Expr) and isinstance(text.value, ast.Constant)
    }
    assert [
        f"{path}:{statement.lineno}: {ast.unparse(target)}"
        for path, tree in files()
        for statement, target in assigned(tree)
        if isinstance(target, ast.Tuple) and (path, statement.lineno) in docs
    ] == []


def test_the_name_of_a_constant_has_one_value_in_a_package() -> None:
    values = defaultdict[tuple[Path, str], set[str]](set)
    for path, tree in files():
        if path.parts[0] in ONE_VALUE:
            for statement, target in assigned(tree):
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
    for path, tree in files():
        for node in tree.body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                homes[node.name].append(str(path))
    shared = {name: where for name, where in homes.items() if len(where) > 1}
    assert {name: shared[name] for name in shared.keys() - SHARED_NAMES.keys()} == {}
    assert SHARED_NAMES.keys() - shared.keys() == set(), "no exception is needed for these"
