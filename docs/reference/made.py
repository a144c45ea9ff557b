"""Make the parts of the reference that the book takes from the program as it is.

    uv run python -m docs.reference.made [FOLDER]

`scripts/docs` does this before it builds. Pages take the parts in by a line `--8<--`.
"""

import re
import sys
from collections.abc import Callable
from inspect import getdoc
from pathlib import Path

from docs.reference.docstrings import ROLE
from docs.reference.protocol_tables import table
from pioneer3 import errors
from pioneer3.analysis.arrays import SCANS, TABLES, TIME
from pioneer3.cli.main import Exit, app, exit_code
from pioneer3.errors import PioneerError
from pioneer3.web.api.routes import OPERATIONS

FOLDER = Path(__file__).parents[1] / "made"
EXAMPLES = re.compile(r"^((?:Example: .*\n?)+)", re.MULTILINE)
STARTED = re.compile(r"(?<=^pioneer3)( [\w -]+?)? -m [\w.]+", re.MULTILINE)
"""Traces of `python -m`, which this may have been started with, in the lines of usage."""
MEANINGS = {
    Exit.OK: "done",
    Exit.FAILED: "it went wrong: the port is busy, the motion failed, a key stopped it",
    Exit.USAGE: "a wrong word or number",
    Exit.NOT_REACHABLE: "no robot or laser is reached; of `fleet` commands, none of the robots",
    Exit.NO_PERMISSION: "this user may not open the port, or may not change the file",
    Exit.INTERRUPTED: "ended by Ctrl-C: 128 and the number of the signal",
    Exit.QUIT: "ended by Ctrl-\\: 128 and the number of the signal",
}


def commands() -> str:
    """Return each command with its options, as `--help` has them."""
    text = app.generate_docs(output_format="markdown", include_hidden=False)
    first = text.index("\n## pioneer3 run")
    return EXAMPLES.sub(_examples, STARTED.sub(r"\1", text[first:]))


def _examples(found: re.Match[str]) -> str:
    lines = found[1].replace("Example: ", "")
    return f"```sh\n{lines.rstrip()}\n```\n"


def exit_codes() -> str:
    """Return the exit codes of commands."""
    return table(
        ("code", "", "meaning"), [(str(int(code)), code.name, MEANINGS[code]) for code in Exit]
    )


def exceptions() -> str:
    """Return the exceptions with what they are besides, and a command's exit code."""
    rows = []
    for name, cls in vars(errors).items():
        if isinstance(cls, type) and issubclass(cls, PioneerError):
            bases = ", ".join(f"`{base.__name__}`" for base in cls.__bases__)
            rows.append((f"`{name}`", bases, first_line(cls), str(int(exit_code(cls())))))
    return table(("exception", "is a", "raised when", "exit code"), rows)


def operations() -> str:
    """Return the operations of the HTTP API."""
    rows = [
        (f"`{one.method} {one.path}`", first_line(one.act), one.needs.value if one.needs else "")
        for one in OPERATIONS
    ]
    return table(("request", "", "for whom, and those above"), rows)


def arrays() -> str:
    """Return the columns of the arrays of a log."""
    rows = []
    for each in (*TABLES, SCANS):
        columns = ((f"`{column.name}`", column.about) for column in (TIME, *each.columns))
        named, name = f"`{each.name}`: {each.about[0].lower()}{each.about[1:]}", ""
        for column in columns:
            rows.append((named if not name else "", *column))
            name = each.name
    return table(("array", "column", "unit, or meaning"), rows)


def first_line(documented: object) -> str:
    """Return the first line of a docstring, without Sphinx's roles."""
    return ROLE.sub("`", (getdoc(documented) or "").partition("\n")[0])


PARTS: dict[str, Callable[[], str]] = {
    "commands": commands,
    "exit-codes": exit_codes,
    "exceptions": exceptions,
    "operations": operations,
    "arrays": arrays,
}


def make(folder: Path = FOLDER) -> None:
    """Write all parts into `folder`."""
    folder.mkdir(exist_ok=True)
    for name, part in PARTS.items():
        (folder / f"{name}.md").write_text(f"{part()}\n", encoding="utf-8")


if __name__ == "__main__":
    make(*map(Path, sys.argv[1:]))
