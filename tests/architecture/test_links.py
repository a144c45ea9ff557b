"""Each link of the book's sources leads to a file and to a heading; the thorough tier builds it."""

import re
from collections.abc import Iterator
from functools import cache
from itertools import pairwise
from pathlib import Path
from urllib.parse import unquote, urldefrag, urlsplit

import pytest
from markdown_it import MarkdownIt
from markdown_it.token import Token

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted(DOCS.rglob("*.md"))]
MADE = DOCS / "made"
"""Pieces that are made while the book is built, and no page of it."""
NAMES = re.compile(r"""(?:\{\s*#|id=["'])([\w.-]+)""")


@cache
def tokens(page: Path) -> tuple[Token, ...]:
    """Return the tokens of a page, each before those in it."""
    top = MarkdownIt().enable("table").parse(page.read_text("utf-8"))
    return tuple(token for each in top for token in (each, *(each.children or ())))


def slug(heading: str) -> str:
    """Return the anchor that the book gives to a heading."""
    return re.sub(r"[-\s]+", "-", re.sub(r"[^\w\s-]", "", heading).strip().lower())


@cache
def anchors(page: Path) -> set[str] | None:
    """Return the anchors of a page; `None` where pieces that are put in bring others."""
    text = page.read_text("utf-8")
    if re.search(r"^\s*(?::::|--8<--)", text, re.MULTILINE):
        return None
    heads = [inline for token, inline in pairwise(tokens(page)) if token.type == "heading_open"]
    words = ["".join(part.content for part in head.children or ()) for head in heads]
    return {slug(each) for each in words} | {*NAMES.findall(text)}


def dead_links(page: Path) -> Iterator[str]:
    """Yield the links of a page that lead nowhere."""
    for token in tokens(page):
        link = str(token.attrs.get("href") or token.attrs.get("src") or "")
        url, anchor = urldefrag(link)
        if urlsplit(link).scheme or not link or MADE in (page.parent / url).parents:
            continue
        target = (page.parent / unquote(url)).resolve() if url else page
        known = anchors(target) if target.suffix == ".md" and target.exists() else None
        if not target.exists() or (anchor and known is not None and unquote(anchor) not in known):
            yield link


@pytest.mark.parametrize(
    "page",
    [page for page in PAGES if MADE not in page.parents],
    ids=lambda page: page.relative_to(ROOT).as_posix(),
)
def test_each_link_of_a_page_leads_somewhere(page: Path) -> None:
    assert [*dead_links(page)] == []


def test_a_link_that_leads_nowhere_is_found(tmp_path: Path) -> None:
    page = tmp_path / "README.md"
    page.write_text(
        "# A head `of` two\n[here](#a-head-of-two) [lost](#b) [gone](no_page) ![x](x.png)"
    )
    assert [*dead_links(page)] == ["#b", "no_page", "x.png"]
