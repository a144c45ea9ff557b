"""The inputs of the page alone, in Chromium and in a time of their own: no server, no robot.

What they send is what the page sends, to the millisecond. `bench.js` puts them together.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import Any

from playwright.sync_api import Page

from pioneer3.teleop.gamepad import SCHEME
from pioneer3.web.app import STATIC
from tests.browser.hands import DEVICES, Hands
from tests.browser.tabs import DESKTOP, PHONE, Tabs, let_go, no_complaints

HERE = Path(__file__).parent
MAIN = '<script type="module" src="/static/main.js"></script>'
OURS = '<script type="module" src="/bench.js"></script>'
POLL = 20
"""Between two looks of the page at its gamepad [ms]."""
LIMITS = {"speed": 1.0, "default_speed": 0.3, "turn_rate": 2.0, "default_turn_rate": 0.6}


class _Handler(SimpleHTTPRequestHandler):
    """Serves the page without its main module, and the files of `static`."""

    def do_GET(self) -> None:
        if self.path == "/":
            page = (STATIC / "index.html").read_text("utf-8")
            assert MAIN in page
            self._answer("text/html", page.replace(MAIN, OURS))
        elif self.path == "/bench.js":
            self._answer("text/javascript", (HERE / "bench.js").read_text("utf-8"))
        else:
            self.path = self.path.removeprefix("/static")
            super().do_GET()

    def _answer(self, kind: str, text: str) -> None:
        body = text.encode()
        self.send_response(200)
        self.send_header("Content-Type", f"{kind}; charset=utf-8")
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def end_headers(self) -> None:
        self.send_header("Cache-Control", "max-age=3600")  # the files stay as they are meanwhile
        super().end_headers()

    def log_message(self, *_: object) -> None:
        """Say nothing."""


@contextmanager
def served() -> Iterator[str]:
    """Serve the bench; yield its address."""
    handler = partial(_Handler, directory=str(STATIC))
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        thread = Thread(target=server.serve_forever, kwargs={"poll_interval": 0.05})
        thread.start()
        try:
            yield f"http://127.0.0.1:{server.server_port}/"
        finally:
            server.shutdown()
            thread.join()


@dataclass
class Bench(Hands):
    """Hands at the inputs of the page; time passes only in :meth:`wait`."""

    def wait(self, milliseconds: int) -> None:
        """Let time pass."""
        self.page.clock.run_for(milliseconds)

    def polled(self) -> None:
        """Let the page read the gamepad."""
        self.wait(POLL)

    @property
    def sent(self) -> list[dict[str, Any]]:
        """All that was sent so far."""
        sent: list[dict[str, Any]] = self.page.evaluate("window.bench.sent")
        return sent

    @property
    def told(self) -> list[str]:
        """What the page has told its user so far."""
        told: list[str] = self.page.evaluate("window.bench.told")
        return told

    @property
    def held(self) -> set[str]:
        """The directions that the page holds."""
        return set(self.page.evaluate("window.bench.held"))

    def asks(self) -> tuple[float, float]:
        """Return what was sent last: speed [m/s] and turn rate [rad/s]."""
        last = self.sent[-1]
        assert last["type"] == "drive"
        return last["v"], last["w"]


@contextmanager
def bench_tab(tabs: Tabs, *, phone: bool) -> Iterator[Page]:
    """Open a tab in which time stands still."""
    size, scripts = (PHONE if phone else DESKTOP), f"{DEVICES} // bench"
    with tabs.open(size=size, touch=phone, mobile=phone, scripts=scripts) as page:
        page.clock.install(time=0)
        page.clock.pause_at(1000)
        yield page


@contextmanager
def bench_in(page: Page, address: str) -> Iterator[Bench]:
    """Open the bench in a tab, with the layout of gamepads and the limits that a server sends."""
    tools = page.context.new_cdp_session(page)
    with no_complaints(page):
        page.goto(address)
        page.evaluate(
            "([scheme, limits]) => window.bench.begin(scheme, limits)", [asdict(SCHEME), LIMITS]
        )
        yield Bench(page, tools)
        let_go(page, tools)
        page.evaluate("localStorage.clear()")
    tools.detach()
