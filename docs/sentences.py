"""Say which sentences of pages are too long: `python -m docs.sentences docs/tutorial ...`."""

import re
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Final

from markdown_it import MarkdownIt
from markdown_it.token import Token

MOST: Final = 25
"""Words of a sentence, at most; what stands in backticks is one word."""
_MADE: Final = re.compile(r"<!-- made: .*?<!-- end -->", re.DOTALL)
"""Tables that are made from the program, whose words are written there."""
_END: Final = re.compile(r"(?<=[.!?…])[\"')*]*\s+(?=\S)")
_WORD: Final = re.compile(r"\w")


def long_sentences(text: str) -> Iterator[tuple[int, int, str]]:
    """Yield line, number of words and text of each sentence of a page that is too long."""
    text = _MADE.sub(lambda made: "\n" * made[0].count("\n"), text)
    for token in MarkdownIt().enable("table").parse(text):
        if token.type != "inline" or token.map is None:
            continue
        words = " ".join(_shown(token.children or ()).split())
        for sentence in _END.split(words):
            number = sum(bool(_WORD.search(word)) for word in sentence.split())
            if number > MOST:
                yield token.map[0] + 1, number, sentence


def _shown(tokens: Iterable[Token]) -> str:
    """Return the words of a paragraph, with one for each piece of code."""
    others = {"code_inline": "code", "softbreak": " ", "hardbreak": " "}
    return "".join(others.get(token.type, token.content) for token in tokens)


def pages(folder: Path) -> list[Path]:
    """Return the pages of a folder, or a page itself."""
    return sorted(folder.rglob("*.md")) if folder.is_dir() else [folder]


def main(names: list[str]) -> int:
    """Print each sentence that is too long; return how many there are."""
    found = 0
    for page in (page for name in names for page in pages(Path(name))):
        for line, number, sentence in long_sentences(page.read_text("utf-8")):
            print(f"{page}:{line}: {number} words, {MOST} are enough: {sentence}")  # noqa: T201
            found += 1
    return found


if __name__ == "__main__":
    sys.exit(bool(main(sys.argv[1:])))
