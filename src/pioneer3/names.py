"""Names that people type, names that no two have, and texts that others send."""

from collections.abc import Mapping
from html import escape
from itertools import count

NAME = 40
"""Longest name [characters]."""


def clean_name(text: str) -> str:
    """Return `text` as a name: printable, single spaces, not long."""
    printable = "".join(c if c.isprintable() else " " for c in text)
    return " ".join(printable.split())[:NAME].strip()


def printable(text: str) -> str:
    """Return a text of somebody else on one line, with escapes for what a terminal would obey.

    With a new line or an escape sequence it would forge lines of a log, or clear the screen.
    """
    if text.isprintable():
        return text
    return "".join(
        each if each.isprintable() else each.encode("unicode_escape").decode() for each in text
    )


def printable_lines(text: str) -> str:
    """Return a text as :func:`printable` does, except that ends of lines and tabs stay."""
    if text.isprintable():
        return text
    return "".join(each if each in "\n\t" else printable(each) for each in text)


def html_table(rows: Mapping[str, str]) -> str:
    """Return rows of a name and a text as a table of HTML."""
    cells = (
        f"<tr><th>{escape(name)}</th><td>{escape(printable(text))}</td></tr>"
        for name, text in rows.items()
    )
    return f"<table>{''.join(cells)}</table>"


def free_name(wanted: str, taken: set[str], between: str = " ") -> str:
    """Return `wanted`, or `wanted 2`, `wanted 3` if that is taken."""
    if wanted not in taken:
        return wanted
    return next(name for n in count(2) if (name := f"{wanted}{between}{n}") not in taken)
