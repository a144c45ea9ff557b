"""`pioneer3 docs`: the book in a browser."""

import os
import sys
import webbrowser
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from pioneer3.cli.options import Flag, TcpPort
from pioneer3.cli.process import write_line
from pioneer3.errors import PortBusyError

if TYPE_CHECKING:
    from http.server import ThreadingHTTPServer

PORT = 8090
"""The book's own port; the next free one serves where it is taken."""
NEXT_PORTS = 20
"""Ports that are tried after it."""


def docs(page: str = "", /, *, web_port: TcpPort = PORT, no_open: Flag = False) -> int:
    """Open the book in a browser: tutorial, how-to, troubleshooting, reference.

    It is served from this computer to this computer alone, and needs no internet.

    Example: pioneer3 docs
    Example: pioneer3 docs does-not-move

    Args:
        page: A page by its name; else the first one.
        web_port: TCP port of the book; the next free one if it is taken; 0: any free.
        no_open: Tell the address, and open no browser.
    """
    from pioneer3.web.book import BOOK, find_page

    path = find_page(page)
    with _listen(BOOK, web_port) as server:
        url = f"http://127.0.0.1:{server.server_address[1]}/{path}"
        write_line(f"The book: {url}   (Ctrl-C ends)")
        if not no_open and _has_browser():
            webbrowser.open(url)
        server.serve_forever()
    return 0


def _has_browser() -> bool:
    """Return whether a window can open: a browser in this terminal would take it over."""
    windows = sys.platform in {"darwin", "win32"}
    return sys.stdout.isatty() and (
        windows or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
    )


def _listen(folder: "Path", port: int) -> "ThreadingHTTPServer":
    from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer

    class Pages(SimpleHTTPRequestHandler):
        """Serves the book's folder, and writes no log."""

        def log_message(self, *_: object) -> None:
            """Leave the terminal alone."""

    ThreadingHTTPServer.daemon_threads = True
    last = min(port + NEXT_PORTS, 65535) if port else 0
    for number in range(port, last + 1):
        with suppress(OSError):
            return ThreadingHTTPServer(("127.0.0.1", number), partial(Pages, directory=folder))
    raise PortBusyError(f"ports {port} to {last} are taken; choose another with --web-port")
