"""A page of the book, as the list of what its reader does.

Fences name the terminal or the file in their title: ```` ```sh title="Second terminal" ````,
```` ```python title="square.py" ````. What no reader needs to see stands in a comment before it:

| comment | meaning |
|---|---|
| `<!-- beside: COMMAND -->` | runs from here to the end of the page, such as `pioneer3 sim` |
| `<!-- serial -->` | a simulated robot is at /dev/ttyUSB0, from here on |
| `<!-- serial: --fit laser=urg-04lx -->` | and its laser is at /dev/ttyACM0 |
| `<!-- goes on -->` | this block's last line runs until its terminal is needed, or to the end |
| `<!-- each goes on -->` | each line of this block is an example: it runs until it says something |
| `<!-- fails -->` | the last line of this block ends with an error |
| `<!-- end: TERMINAL -->` | Ctrl-C ends what runs in this terminal |
| `<!-- press: KEYS -->` | keys, in the terminal of the block before, such as `up space q` |
| `<!-- not run: REASON -->` | this block cannot run here |
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from markdown_it import MarkdownIt

COMMENTS: Final = (
    "beside",
    "serial",
    "goes on",
    "each goes on",
    "fails",
    "end",
    "press",
    "not run",
)
"""Comments that mean something to the reader; others are for writers."""
BEFORE_A_BLOCK: Final = ("goes on", "each goes on", "fails", "not run")
"""Comments about the block that follows."""
_COMMENT: Final = re.compile(r"<!-- ([a-z ]+?)(?:: (.*?))? -->", re.DOTALL)
_TITLE: Final = re.compile(r'title="([^"]*)"')


@dataclass(frozen=True, slots=True, kw_only=True)
class Block:
    """A block of code.

    Attributes:
        language: The first word behind its fence, such as `sh`.
        text: Its lines.
        title: A terminal or a file; empty without one.
        notes: Comments about it, with what follows their colon.
        line: Its place in the page.
    """

    language: str
    text: str
    title: str
    notes: dict[str, str]
    line: int


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture of the page, by the path that the page has."""

    path: str
    line: int


@dataclass(frozen=True, slots=True)
class Comment:
    """A comment that is about no block."""

    word: str
    text: str
    line: int


Step = Block | Picture | Comment


def steps(text: str) -> Iterator[Step]:
    """Yield blocks, pictures and comments of a page in their order.

    Raises:
        ValueError: a comment is about a block, and none follows.
    """
    notes: dict[str, str] = {}
    for token in MarkdownIt().enable("table").parse(text):
        line = token.map[0] + 1 if token.map else 0
        if token.type == "fence":
            language, _, rest = token.info.partition(" ")
            title = _TITLE.search(rest)
            yield Block(
                language=language,
                text=token.content,
                title=title[1] if title else "",
                notes=notes,
                line=line,
            )
            notes = {}
        elif token.type == "html_block":
            for word, said in _COMMENT.findall(token.content):
                if word in BEFORE_A_BLOCK:
                    notes[word] = said
                elif word in COMMENTS:
                    yield Comment(word, said, line)
        elif token.type == "inline":
            for child in token.children or ():
                if child.type == "image":
                    yield Picture(str(child.attrs["src"]), line)
        if notes and token.type == "paragraph_open":
            raise ValueError(f"line {line}: a block has to follow <!-- {', '.join(notes)} -->")


def commands(block: Block) -> Iterator[str]:
    """Yield what is typed at one prompt each: a line, or several that belong together."""
    waiting = ""
    here = ""
    for line in block.text.splitlines():
        waiting += f"{line}\n"
        if here:
            here = "" if line.strip() == here else here
        elif found := re.search(r"<<-?\s*['\"]?(\w+)", line):
            here = found[1]
        if not here and not line.endswith("\\"):
            if waiting.strip() and not waiting.lstrip().startswith("#"):
                yield waiting
            waiting = ""


def folder_of(path: Path) -> Path:
    """Return the folder of the whole project, from a page's path."""
    return next(each for each in path.resolve().parents if (each / "zensical.toml").exists())
