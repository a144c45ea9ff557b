"""Names that people type, and names that no two have."""

from itertools import count

NAME = 40
"""Longest name [characters]."""


def clean_name(text: str) -> str:
    """Return `text` as a name: printable, single spaces, not long."""
    printable = "".join(c if c.isprintable() else " " for c in text)
    return " ".join(printable.split())[:NAME].strip()


def free_name(wanted: str, taken: set[str]) -> str:
    """Return `wanted`, or `wanted 2`, `wanted 3` if that is taken."""
    if wanted not in taken:
        return wanted
    return next(name for n in count(2) if (name := f"{wanted} {n}") not in taken)
