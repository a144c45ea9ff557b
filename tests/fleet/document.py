"""The commands of a tutorial, taken from the document: neither can change without the other."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

SECOND_TERMINAL: Final = "In a second terminal, until the end:"
_FENCE: Final = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_HEADING: Final = re.compile(r"^## .*$", re.MULTILINE)
_KEY: Final = re.compile(r"`([^`]+)`")


@dataclass(frozen=True, slots=True)
class Block:
    """A block of code.

    Attributes:
        kind: The word behind its fence, such as `sh`.
        text: Its lines.
        before: The paragraph in front of it.
    """

    kind: str
    text: str
    before: str

    @property
    def lines(self) -> list[str]:
        return [line for line in self.text.splitlines() if line.strip()]


def section(path: Path, title: str) -> str:
    """Return the text of a document below the heading that contains `title`."""
    text = path.read_text(encoding="utf-8")
    headings = [*_HEADING.finditer(text)]
    for number, heading in enumerate(headings):
        if title in heading[0]:
            end = headings[number + 1].start() if number + 1 < len(headings) else len(text)
            return text[heading.end() : end]
    raise AssertionError(f"{path}: no heading with {title!r}")


def blocks(text: str) -> Iterator[Block]:
    """Yield the blocks of code of a text."""
    for found in _FENCE.finditer(text):
        before = text[: found.start()].strip().rpartition("\n\n")[2]
        yield Block(found[1], found[2], before)


def keys(text: str) -> list[str]:
    """Return the keys in the first column of a text's table, in their order."""
    rows = [line for line in text.splitlines() if line.startswith("| `")]
    return [key for row in rows for key in _KEY.findall(row.split("|")[1])]
