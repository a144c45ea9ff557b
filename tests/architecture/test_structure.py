"""The shape of the package: no circles of imports."""

import ast
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

SOURCE = Path(__file__).parents[2] / "src"
MODULES = {
    ".".join(path.relative_to(SOURCE).with_suffix("").parts).removesuffix(".__init__"): path
    for path in (SOURCE / "pioneer3").rglob("*.py")
}


def imports(module: str) -> Iterator[str]:
    """Yield the modules of ours that `module` imports anywhere, for type checking too."""
    for node in ast.walk(ast.parse(MODULES[module].read_text())):
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
