"""The book, as `scripts/docs` builds it: its pages by their names, and its place at a server."""

from difflib import get_close_matches
from pathlib import Path

from starlette.responses import Response
from starlette.routing import Mount
from starlette.staticfiles import StaticFiles
from starlette.types import Scope

from pioneer3.errors import ConfigError

BOOK = Path(__file__).parents[1] / "book"
"""Where `scripts/docs` puts it; it is in each wheel of `scripts/package`."""
POLICY = (
    "default-src 'self'; script-src 'self' 'unsafe-inline'; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' data:; worker-src 'self' blob:; object-src 'none'; frame-ancestors 'none'; "
    "base-uri 'none'; form-action 'self'"
)
"""Lets its own scripts stand in its pages, and asks no other host."""


def book_routes(book: Path = BOOK) -> list[Mount]:
    """Return the routes of the book at `/book/`; none where it is not built."""
    return [Mount("/book", _Pages(directory=book, html=True))] if is_built(book) else []


def is_built(book: Path = BOOK) -> bool:
    """Return whether there is a book."""
    return (book / "index.html").is_file()


def find_page(name: str = "", book: Path = BOOK) -> str:
    """Return the path of the page `name` below `book`: `how-to/laser/` for `laser`.

    The first page is the one without a name; a heading may follow: `laser#mount`.

    Raises:
        ConfigError: there is no book, no page of that name, or more than one.
    """
    if not is_built(book):
        raise ConfigError("the book is not built here; in a clone: scripts/docs")
    wanted, hash_, heading = name.strip("/").removesuffix(".md").partition("#")
    pages = [path.parent.relative_to(book).as_posix() for path in book.rglob("index.html")]
    if wanted in {"", "index"}:
        return f"{hash_}{heading}"
    found = [page for page in pages if page == wanted or page.endswith(f"/{wanted}")]
    if wanted in found:
        found = [wanted]
    if len(found) == 1:
        return f"{found[0]}/{hash_}{heading}"
    last = {page.rsplit("/")[-1]: page for page in sorted(pages)}
    near = found or [last[word] for word in get_close_matches(wanted, last, n=3, cutoff=0.5)]
    if found:
        raise ConfigError(f"several pages are named {wanted!r}: {', '.join(near)}")
    hint = f"there is {', '.join(near)}" if near else "see: pioneer3 docs"
    raise ConfigError(f"the book has no page {wanted!r}; {hint}")


class _Pages(StaticFiles):
    """Serves the pages with a policy of their own."""

    async def get_response(self, path: str, scope: Scope) -> Response:
        """Return the response."""
        response = await super().get_response(path, scope)
        response.headers["Content-Security-Policy"] = POLICY
        return response
